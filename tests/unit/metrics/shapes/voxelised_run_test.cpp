#include "tools/metrics/shapes/voxelised_run.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <mutex>
#include <numbers>

#include "tests/unit/metrics/synthetic_run.hpp"
#include "tools/metrics/shapes/object_volumes.hpp"

namespace tomodem::shapes {
namespace {

/// A cube of edge 1 from `low`, outward oriented.
TriangleMesh unit_cube(const Vec3& low) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back(low + Vec3(i & 1, i >> 1 & 1, i >> 2));
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

std::int64_t voxels_inside(const TriangleMesh& mesh, const Grid& grid) {
    std::mutex mutex;
    std::int64_t voxels = 0;
    for_each_row_inside(mesh, grid, 2, [&](std::int32_t, std::int32_t, std::int32_t from, std::int32_t to) {
        const std::scoped_lock lock(mutex);
        voxels += to - from;
    });
    return voxels;
}

TEST(RowsInside, OfACubeAreItsVoxelsWhereverTheGridIs) {
    EXPECT_NEAR(unit_cube({0, 0, 0}).volume(), 1.0, 1e-12);
    for (const double shift : {0.0, 0.013, 0.25, 0.5})
        EXPECT_EQ(
            voxels_inside(unit_cube(Vec3::Constant(shift + 0.3)), {{20, 20, 20}, Vec3::Constant(0.125), Vec3::Zero()}),
            512)
            << shift;
}

TEST(RowsInside, AreCutByTheGrid) {
    EXPECT_EQ(voxels_inside(unit_cube({-0.5, 0.25, 0.25}), {{4, 8, 8}, Vec3::Constant(0.125), Vec3::Zero()}),
              4 * 6 * 6);
    EXPECT_EQ(voxels_inside(unit_cube({2, 2, 2}), {{4, 8, 8}, Vec3::Constant(0.125), Vec3::Zero()}), 0);
}

TEST(RowsInside, OfSurfacesThatCrossCountOnce) {
    TriangleMesh mesh = unit_cube({0.1, 0.1, 0.1});
    const TriangleMesh other = unit_cube({0.6, 0.1, 0.1});
    for (const Vec3& p : other.vertices) mesh.vertices.push_back(p);
    for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    EXPECT_EQ(voxels_inside(mesh, {{32, 16, 16}, Vec3::Constant(0.1), Vec3::Zero()}), 15 * 10 * 10);
}

TEST(RowsInside, OfAHoleAreNotThere) {
    TriangleMesh mesh = unit_cube({0, 0, 0});
    for (Vec3& p : mesh.vertices) p = 3.0 * p + Vec3::Constant(0.1);
    TriangleMesh hole = unit_cube({1.1, 1.1, 1.1});
    for (const Vec3& p : hole.vertices) mesh.vertices.push_back(p);
    for (const auto& t : hole.triangles) mesh.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    EXPECT_EQ(voxels_inside(mesh, {{40, 40, 40}, Vec3::Constant(0.1), Vec3::Zero()}), 27000 - 1000);
}

TEST(Voxelise, ABallOfParticlesHasTheVolumeOfTheRegionTheyWereTakenFrom) {
    const Packing packing = synthetic::sample(synthetic::ellipsoid({8, 8, 8}, 1.0, {9, 9, 9}));
    const AlphaSurface surface = surface_of_all(packing.position, packing.seed_radius);
    const VoxelisedRun run = voxelise(packing, surface, {{45, 45, 45}, Vec3::Constant(0.4), Vec3::Zero()}, 2);
    const double truth = 4.0 / 3.0 * std::numbers::pi * 512;
    EXPECT_NEAR(run.matter / truth, 1.0, 0.01);
    EXPECT_NEAR(double(run.species.histogram().at(1)) * 0.064 / run.matter, 1.0, 0.005);
}

TEST(Voxelise, AVoxelHasTheLabelsOfTheNearestParticle) {
    Packing packing = synthetic::sample(synthetic::cube(10, 1.0));
    packing.object.assign(packing.size(), 0);
    for (std::size_t i = 0; i < packing.size(); ++i)
        if (packing.position[i].x() > 5.5) {
            packing.species[i] = 2;
            packing.object[i] = 4;
        }
    const AlphaSurface surface = surface_of_all(packing.position, packing.seed_radius);
    const VoxelisedRun run = voxelise(packing, surface, {{22, 22, 22}, Vec3::Constant(0.5), Vec3::Constant(-0.5)}, 2);
    // The interface is half way between x = 5 and 6, and material ends half a spacing beyond the outermost centres.
    const LabelVolume::Sampler species(run.species), object(run.object);
    EXPECT_EQ(species.at({11, 11, 11}), 1);
    EXPECT_EQ(object.at({11, 11, 11}), 0);
    EXPECT_EQ(species.at({12, 11, 11}), 2);
    EXPECT_EQ(object.at({12, 11, 11}), 4);
    EXPECT_NEAR(double(run.species.histogram().at(1)) / (12 * 22 * 22), 1.0, 0.02);
}

TEST(Voxelise, IsTheSameOnAnyNumberOfThreads) {
    const Packing packing = synthetic::sample(synthetic::ellipsoid({5, 4, 6}, 0.9));
    const Grid grid{{20, 20, 80}, {0.6, 0.7, 0.2}, {-6, -6, -8}};
    const AlphaSurface surface = surface_of_all(packing.position, packing.seed_radius);
    const VoxelisedRun one = voxelise(packing, surface, grid, 1), four = voxelise(packing, surface, grid, 4);
    std::vector<std::int32_t> of_one, of_four;
    one.species.slices(0, 80, of_one);
    four.species.slices(0, 80, of_four);
    EXPECT_EQ(of_one, of_four);
}

}  // namespace
}  // namespace tomodem::shapes
