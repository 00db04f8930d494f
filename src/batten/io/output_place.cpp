#include <batten/io/output_place.hpp>

#include <batten/core/errors.hpp>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace batten {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& name, int error) {
    throw FileError(fmt::format("{}: cannot be written: {}",
                                name == "-" ? "standard output" : name.string(),
                                std::strerror(error)));
}

/// The number of a name in the kernel's folder of this process's descriptors.
std::optional<int> descriptor_in(const fs::path& folder, const std::string& name) {
    if (folder.filename() != "fd" ||
        !folder.string().starts_with(fmt::format("/proc/{}/", ::getpid())))
        return std::nullopt;
    int number = -1;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
    return number;
}

struct Followed {
    fs::path path;
    std::optional<int> descriptor;
};

/// The real folder of `name`; throws FileError for `asked`.
fs::path real_folder(const fs::path& asked, const fs::path& name) {
    const fs::path folder = name.has_parent_path() ? name.parent_path() : ".";
    std::error_code error;
    fs::path real = fs::canonical(folder, error);
    if (!error && !fs::is_directory(real, error)) error = {ENOTDIR, std::generic_category()};
    if (error == std::errc::no_such_file_or_directory)
        throw FileError(
            fmt::format("{}: the folder {} does not exist", asked.string(), folder.string()));
    if (error) fail(asked, error.value());
    return real;
}

/// Goes behind symbolic links one by one, for the last may lead where there is nothing yet, and
/// those of open descriptors lead nowhere.
Followed followed(const fs::path& asked) {
    fs::path name = asked;
    for (int links = 0; links < 40; ++links) {
        const fs::path folder = real_folder(asked, name);
        const std::string last = name.filename().string();
        if (last.empty() || last == "." || last == "..") fail(asked, EISDIR);
        if (const auto number = descriptor_in(folder, last)) return {{}, number};
        const fs::path here = folder / last;
        std::error_code error;
        if (!fs::is_symlink(fs::symlink_status(here, error))) return {here, std::nullopt};
        const fs::path target = fs::read_symlink(here, error);
        if (error) fail(asked, error.value());
        name = folder / target;
    }
    fail(asked, ELOOP);
}

void check_permission(const fs::path& asked, const fs::path& path, int mode) {
    if (::faccessat(AT_FDCWD, path.c_str(), mode, AT_EACCESS) != 0) fail(asked, errno);
}

/// What makes two names one: the descriptor they stand for, the file's inode, or where there is no
/// file yet its name in its folder's.
struct Identity {
    int descriptor = -1;
    dev_t device = 0;
    ino_t inode = 0;
    std::string name{};
    /// Whether something is there that another use could spoil.
    bool holds = true;
};

Identity identity_of(const struct stat& status) {
    return {.device = status.st_dev,
            .inode = status.st_ino,
            .holds = !S_ISCHR(status.st_mode) && !S_ISSOCK(status.st_mode)};
}

bool same(const Identity& a, const Identity& b) {
    if (a.descriptor >= 0 && a.descriptor == b.descriptor) return true;
    return a.holds && b.holds && a.device == b.device && a.inode == b.inode && a.name == b.name;
}

Identity identity_of(const OutputPlace& place) {
    struct stat status {};
    if (place.kind == OutputKind::descriptor) {
        if (::fstat(place.descriptor, &status) != 0) return {.descriptor = place.descriptor};
        Identity identity = identity_of(status);
        identity.descriptor = place.descriptor;
        return identity;
    }
    if (::stat(place.path.c_str(), &status) == 0) return identity_of(status);
    if (::stat(place.path.parent_path().c_str(), &status) != 0) return {.holds = false};
    Identity identity = identity_of(status);
    identity.name = place.path.filename().string();
    return identity;
}

std::optional<Identity> identity_of_input(const fs::path& name) {
    struct stat status {};
    const int answer = name == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(name.c_str(), &status);
    if (answer != 0) return std::nullopt; // reading will say so
    return identity_of(status);
}

} // namespace

OutputPlace output_place(const fs::path& name) {
    if (name.empty()) throw InvalidInput("an output has no name");
    const Followed end = name == "-" ? Followed{{}, STDOUT_FILENO} : followed(name);
    if (end.descriptor) {
        if (::fcntl(*end.descriptor, F_GETFD) < 0) fail(name, errno);
        return {OutputKind::descriptor, *end.descriptor, {}};
    }
    struct stat status {};
    if (::stat(end.path.c_str(), &status) != 0) {
        if (errno != ENOENT) fail(name, errno);
        check_permission(name, end.path.parent_path(), W_OK | X_OK);
        return {OutputKind::file, -1, end.path};
    }
    if (S_ISDIR(status.st_mode)) fail(name, EISDIR);
    check_permission(name, end.path, W_OK);
    if (!S_ISREG(status.st_mode)) return {OutputKind::stream, -1, end.path};
    check_permission(name, end.path.parent_path(), W_OK | X_OK);
    return {OutputKind::file, -1, end.path};
}

bool is_stream(const fs::path& name) {
    if (name == "-") return true;
    try {
        if (followed(name).descriptor) return true;
    } catch (const FileError&) {
        return false;
    }
    std::error_code error;
    const fs::file_status status = fs::status(name, error);
    return !error && fs::exists(status) && !fs::is_regular_file(status) &&
           !fs::is_directory(status);
}

void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs) {
    std::vector<Identity> written;
    for (const FileUse& output : outputs) {
        const Identity mine = identity_of(output_place(output.path));
        for (std::size_t k = 0; k < written.size(); ++k)
            if (same(written[k], mine))
                throw InvalidInput(fmt::format("{}: it would be written twice, as {} and as {}",
                                               output.path.string(), outputs[k].use, output.use));
        for (const FileUse& input : inputs) {
            const auto read = identity_of_input(input.path);
            if (read && same(*read, mine))
                throw InvalidInput(
                    fmt::format("{}: it is the file of {}", output.path.string(), input.use));
        }
        written.push_back(mine);
    }
}

} // namespace batten
