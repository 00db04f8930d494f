#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace batten {

/// How an output comes to where it belongs.
enum class OutputKind {
    descriptor, ///< open already (`-`, /dev/stdout, /dev/fd/N): written into
    stream,     ///< a device, FIFO or socket: written into
    file,       ///< a regular file, or none yet: replaced as a whole
};

/// Where an output's name leads.
struct OutputPlace {
    OutputKind kind = OutputKind::file;
    int descriptor = -1;
    /// Behind all symbolic links, absolute; empty for a descriptor.
    std::filesystem::path path{};
};

/// Follows the name. Throws FileError when the folder does not exist, the place is a folder, or it
/// cannot be written; InvalidInput for an empty name.
OutputPlace output_place(const std::filesystem::path& name);

/// Whether the name stands for an open descriptor, a device, FIFO or socket, read or written: such
/// names need no extension.
bool is_stream(const std::filesystem::path& name);

/// A file's name with what it is used for, as the caller calls it: "the points", "--weights".
struct FileUse {
    std::filesystem::path path;
    std::string use;
};

/// Asked before anything is read, so that work is not lost: throws FileError for an output that
/// cannot be written, InvalidInput for one that is also an input or another output, by whatever
/// name. `-` is standard input or output. Devices and sockets hold nothing that could be lost:
/// these may be both.
void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs);

} // namespace batten
