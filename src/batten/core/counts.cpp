#include <batten/core/counts.hpp>

#include <batten/core/errors.hpp>

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace batten {

namespace {

constexpr auto unlimited = std::numeric_limits<std::uint64_t>::max();

/// A number of bytes that a file of the kernel states; unlimited when it is not there or says so.
std::uint64_t stated_bytes(const char* path) {
    std::ifstream file(path);
    std::uint64_t bytes = 0;
    return file >> bytes ? bytes : unlimited;
}

/// Bytes that the machine has left, what it can drop or swap out counted in.
std::uint64_t machine_left() {
    std::ifstream file("/proc/meminfo");
    std::uint64_t kibibytes = 0;
    bool known = false;
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("MemAvailable:") || line.starts_with("SwapFree:")) {
            kibibytes += std::stoull(line.substr(line.find(':') + 1));
            known = true;
        }
    return known ? 1024 * kibibytes : unlimited;
}

std::uint64_t less(std::uint64_t limit, std::uint64_t used) {
    return limit == unlimited ? limit : limit - std::min(limit, used);
}

/// Bytes that this process's own limit leaves it.
std::uint64_t process_left() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return less(limit.rlim_cur, pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)));
}

/// Bytes that the container around the process leaves it.
std::uint64_t container_left() {
    return less(stated_bytes("/sys/fs/cgroup/memory.max"),
                stated_bytes("/sys/fs/cgroup/memory.current"));
}

std::string size_words(double bytes) {
    return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6)
                       : fmt::format("{:.3g} GB", bytes / 1e9);
}

} // namespace

Index checked_product(std::span<const Index> counts, std::string_view what) {
    Index product = 1;
    bool beyond = false;
    for (Index n : counts) {
        if (n < 0)
            throw InvalidInput(
                fmt::format("{}: {} in {} is negative", what, n, fmt::join(counts, "x")));
        beyond = beyond || (product > 0 && n > std::numeric_limits<Index>::max() / product);
        if (!beyond) product *= n;
    }
    if (beyond && std::ranges::count(counts, 0) == 0)
        throw InvalidInput(
            fmt::format("{}: {} is more than can be counted", what, fmt::join(counts, "x")));
    return beyond ? 0 : product;
}

void check_memory(Index doubles, std::string_view what) {
    constexpr Index always = 1 << 20; // the questions below cost more than these few
    if (doubles <= always) return;
    const double needed = static_cast<double>(doubles) * sizeof(double);
    const auto left =
        static_cast<double>(std::min({machine_left(), process_left(), container_left()}));
    if (needed > left)
        throw InvalidInput(fmt::format("{}: {} of memory would be needed, {} are left", what,
                                       size_words(needed), size_words(left)));
}

} // namespace batten
