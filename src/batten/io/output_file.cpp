#include <batten/io/output_file.hpp>

#include <batten/core/errors.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace batten {

namespace {

/// A C file closed with its scope.
class File {
  public:
    File(const std::filesystem::path& path, const char* mode)
        : file_(std::fopen(path.c_str(), mode)) {}
    ~File() { close(); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    std::FILE* get() const { return file_; }
    /// False when buffered data could not be written.
    bool close() {
        const bool good = file_ == nullptr || std::fclose(file_) == 0;
        file_ = nullptr;
        return good;
    }

  private:
    std::FILE* file_;
};

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view what, int error) {
    throw FileError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(error)));
}

std::string read_all(std::FILE* file) {
    std::string content;
    char buffer[1 << 16];
    while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file))
        content.append(buffer, count);
    return content;
}

} // namespace

void write_file(const std::filesystem::path& path, std::string_view content) {
    if (path == "-") {
        if (std::fwrite(content.data(), 1, content.size(), stdout) != content.size() ||
            std::fflush(stdout) != 0)
            fail("standard output", "cannot be written", errno);
        return;
    }
    std::filesystem::path temporary = path;
    temporary += fmt::format(".part{}", ::getpid());
    File file(temporary, "wb");
    if (file.get() == nullptr) fail(path, "cannot be written", errno);
    const bool written =
        std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
    const int error = errno;
    if (!written || !file.close()) {
        const int reason = written ? errno : error;
        std::remove(temporary.c_str());
        fail(path, "cannot be written", reason);
    }
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
        const int reason = errno;
        std::remove(temporary.c_str());
        fail(path, "cannot be replaced", reason);
    }
}

std::string read_file(const std::filesystem::path& path) {
    if (path == "-") return read_all(stdin);
    if (std::filesystem::is_directory(path)) fail(path, "cannot be read", EISDIR);
    const File file(path, "rb");
    if (file.get() == nullptr) fail(path, "cannot be read", errno);
    std::string content = read_all(file.get());
    if (std::ferror(file.get()) != 0) fail(path, "cannot be read", errno);
    return content;
}

std::string extension(const std::filesystem::path& path) {
    std::string result = path.extension().string();
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

} // namespace batten
