#include "tools/metrics/fields/local_strain_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/blocks.hpp"
#include "core/packing/cell_grid.hpp"

namespace tomodem::fields {
namespace {

constexpr int min_neighbours = 4;
constexpr double flatness = 0.01;  // smallest over largest eigenvalue of Y

Symmetric components(const Eigen::Matrix3d& m) {
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
}

bool flat(const Eigen::Matrix3d& spread) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> values;
    values.computeDirect(spread, Eigen::EigenvaluesOnly);
    return !(values.eigenvalues()[0] > flatness * values.eigenvalues()[2]);
}

}  // namespace

LocalStrain local_strain(std::span<const Vec3> reference, const Box& reference_box, std::span<const Vec3> present,
                         const Box& present_box, double radius, double length, std::span<const std::int32_t> species,
                         int threads) {
    const std::size_t count = reference.size();
    const CellGrid grid(reference, reference_box, radius);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    constexpr Symmetric no_tensor{none, none, none, none, none, none};
    LocalStrain result{std::vector<Symmetric>(count, no_tensor), std::vector<Symmetric>(count, no_tensor),
                       std::vector<double>(count, none),         std::vector<double>(count, none),
                       std::vector<double>(count, none),         0};
    std::vector<std::int64_t> degenerate(blocks_of(count), 0);

    /// What the image of a neighbour moves besides the neighbour itself: as many edges as it is away in the reference.
    const auto of_image = [&](std::size_t i, std::size_t j, const Vec3& apart) {
        Vec3 moved = Vec3::Zero();
        for (int axis = 0; axis < 3; ++axis)
            if (reference_box.periodic[axis]) {
                const double edges =
                    (apart[axis] - (reference[j][axis] - reference[i][axis])) / reference_box.edges[axis];
                moved[axis] = std::nearbyint(edges) * present_box.edges[axis];
            }
        return moved;
    };

    for_blocks(count, threads, [&](std::size_t block, std::size_t first, std::size_t last) {
        for (std::size_t place = first; place < last; ++place) {
            const auto i = static_cast<std::size_t>(grid.order()[place]);
            Eigen::Matrix3d X = Eigen::Matrix3d::Zero(), Y = X;
            double squares = 0.0;
            int neighbours = 0;
            grid.near(reference[i], [&](std::int32_t neighbour, const Vec3& before, double) {
                const auto j = static_cast<std::size_t>(neighbour);
                if (j == i || (!species.empty() && species[j] != species[i])) return;
                const Vec3 now = present[j] - present[i] + of_image(i, j, before);
                X.noalias() += now * before.transpose();
                Y.noalias() += before * before.transpose();
                squares += now.squaredNorm();
                ++neighbours;
            });
            if (neighbours < min_neighbours || flat(Y)) {
                ++degenerate[block];
                continue;
            }
            const Eigen::Matrix3d F = X * Y.inverse();
            const double growth = F.determinant();
            if (!(growth > 0.0)) {
                ++degenerate[block];
                continue;
            }
            result.small[i] = components(0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity());
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> stretch(F * F.transpose());
            const Vec3 strains = 0.5 * stretch.eigenvalues().array().log();
            result.logarithmic[i] =
                components(stretch.eigenvectors() * strains.asDiagonal() * stretch.eigenvectors().transpose());
            result.volumetric[i] = std::log(growth);
            const Vec3 deviator = strains.array() - strains.mean();
            result.equivalent[i] = std::sqrt(2.0 / 3.0 * deviator.squaredNorm());
            // Sum |l - F l_ref|^2 = Sum |l|^2 - F : X, as X = F Y.
            const double rest = squares - F.cwiseProduct(X).sum();
            result.non_affine[i] = std::max(0.0, rest) / (neighbours * length * length);
        }
    });
    for (const std::int64_t of_block : degenerate) result.degenerate += of_block;
    return result;
}

}  // namespace tomodem::fields
