#include <batten/io/output_file.hpp>

#include <batten/core/counts.hpp>
#include <batten/io/byte_source.hpp>
#include <batten/io/output_set.hpp>

namespace batten {

void write_file(const std::filesystem::path& path, std::string content) {
    OutputSet output;
    output.add(path, std::move(content));
    output.put_in_place();
}

std::string read_file(const std::filesystem::path& path) {
    const std::unique_ptr<ByteSource> bytes = open_bytes(path, ReadAgain::no);
    std::string content;
    std::size_t room =
        bytes->size() < 0 ? std::size_t{1} << 16U : static_cast<std::size_t>(bytes->size()) + 1;
    for (std::size_t there = 0;; room *= 2) { // a stream may have no end
        check_memory(static_cast<Index>(room / sizeof(double)), input_name(path));
        content.resize(room);
        there += bytes->read({content.data() + there, room - there});
        if (there == room) continue;
        content.resize(there);
        return content;
    }
}

std::string extension(const std::filesystem::path& path) {
    std::string result = path.extension().string();
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

std::string inner_extension(const std::filesystem::path& path) {
    const std::string outer = extension(path);
    return outer == ".gz" ? extension(path.stem()) : outer;
}

std::string extension_or(const std::filesystem::path& path, std::string_view otherwise) {
    std::string wanted = extension(path);
    return wanted.empty() && is_stream(path) ? std::string(otherwise) : wanted;
}

} // namespace batten
