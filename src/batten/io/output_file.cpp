#include <batten/io/output_file.hpp>

#include <batten/core/counts.hpp>
#include <batten/core/errors.hpp>
#include <batten/io/output_set.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>

namespace batten {

namespace {

/// A C file closed with its scope.
class File {
  public:
    explicit File(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "rbe")) {}
    ~File() {
        if (file_ != nullptr) std::fclose(file_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    std::FILE* get() const { return file_; }

  private:
    std::FILE* file_;
};

[[noreturn]] void fail(const std::string& name, int error) {
    throw FileError(fmt::format("{}: cannot be read: {}", name, std::strerror(error)));
}

std::string read_all(const std::string& name, std::FILE* file) {
    std::string content;
    char buffer[1 << 16];
    std::size_t asked_at = 1 << 26; // a stream may have no end
    while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file)) {
        content.append(buffer, count);
        if (content.size() < asked_at) continue;
        asked_at *= 2;
        check_memory(static_cast<Index>(asked_at / sizeof(double)), name);
    }
    if (std::ferror(file) != 0) fail(name, errno);
    return content;
}

} // namespace

void write_file(const std::filesystem::path& path, std::string content) {
    OutputSet output;
    output.add(path, std::move(content));
    output.put_in_place();
}

std::string read_file(const std::filesystem::path& path) {
    if (path == "-") return read_all("standard input", stdin);
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) fail(path.string(), EISDIR);
    const File file(path);
    if (file.get() == nullptr) fail(path.string(), errno);
    return read_all(path.string(), file.get());
}

std::string extension(const std::filesystem::path& path) {
    std::string result = path.extension().string();
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

std::string extension_or(const std::filesystem::path& path, std::string_view otherwise) {
    std::string wanted = extension(path);
    return wanted.empty() && is_stream(path) ? std::string(otherwise) : wanted;
}

} // namespace batten
