#include "tools/metrics/fields/space_average.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.hpp"
#include "core/packing/cell_grid.hpp"

namespace tomodem::fields {
namespace {

constexpr double gaussian_reach = 1.5;  // radii; 3.35 standard deviations

/// Sums of `width` components at a time: the compiler keeps them in registers.
template <int width>
void average(const CellGrid& grid, std::span<const Vec3> points, std::span<const double> values,
             const SpaceAverage& average, int threads, std::vector<double>& result) {
    // With the particles cell by cell, what is averaged lies close together.
    const std::span<const std::int32_t> order = grid.order();
    const bool gaussian = average.kernel == Kernel::gaussian;
    const double sharpness = -2.5 / (average.radius * average.radius);  // -1 / 2 sd^2, sd^2 = radius^2 / 5
    for_blocks(points.size(), threads, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t place = first; place < last; ++place) {
            const auto i = static_cast<std::size_t>(order[place]);
            std::array<double, width> sum{};
            double weights = 0.0;
            grid.near(points[i], [&](std::int32_t j, const Vec3&, double squared) {
                if (!average.species.empty() && average.species[static_cast<std::size_t>(j)] != average.species[i])
                    return;
                const double weight = gaussian ? std::exp(sharpness * squared) : 1.0;
                const double* row = values.data() + static_cast<std::size_t>(j) * width;
                for (int k = 0; k < width; ++k) sum[k] += weight * row[k];
                weights += weight;
            });
            for (int k = 0; k < width; ++k) result[i * width + k] = sum[k] / weights;
        }
    });
}

}  // namespace

double reach_of(Kernel kernel, double radius) {
    return kernel == Kernel::ball ? radius : gaussian_reach * radius;
}

std::vector<double> averaged_in_space(std::span<const Vec3> points, const Box& box, std::span<const double> values,
                                      int components, const SpaceAverage& wanted, int threads) {
    const CellGrid grid(points, box, reach_of(wanted.kernel, wanted.radius));
    std::vector<double> result(values.size());
    if (components == 6) {
        average<6>(grid, points, values, wanted, threads, result);
    } else {
        std::vector<double> one(points.size()), averaged(points.size());
        for (int k = 0; k < components; ++k) {
            for (std::size_t i = 0; i < points.size(); ++i) one[i] = values[i * components + k];
            average<1>(grid, points, one, wanted, threads, averaged);
            for (std::size_t i = 0; i < points.size(); ++i) result[i * components + k] = averaged[i];
        }
    }
    return result;
}

double signed_equivalent(std::span<const double, 6> s) {
    const double mean = (s[0] + s[1] + s[2]) / 3.0;
    double squares = 0.0;
    for (int k = 0; k < 3; ++k) squares += (s[k] - mean) * (s[k] - mean) + 2.0 * s[3 + k] * s[3 + k];
    return (mean < 0.0 ? -1.0 : 1.0) * std::sqrt(1.5 * squares);
}

double pressure(std::span<const double, 6> s) {
    return -(s[0] + s[1] + s[2]) / 3.0;
}

}  // namespace tomodem::fields
