// Accuracy of the two measures of a pore: spheres cut out of random packings that stay as they are.
//
// usage: measure [BRICK_PARTICLES]
// Prints, for each density and diameter, the error of both volumes (mean and standard deviation over random places of
// the sphere), and the bias that would have made the mean right, in seed radii. Then the same of spheres that the end
// of the material cuts: the packing ends there, as a sample does at a face of its image.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>

#include "tools/packgen/compaction.hpp"
#include "tools/relax/pore_measure.hpp"

using namespace tomodem;
using namespace tomodem::relax;

namespace {

constexpr double seed_radius = 0.5, margin = 4.5, voxel = 0.25;

/// A sphere of this radius, cut by planes at these distances from its centre (positive: the centre is inside).
struct CutSphere {
    const char* name;
    std::array<std::optional<double>, 3> plane;  ///< over the radius
    double share;                                ///< of the sphere's volume that is left
};

/// Share of a sphere below a plane at h radii above its centre.
constexpr double below(double h) {
    return (2 + 3 * h - h * h * h) / 4;
}

const CutSphere cut_spheres[] = {
    {"half", {0.0, {}, {}}, below(0)},
    {"three quarters", {0.347, {}, {}}, below(0.347)},
    {"a quarter", {-0.347, {}, {}}, below(-0.347)},
    {"at an edge", {0.0, 0.0, {}}, 0.25},
    {"wall of one particle", {1.0, {}, {}}, 1},  // the plane is one particle further
};

void measure_cut(const Packing& brick, double density, const CutSphere& cut, double across, std::mt19937_64& random) {
    const double radius = std::cbrt(std::pow(across, 3) / cut.share) / 2, edge = brick.box.edges[0];
    const double truth = std::numbers::pi / 6 * std::pow(across, 3);
    const int places = across > 20 ? 4 : 12;
    double sum[2] = {}, square[2] = {};
    for (int place = 0; place < places; ++place) {
        const double half = radius + margin;
        std::uniform_real_distribution<double> uniform(0, edge);
        const Vec3 centre = Vec3(uniform(random), uniform(random), uniform(random)) + Vec3::Constant(half);
        Mirrors mirrors;
        Vec3 high = centre + Vec3::Constant(half);
        for (int c = 0; c < 3; ++c)
            if (cut.plane[c]) {
                mirrors.side[c] = 1;
                high[c] = mirrors.plane[c] = centre[c] + *cut.plane[c] * radius + (cut.share == 1 ? 1 : 0);
            }
        const Vec3 low = centre - Vec3::Constant(half);
        VoxelIndex size;
        for (int c = 0; c < 3; ++c) size[c] = static_cast<std::int32_t>(std::lround((high - low)[c] / voxel));
        const Vec3 origin = high - voxel * Vec3(size[0], size[1], size[2]);
        LabelVolume image(size, Vec3::Constant(voxel), origin);
        std::vector<std::int32_t> labels(std::size_t(size[0]) * size[1]);
        for (std::int32_t k = 0; k < size[2]; ++k) {
            for (std::int32_t j = 0; j < size[1]; ++j)
                for (std::int32_t i = 0; i < size[0]; ++i)
                    labels[std::size_t(j) * size[0] + i] =
                        (origin + voxel * Vec3(i + .5, j + .5, k + .5) - centre).norm() >= radius;
            image.set_slice(k, labels);
        }
        const ImagePores pores = find_pores(image, seed_radius, 1, 4, 1);
        std::vector<Vec3> centres;
        const int copies = static_cast<int>(std::ceil(2 * half / edge)) + 2;
        for (int a = 0; a < copies * copies * copies; ++a) {
            const int row = a / copies, layer = row / copies;
            for (const Vec3& point : brick.position) {
                const Vec3 there = point + edge * Vec3(a % copies, row % copies, layer);
                const double apart = (there - centre).norm();
                if (apart >= radius && apart < radius + 4 && (high - there).minCoeff() >= 0) centres.push_back(there);
            }
        }
        const auto belongs = [&](const Vec3& point) { return (point - centre).norm() < radius + 2; };
        const Matter matter{seed_radius, density};
        const DistanceField& distance = pores.pores[0].distance;
        const double error[2] = {measure_pore(centres, distance, belongs, matter, mirrors).volume / truth - 1,
                                 overlap_pore(centres, distance, belongs, matter, across, mirrors).volume / truth - 1};
        for (int m = 0; m < 2; ++m) sum[m] += error[m], square[m] += error[m] * error[m];
    }
    std::printf("D %.2f, %s of a sphere, %4.0f across:", density, cut.name, across);
    for (int m = 0; m < 2; ++m) {
        const double mean = sum[m] / places;
        std::printf("  %s %+6.2f +- %4.2f %%", m == 0 ? "alpha shape" : "grid", 100 * mean,
                    100 * std::sqrt(std::max(0.0, square[m] / places - mean * mean)));
    }
    std::printf("\n");
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 20000;
    std::mt19937_64 random(1);
    for (const double density : {0.64, 0.70, 0.74}) {
        const Packing brick =
            packgen::compact({.particles = count, .density = density, .seed_radius = seed_radius, .threads = 2})
                .packing;
        const Matter matter{seed_radius, density};
        const double edge = brick.box.edges[0];
        for (const double across : {4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 40.0}) {
            const int places = across > 20 ? 4 : across > 10 ? 10 : 40;
            double errors[2][2] = {}, envelope = 0, area = 0, volume = 0, grid_area = 0;
            for (int place = 0; place < places; ++place) {
                const double half = across / 2 + margin;
                const auto voxels = static_cast<std::int32_t>(std::ceil(2 * half / voxel));
                std::uniform_real_distribution<double> uniform(0, edge);
                const Vec3 shift(uniform(random), uniform(random), uniform(random));
                LabelVolume image({voxels, voxels, voxels}, Vec3::Constant(voxel), shift);
                const Vec3 centre = shift + Vec3::Constant(voxels * voxel / 2);
                std::vector<std::int32_t> labels(std::size_t(voxels) * voxels);
                for (std::int32_t k = 0; k < voxels; ++k) {
                    for (std::int32_t j = 0; j < voxels; ++j)
                        for (std::int32_t i = 0; i < voxels; ++i)
                            labels[std::size_t(j) * voxels + i] =
                                (shift + voxel * Vec3(i + .5, j + .5, k + .5) - centre).norm() >= across / 2;
                    image.set_slice(k, labels);
                }
                const ImagePores pores = find_pores(image, seed_radius, 1, 4, 1);
                std::vector<Vec3> centres;
                const int copies = static_cast<int>(std::ceil(2 * half / edge)) + 1;
                for (int a = 0; a < copies * copies * copies; ++a) {
                    const int row = a / copies, layer = row / copies;
                    for (const Vec3& point : brick.position) {
                        const Vec3 there = point + edge * Vec3(a % copies, row % copies, layer);
                        const double apart = (there - centre).norm();
                        if (apart >= across / 2 && apart < across / 2 + 4) centres.push_back(there);
                    }
                }
                const auto belongs = [&](const Vec3& point) { return (point - centre).norm() < across / 2 + 2; };
                const double truth = std::numbers::pi / 6 * std::pow(across, 3);
                const PoreMeasure shape = measure_pore(centres, pores.pores[0].distance, belongs, matter);
                const PoreOverlap grid = overlap_pore(centres, pores.pores[0].distance, belongs, matter, across);
                const double relative[2] = {shape.volume / truth - 1, grid.volume / truth - 1};
                for (int m = 0; m < 2; ++m) errors[m][0] += relative[m], errors[m][1] += relative[m] * relative[m];
                envelope += shape.envelope - truth;
                area += shape.area;
                volume += grid.volume - truth;
                grid_area += std::numbers::pi * across * across;
            }
            std::printf("D %.2f, %4.0f across (6 V/A %.2f):", density, across,
                        6 * (envelope + places * std::numbers::pi / 6 * std::pow(across, 3)) / area);
            const double implied[2] = {envelope / area / seed_radius,
                                       (volume / grid_area + grid_bias(matter, across)) / seed_radius};
            const char* const names[2] = {"alpha shape", "grid"};
            for (int m = 0; m < 2; ++m) {
                const double mean = errors[m][0] / places;
                std::printf("  %s %+6.2f +- %4.2f %% (bias %.3f r_s)", names[m], 100 * mean,
                            100 * std::sqrt(std::max(0.0, errors[m][1] / places - mean * mean)), implied[m]);
            }
            std::printf("\n");
            std::fflush(stdout);
        }
        for (const CutSphere& cut : cut_spheres)
            for (const double across : {6.0, 8.0, 12.0, 16.0, 24.0}) measure_cut(brick, density, cut, across, random);
    }
}
