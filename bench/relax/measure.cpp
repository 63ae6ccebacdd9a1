// Accuracy of the two measures of a pore: spheres cut out of random packings that stay as they are.
//
// usage: measure [BRICK_PARTICLES]
// Prints, for each density and diameter, the error of both volumes (mean and standard deviation over random places of
// the sphere), and the bias that would have made the mean right, in seed radii.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>

#include "tools/packgen/compaction.hpp"
#include "tools/relax/pore_measure.hpp"

using namespace tomodem;
using namespace tomodem::relax;

int main(int argc, char** argv) {
    const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 20000;
    constexpr double seed_radius = 0.5, margin = 4.5, voxel = 0.25;
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
    }
}
