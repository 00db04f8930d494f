#include <batten/system/sample_groups.hpp>

#include <fmt/format.h>

namespace batten {

SampleGroups::SampleGroups(std::vector<std::vector<SampleRange>> ranges,
                           const std::vector<Index>& shape, std::vector<double> weights)
    : ranges_(std::move(ranges)), shape_(shape), weights_(std::move(weights)) {
    Index controls = 1;
    for (std::size_t axis = 0; axis < ranges_.size(); ++axis) {
        controls *= static_cast<Index>(ranges_[axis].size());
        for (std::size_t i = 0; i < ranges_[axis].size(); ++i)
            if (ranges_[axis][i].begin >= ranges_[axis][i].end || ranges_[axis][i].begin < 0 ||
                ranges_[axis][i].end > shape_[axis])
                throw InvalidInput(fmt::format(
                    "axis {}: the group of control point {} would hold no samples", axis, i));
    }
    count(controls);
}

SampleGroups::SampleGroups(std::vector<GroupMember> members, Index controls,
                           std::vector<double> weights)
    : members_(std::move(members)), weights_(std::move(weights)) {
    count(controls);
}

void SampleGroups::count(Index controls) {
    total_.assign(static_cast<std::size_t>(controls), 0);
    for_each_member([&](Index control, Index sample) {
        total_[static_cast<std::size_t>(control)] += weight(sample);
    });
}

PointSet SampleGroups::means(const PointSet& values) const {
    PointSet result(size(), values.dim());
    for_each_member([&](Index control, Index sample) {
        const double weight = this->weight(sample);
        for (Index d = 0; d < values.dim(); ++d) result(control, d) += weight * values(sample, d);
    });
    for (Index i = 0; i < size(); ++i) {
        const double total = total_[static_cast<std::size_t>(i)];
        for (double& x : result[i]) x = total > 0 ? x / total : 0;
    }
    return result;
}

DataSide::DataSide(std::vector<KnotVector> axes, const Samples& samples,
                   const Parameters& parameters, SampleGroups groups)
    : axes_(std::move(axes)),
      samples_(samples),
      parameters_(parameters),
      groups_(std::move(groups)) {
    for (std::size_t k = 0; k < parameters_.axes.size(); ++k)
        collocations_.emplace_back(axes_[k], parameters_.axes[k]);
}

PointSet DataSide::values(const PointSet& control) const {
    if (parameters_.is_scattered())
        return evaluate(Spline::from_free(axes_, control), parameters_.scattered);
    std::vector<double> grid = control.values();
    Index inner = control.dim();
    for (std::size_t k = collocations_.size(); k-- > 0;) {
        grid = collocations_[k].apply_along(grid, inner);
        inner *= collocations_[k].rows();
    }
    return {std::move(grid), control.dim()};
}

PointSet DataSide::residual(const PointSet& control) const {
    PointSet result(samples_.points);
    add_scaled(result, -1.0, values(control));
    return result;
}

} // namespace batten
