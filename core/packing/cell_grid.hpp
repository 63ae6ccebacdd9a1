#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem {

/// The difference of two coordinates, to the nearest periodic image.
inline double nearest_image(double difference, double edge) {
    return difference - edge * std::nearbyint(difference / edge);
}

/// Infinity where no axis is periodic.
double half_of_shortest_period(const Box& box);

/// Neighbours of each point within a cutoff, without a list of pairs: points sorted into cells no shorter than the
/// cutoff.
///
/// The box repeats along its periodic axes; along the others points may lie anywhere. Points are visited in an order
/// that depends on the points alone.
class CellGrid {
 public:
    /// @param cutoff  more than 0, at most half of the shortest periodic edge
    /// @throws InvalidInput if it is not, or a point is not finite
    /// @note   time and memory O(N): 36 bytes a point
    CellGrid(std::span<const Vec3> points, const Box& box, double cutoff);

    /// Calls visit(index, separation, squared distance) for the points within the cutoff of one of them, itself too.
    template <class Visit>
    void near(const Vec3& point, const Visit& visit) const {
        if (folded_)
            scan<true>(point, visit);
        else
            scan<false>(point, visit);
    }

    /// Indices of the points cell by cell: in this order, points that are near come near each other in memory.
    std::span<const std::int32_t> order() const { return index_; }

 private:
    Vec3 wrapped(Vec3 point) const;
    int cell(int axis, double s) const {
        return std::clamp(static_cast<int>((s - low_[axis]) / length_[axis] * count_[axis]), 0, count_[axis] - 1);
    }
    void sort(std::span<const Vec3> points);

    template <bool folded, class Visit>
    void scan(const Vec3& point, const Visit& visit) const {
        const Vec3 from = wrapped(point);
        const double squared_cutoff = cutoff_ * cutoff_;
        std::array<int, 3> at, first, last;
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = cell(axis, from[axis]);
            const bool alone = count_[axis] == 1, open = !box_.periodic[axis];
            first[axis] = alone || (open && at[axis] == 0) ? 0 : -1;
            last[axis] = alone || (open && at[axis] == count_[axis] - 1) ? 0 : 1;
        }
        std::array<int, 3> offset;
        for (offset[2] = first[2]; offset[2] <= last[2]; ++offset[2])
            for (offset[1] = first[1]; offset[1] <= last[1]; ++offset[1])
                for (offset[0] = first[0]; offset[0] <= last[0]; ++offset[0]) {
                    Vec3 seen_from = from;
                    std::array<int, 3> c;
                    for (int axis = 0; axis < 3; ++axis) {
                        c[axis] = at[axis] + offset[axis];
                        if (c[axis] < 0) {
                            c[axis] += count_[axis];
                            seen_from[axis] += length_[axis];
                        } else if (c[axis] == count_[axis]) {
                            c[axis] = 0;
                            seen_from[axis] -= length_[axis];
                        }
                    }
                    const std::size_t number = (static_cast<std::size_t>(c[2]) * count_[1] + c[1]) * count_[0] + c[0];
                    for (std::size_t k = start_[number]; k < start_[number + 1]; ++k) {
                        Vec3 apart = sorted_[k] - seen_from;
                        if constexpr (folded)
                            for (int axis = 0; axis < 3; ++axis)
                                if (box_.periodic[axis]) apart[axis] = nearest_image(apart[axis], length_[axis]);
                        const double squared = apart.squaredNorm();
                        if (squared < squared_cutoff) visit(index_[k], apart, squared);
                    }
                }
    }

    Box box_;
    double cutoff_;
    Vec3 low_, length_;
    std::array<int, 3> count_{};
    bool folded_ = false;  ///< some periodic axis has one cell
    std::vector<std::size_t> start_;
    std::vector<std::int32_t> index_;
    std::vector<Vec3> sorted_;
};

}  // namespace tomodem
