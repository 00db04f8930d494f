#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace batten {

/// A place in a folder of this test process alone, which goes when the process ends.
inline std::filesystem::path in_test_folder(const std::string& name) {
    struct Folder {
        std::filesystem::path path =
            std::filesystem::path(testing::TempDir()) / ("batten-cad-" + std::to_string(getpid()));
        Folder() { std::filesystem::create_directories(path); }
        Folder(const Folder&) = delete;
        Folder& operator=(const Folder&) = delete;
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    static const Folder folder;
    return folder.path / name;
}

} // namespace batten
