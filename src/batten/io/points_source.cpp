#include <batten/io/points_file.hpp>

#include <batten/core/counts.hpp>
#include <batten/core/errors.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/samples/scan.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr std::size_t most_numbers = std::size_t{1} << 24U; // of a chunk

/// All numbers of a pass, which is how many rows a text has.
std::vector<Index> counted_shape(NumberReader& reader) {
    LargeArray part(std::size_t{1} << 16U);
    while (reader.read({part.data(), part.size()}) > 0) continue;
    std::vector<Index> shape = reader.shape();
    reader.rewind();
    return shape;
}

/// Samples of a file, a chunk at a time in one buffer.
class FileSource final : public SampleSource {
  public:
    FileSource(const std::filesystem::path& path, std::unique_ptr<NumberReader> reader,
               const ReadOptions& options, Order order)
        : reader_(std::move(reader)), spacing_(options.spacing), heights_(options.heights) {
        std::vector<Index> shape = reader_->shape();
        if (heights_ && shape[0] < 0) shape = counted_shape(*reader_);
        if (heights_) {
            const auto rows = height_shape(path, shape);
            const double flat = 0;
            height_samples({&flat, 1, 1}, {1, 1}, spacing_); // the spacing is good
            grid_ = {rows[0], rows[1]};
        } else {
            numbers_each_ = point_dim(path, shape);
            grid_ = point_grid(shape, options);
        }
        order_ = grid_.empty() ? order : Order::along_curve;
        if (!heights_ && shape.size() > 1) shape.pop_back(); // coordinates
        known_ = shape[0] >= 0;
        size_ = known_ ? checked_product(shape, path.string()) : -1;
        if (!known_ && !grid_.empty()) size_ = checked_product(grid_, "grid");
        if (size_ >= 0) check_count(size_);
    }

    Index dim() const override { return heights_ ? 3 : numbers_each_; }
    Index size() const override { return size_; }
    std::vector<Index> grid() const override { return grid_; }
    Order order() const override { return order_; }
    Spacing spacing() const override { return heights_ ? Spacing::even : Spacing::free; }
    std::vector<std::string> notes() const override { return reader_->notes(); }
    Index bytes() const override { return static_cast<Index>(reader_->bytes_read()); }

    void rewind() override {
        reader_->rewind();
        next_ = 0;
    }

    Points next(Index most) override {
        const Index first = next_;
        Index wanted = std::min(most, static_cast<Index>(most_numbers) / dim());
        if (size_ >= 0) wanted = std::min(wanted, std::max<Index>(0, size_ - first));
        const auto numbers = static_cast<std::size_t>(wanted * numbers_each_);
        if (buffer_.size() < numbers) buffer_.resize(numbers);
        std::size_t got = 0;
        while (got < numbers) {
            const std::size_t more = reader_->read({buffer_.data() + got, numbers - got});
            if (more == 0) break;
            got += more;
        }
        const Index count = static_cast<Index>(got) / numbers_each_;
        check_finite(count);
        next_ += count;
        if (!known_ && (count < wanted || next_ == size_)) end();
        if (heights_) return raised(first, count);
        return {buffer_.data(), count, numbers_each_};
    }

  private:
    void check_count(Index count) const {
        check_shape({.points = {static_cast<const double*>(nullptr), count, dim()}, .grid = grid_});
    }

    /// Of a text's first pass: now the number of samples is known, and whether it makes the grid.
    void end() {
        Index rest = 0;
        LargeArray part(static_cast<std::size_t>(numbers_each_) * 256);
        while (const std::size_t more = reader_->read({part.data(), part.size()}))
            rest += static_cast<Index>(more) / numbers_each_;
        check_count(next_ + rest);
        size_ = next_;
        known_ = true;
    }

    void check_finite(Index count) const {
        PointScan scan(numbers_each_);
        scan.add(buffer_.data(), count);
        const Index bad = scan.first_bad();
        if (bad < 0) return;
        const InvalidInput what =
            not_finite(next_ + bad, Points(buffer_.data(), count, numbers_each_)[bad]);
        throw InvalidInput(fmt::format("{}: {}", reader_->not_finite_place(), what.what()));
    }

    /// Heights over their places in the grid.
    Points raised(Index first, Index count) {
        const auto numbers = static_cast<std::size_t>(3 * count);
        if (raised_.size() < numbers) raised_.resize(numbers);
        for (Index i = 0; i < count; ++i) {
            double* point = raised_.data() + 3 * i;
            point[0] = static_cast<double>((first + i) / grid_[1]) * spacing_[0];
            point[1] = static_cast<double>((first + i) % grid_[1]) * spacing_[1];
            point[2] = buffer_[static_cast<std::size_t>(i)];
        }
        return {raised_.data(), count, 3};
    }

    std::unique_ptr<NumberReader> reader_;
    std::array<double, 2> spacing_;
    bool heights_;
    Index numbers_each_ = 1; ///< of a sample in the file
    std::vector<Index> grid_;
    Order order_ = Order::along_curve;
    bool known_ = false; ///< the number of samples; else a grid's may be stated
    Index size_ = -1;
    Index next_ = 0;
    LargeArray buffer_;
    LargeArray raised_;
};

} // namespace

std::unique_ptr<SampleSource> open_points(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    check_options(path, options);
    const PointFormat& format = point_format(path);
    return std::make_unique<FileSource>(
        path, format.open_for_passes(path, open_bytes(path, ReadAgain::yes, options.observer)),
        options, format.order);
}

} // namespace batten
