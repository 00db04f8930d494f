#include "readers.hpp"

#include <batten/io/text_reader.hpp>

namespace batten {
namespace {

using testing::message_of;
using testing::passed;
using testing::Readers;
using testing::Written;
using testing::written;

std::vector<double> all_of(const std::string& name, const std::string& text,
                           const TextParts& parts) {
    const NumberArray array = TextReader(name, bytes_in_memory(text), parts).all();
    return {array.values.values().begin(), array.values.values().end()};
}

TEST_F(Readers, text_is_the_same_wherever_parts_end) {
    std::size_t seed = 0;
    for (const std::string separator : {",", ";", " ", "\t", " , ", ",\t "})
        for (const std::string head : {"", "x, y, z", "# x", "\xEF\xBB\xBF\"x\";\"y\""})
            for (const bool comments : {false, true})
                for (const std::string line_end : {"\n", "\r\n"})
                    for (const bool ends : {false, true}) {
                        const Written w = written({separator, head, comments, line_end, ends, 9},
                                                  static_cast<unsigned>(++seed));
                        SCOPED_TRACE(w.text);
                        EXPECT_EQ(all_of("a.csv", w.text, {}), w.numbers);
                        // over all texts a part ends at every place
                        for (std::size_t window = 16 + seed % 11; window < w.text.size() + 11;
                             window += 11) {
                            const TextParts parts{window, 1 + window % 40};
                            ASSERT_EQ(all_of("a.csv", w.text, parts), w.numbers) << window;
                            TextReader reader("a.csv", bytes_in_memory(w.text), parts);
                            ASSERT_EQ(passed(reader, 1 + window % 9), w.numbers) << window;
                            ASSERT_EQ(passed(reader, 1000), w.numbers) << window;
                            ASSERT_EQ(reader.shape(), (std::vector<Index>{9, 3}));
                        }
                    }
}

TEST_F(Readers, every_place_of_one_text_is_an_end_of_a_part) {
    const Written w = written({", ", "x,y,z", true, "\r\n", false, 12}, 7);
    for (std::size_t window = 16; window < w.text.size() + 2; ++window)
        for (const std::size_t block : {1, 30, 1000})
            ASSERT_EQ(all_of("a.txt", w.text, {window, block}), w.numbers) << window;
}

TEST_F(Readers, faults_have_their_line_wherever_parts_end) {
    const Written w = written({",", "x,y,z", false, "\n", true, 8}, 3);
    const std::string bad = w.text + "\n# more\n1, 2,four\n1,2\n";
    const std::string wide = w.text + "1,2\n1,x,2\n";
    const std::string airfoil = "NAME\n2412\n" + w.text.substr(6) + "notes, 7\nmore\n\n1,2,3\n";
    for (std::size_t window = 16; window < bad.size() + 2; ++window)
        for (const std::size_t block : {1, 50}) {
            const TextParts parts{window, block};
            const auto words = [&](const char* name, const std::string& text) {
                return message_of<FileError>([&] { all_of(name, text, parts); });
            };
            ASSERT_EQ(words("a.csv", bad), "a.csv:12:6: 'four' is not a number");
            ASSERT_EQ(words("a.csv", wide), "a.csv:10: 2 numbers where the rows before have 3");
            ASSERT_EQ(words("a.dat", airfoil),
                      "a.dat:14: numbers after a line of text that ended the points");
            const std::string sound = airfoil.substr(0, airfoil.size() - 6);
            TextReader reader("a.dat", bytes_in_memory(sound), parts);
            ASSERT_EQ(passed(reader, 5), w.numbers);
            ASSERT_EQ(reader.notes(),
                      std::vector<std::string>{"2 lines of text after the points left out"});
        }
}

TEST(LargeArrays, grow_with_what_is_in_them) {
    LargeArray a;
    for (std::size_t size = 1; size < 3'000'000; size = 3 * size + 1) {
        const std::size_t before = a.size();
        a.resize(size);
        for (std::size_t k = before; k < size; ++k) a.data()[k] = static_cast<double>(k);
    }
    for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k], static_cast<double>(k));
    const std::size_t size = a.size();
    const Points points = std::move(a).points(static_cast<Index>(size), 1);
    EXPECT_EQ(points(static_cast<Index>(size) - 1, 0), static_cast<double>(size - 1));
    EXPECT_TRUE(a.empty());
    EXPECT_THROW(LargeArray(std::size_t{1} << 60U), std::bad_alloc);
}

} // namespace
} // namespace batten
