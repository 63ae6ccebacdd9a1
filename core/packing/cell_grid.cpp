#include "core/packing/cell_grid.hpp"

#include <fmt/format.h>

#include <limits>

#include "core/base/error.hpp"

namespace tomodem {

double half_of_shortest_period(const Box& box) {
    double half = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        if (box.periodic[axis]) half = std::min(half, 0.5 * box.edges[axis]);
    return half;
}

CellGrid::CellGrid(std::span<const Vec3> points, const Box& box, double cutoff) : box_(box), cutoff_(cutoff) {
    if (!(cutoff > 0.0)) throw InvalidInput(fmt::format("a cutoff of {:g} mm for neighbours is not positive", cutoff));
    // Half an edge, but for rounding.
    if (cutoff > half_of_shortest_period(box) * (1.0 + 1e-12))
        throw InvalidInput(fmt::format(
            "a cutoff of {:g} mm for neighbours is more than half of the shortest periodic edge of the box, "
            "{:g} mm",
            cutoff, 2.0 * half_of_shortest_period(box)));
    if (points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        throw InvalidInput(fmt::format("{} points are too many for a table of neighbours", points.size()));
    low_ = box.origin;
    Vec3 high = box.origin + box.edges;
    Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity()), max = -min;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].allFinite())
            throw InvalidInput(fmt::format("point {} (counted from 1) has a coordinate that is not a number", i + 1));
        min = min.cwiseMin(points[i]);
        max = max.cwiseMax(points[i]);
    }
    for (int axis = 0; axis < 3; ++axis)
        if (!box.periodic[axis] && !points.empty()) {
            low_[axis] = min[axis];
            high[axis] = max[axis];
        }
    length_ = (high - low_).cwiseMax(cutoff);
    const double one_each = std::cbrt(static_cast<double>(points.size() + 1) / length_.prod());
    for (int axis = 0; axis < 3; ++axis) {
        count_[axis] = static_cast<int>(
            std::max(1.0, std::min(length_[axis] / cutoff * (1.0 + 1e-12), std::ceil(length_[axis] * one_each))));
        if (box.periodic[axis] && count_[axis] < 3) {
            count_[axis] = 1;
            folded_ = true;
        }
    }
    sort(points);
}

Vec3 CellGrid::wrapped(Vec3 point) const {
    for (int axis = 0; axis < 3; ++axis)
        if (box_.periodic[axis]) {
            double s = point[axis] - low_[axis];
            s -= length_[axis] * std::floor(s / length_[axis]);
            point[axis] = low_[axis] + (s < length_[axis] ? s : 0.0);
        }
    return point;
}

void CellGrid::sort(std::span<const Vec3> points) {
    std::vector<std::size_t> cell_of(points.size());
    start_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = wrapped(points[i]);
        cell_of[i] =
            (static_cast<std::size_t>(cell(2, p.z())) * count_[1] + cell(1, p.y())) * count_[0] + cell(0, p.x());
        ++start_[cell_of[i] + 1];
    }
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    index_.resize(points.size());
    sorted_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t place = next[cell_of[i]]++;
        index_[place] = static_cast<std::int32_t>(i);
        sorted_[place] = wrapped(points[i]);
    }
}

}  // namespace tomodem
