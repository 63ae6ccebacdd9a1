#include "tools/vol2pack/geometric_error.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

namespace tomodem::vol2pack {
namespace {

constexpr double pi = std::numbers::pi;

/// Label 2 where `inside` holds at the centre of a voxel [mm], else 1.
LabelVolume body(VoxelIndex size, const Vec3& spacing, const std::function<bool(const Vec3&)>& inside) {
    LabelVolume volume(size, spacing);
    std::vector<std::int32_t> voxels;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x)
                voxels.push_back(inside(Vec3(x + 0.5, y + 0.5, z + 0.5).cwiseProduct(spacing)) ? 2 : 1);
    volume.set_slices(0, size[2], voxels);
    return volume;
}

LabelVolume sphere(int size, double radius, const Vec3& spacing = Vec3::Ones()) {
    const Vec3 centre(0.5 * size + 0.13, 0.5 * size - 0.29, 0.5 * size + 0.37);
    return body({int(size / spacing[0]), int(size / spacing[1]), int(size / spacing[2])}, spacing,
                [=](const Vec3& point) { return (point - centre).norm() < radius; });
}

/// Random points of the density of a dense packing, no two very close: a stand-in for one.
Packing loose_brick(int edge, unsigned seed) {
    Packing brick;
    brick.seed_radius = 0.5;
    const double spacing = 0.908;  // D = 0.70
    brick.box.edges = Vec3::Constant(spacing * edge);
    brick.box.periodic = {true, true, true};
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> jitter(-0.35, 0.35);
    for (int z = 0; z < edge; ++z)
        for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x)
                brick.position.push_back(spacing * Vec3(x + jitter(random), y + jitter(random), z + jitter(random)));
    brick.species.assign(brick.size(), 1);
    for (std::size_t i = 0; i < brick.size(); ++i) brick.id.push_back(static_cast<std::int64_t>(i + 1));
    return brick;
}

Tiling tiling_of(const LabelVolume& volume, double seed_radius, std::uint64_t seed) {
    return Tiling(loose_brick(14, 5), seed_radius, {volume.origin(), volume.extent(), {}}, seed);
}

TEST(ImageSurface, OfASphereIsFourPiRSquared) {
    for (const double radius : {6.0, 12.0, 25.0}) {
        const auto geometry = measure_image(sphere(64, radius), 100, 2);
        EXPECT_NEAR(geometry.label.at(2).surface / (4 * pi * radius * radius), 1, 0.015) << radius;
        EXPECT_NEAR(geometry.label.at(1).surface / geometry.label.at(2).surface, 1, 1e-9);
    }
}

TEST(ImageSurface, OfASphereInVoxelsThatAreNotCubesIsTheSame) {
    for (const Vec3& spacing : {Vec3(1, 1, 2), Vec3(0.5, 1, 4), Vec3(0.5, 0.5, 10)}) {
        const auto geometry = measure_image(sphere(80, 30, spacing), 100, 2);
        EXPECT_NEAR(geometry.label.at(2).surface / (4 * pi * 30 * 30), 1, 0.05) << spacing.transpose();
    }
}

TEST(ImageSurface, OfAPlaneDoesNotDependOnItsDirectionBeyondThreePercent) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 8; ++trial) {
        const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
        // The part of a plane within a sphere: the plane's disk and a known rest, the sphere's half.
        const auto half = body({64, 64, 64}, Vec3::Ones(), [&](const Vec3& point) {
            const Vec3 from_centre = point - Vec3::Constant(32);
            return from_centre.norm() < 25 && from_centre.dot(direction) > 0;
        });
        const double expected = 3 * pi * 25 * 25;
        EXPECT_NEAR(measure_image(half, 100, 2).label.at(2).surface / expected, 1, 0.03) << direction.transpose();
    }
}

TEST(ImageSurface, LeavesOutTheFacesOfTheVolume) {
    const auto half = body({30, 20, 10}, Vec3::Ones(), [](const Vec3& point) { return point[2] < 5; });
    EXPECT_NEAR(measure_image(half, 100, 1).label.at(2).surface / 600, 1, 0.03);
    const auto solid = body({30, 20, 10}, Vec3::Ones(), [](const Vec3&) { return true; });
    EXPECT_EQ(measure_image(solid, 100, 1).label.at(2).surface, 0);
}

TEST(Thickness, OfAPlateIsItsOwnWhicheverWayItLies) {
    for (const double thickness : {1.0, 2.0, 5.0, 8.0})
        for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(1, 1, 0)}) {
            if (thickness < 2 && direction[2] < 1) continue;  // an oblique plate of one voxel has holes
            const Vec3 normal = direction.normalized();
            const auto plate = body({60, 60, 60}, Vec3::Ones(), [&](const Vec3& point) {
                return std::abs((point - Vec3::Constant(30.05)).dot(normal)) < thickness / 2;
            });
            const auto& label = measure_image(plate, 100, 2).label.at(2);
            EXPECT_NEAR(label.thinnest(), thickness, 1) << normal.transpose();
            EXPECT_NEAR(label.thickness[label.thickness.size() / 2], thickness, 0.5) << normal.transpose();
        }
}

TEST(Thickness, OfARodAndOfASphereIsTheDiameter) {
    const Vec3 along = Vec3(1, 2, 4).normalized();
    const auto rod = body({70, 70, 70}, Vec3::Ones(),
                          [&](const Vec3& point) { return (point - Vec3::Constant(35)).cross(along).norm() < 5; });
    EXPECT_NEAR(measure_image(rod, 100, 2).label.at(2).thinnest(), 10, 1.2);
    EXPECT_NEAR(measure_image(sphere(64, 10), 100, 2).label.at(2).thinnest(), 20, 1.5);
    EXPECT_NEAR(measure_image(sphere(64, 20), 100, 2).label.at(2).thinnest(), 40, 2);
    // Its matrix continues beyond the volume: what is left of it between sphere and face is no feature.
    EXPECT_EQ(measure_image(sphere(64, 20), 100, 2).label.at(1).thinnest(), 100);
}

TEST(Thickness, IsThatOfTheThinPartWhereATwentiethOfTheBoundaryIsThin) {
    // Two blocks and a bar between them.
    const auto dumbbell = body({80, 40, 40}, Vec3::Ones(), [](const Vec3& point) {
        const bool block = std::abs(point[1] - 20) < 8 && std::abs(point[2] - 20) < 8 &&
                           (std::abs(point[0] - 18) < 8 || std::abs(point[0] - 62) < 8);
        return block || (std::abs(point[1] - 20) < 3 && std::abs(point[2] - 20) < 3 && std::abs(point[0] - 40) < 15);
    });
    EXPECT_NEAR(measure_image(dumbbell, 100, 2).label.at(2).thinnest(), 6, 1);
}

TEST(Thickness, InFlatVoxelsIsInMillimetres) {
    const auto plate =
        body({60, 60, 30}, Vec3(0.5, 0.5, 2), [](const Vec3& point) { return std::abs(point[0] - 15) < 3; });
    EXPECT_NEAR(measure_image(plate, 100, 2).label.at(2).thinnest(), 6, 0.3);
}

TEST(ImageGeometry, IsTheSameOnAnyNumberOfThreads) {
    const auto volume = sphere(40, 12);
    const auto one = measure_image(volume, 50, 1), three = measure_image(volume, 50, 3);
    for (const std::int32_t label : {1, 2}) {
        EXPECT_EQ(one.label.at(label).surface, three.label.at(label).surface);
        EXPECT_EQ(one.label.at(label).thickness, three.label.at(label).thickness);
    }
}

/// Labels of all places by a function of the position, instead of an image.
Places places_of(const Tiling& tiling, const std::function<std::int32_t(const Vec3&)>& label) {
    Places places;
    for (std::int64_t place = 0; place < tiling.places(); ++place) {
        const Vec3 at = tiling.from_corner(place);
        places.label.push_back(tiling.in_box(at)      ? label(at)
                               : tiling.in_margin(at) ? -1 - label(tiling.mirrored(at))
                                                      : Places::outside);
    }
    return places;
}

TEST(ParticleSurface, OfASphereIsFourPiRSquaredLessWhatTheNeedlesMiss) {
    // Five, ten and twenty particles across; eight placements each.
    for (const double seed_radius : {4.0, 2.0, 1.0}) {
        double sum = 0, needle = 0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const Tiling tiling(loose_brick(14, 5), seed_radius, {Vec3::Zero(), Vec3::Constant(64), {}}, seed);
            const Places places =
                places_of(tiling, [](const Vec3& at) { return (at - Vec3(32, 31, 33)).norm() < 20 ? 2 : 1; });
            const auto needles = tiling.needles();
            sum += particle_surfaces(tiling, places, needles, 2).at(2) / 8;
            double lengths = 0, cubes = 0;
            for (const auto& each : needles) {
                lengths += each.along.norm();
                cubes += std::pow(each.along.norm(), 3);
            }
            needle = cubes / lengths;  // mean square of the needles that cross
        }
        EXPECT_NEAR(sum / (4 * pi * 400 * (1 - needle / (12 * 400))), 1, 0.02) << seed_radius;
    }
}

TEST(ParticleSurface, OfAHalfIsTheSectionInAnyBox) {
    const auto half = body({60, 40, 24}, Vec3::Ones(), [](const Vec3& point) { return point[0] < 30; });
    const Tiling tiling = tiling_of(half, 1, 3);
    const Places places = label_places(half, tiling, nullptr, {}, 2);
    EXPECT_NEAR(particle_surfaces(tiling, places, tiling.needles(), 2).at(1) / 960, 1, 0.06);
}

TEST(Needles, AreThePairsThatASearchOverAllPairsFinds) {
    for (const int edge : {1, 2, 7}) {
        const Packing brick = loose_brick(edge, 1);
        const Tiling tiling(brick, 0.5, {Vec3::Zero(), Vec3::Constant(3), {}}, 4);
        const double length = brick.box.edges[0], cutoff = 1.4 * 0.908;
        std::int64_t expected = 0;
        for (std::size_t i = 0; i < brick.size(); ++i)
            for (std::size_t j = 0; j < brick.size(); ++j)
                for (int x = -2; x <= 2; ++x)
                    for (int y = -2; y <= 2; ++y)
                        for (int z = -2; z <= 2; ++z) {
                            const double r = (brick.position[j] + length * Vec3(x, y, z) - brick.position[i]).norm();
                            expected += r > 0 && r <= cutoff;
                        }
        EXPECT_EQ(2 * static_cast<std::int64_t>(tiling.needles().size()), expected) << edge;
    }
}

TEST(Components, ThatHoldNoParticleAreLostAndThoseThatTouchAreMerged) {
    // Blocks of label 2: two a voxel apart, one far from them, and a speck.
    const auto volume = body({60, 30, 30}, Vec3::Ones(), [](const Vec3& point) {
        const bool tall = std::abs(point[1] - 15) < 8 && std::abs(point[2] - 15) < 8;
        const bool one = point[0] > 4 && point[0]<16, two = point[0]> 17 && point[0] < 28;
        const bool far = point[0] > 40 && point[0] < 52;
        const bool speck = (point - Vec3(58.5, 2.5, 2.5)).norm() < 0.1;
        return (tall && (one || two || far)) || speck;
    });
    const Regions regions = component_regions(volume, {1, 2}, {}, Connectivity::faces);
    const Tiling tiling = tiling_of(volume, 2, 0);
    const Places places = label_places(volume, tiling, &regions, {}, 2);
    const auto losses = component_losses(tiling, places, tiling.needles(), regions);
    EXPECT_EQ(losses.at(2).components, 4);
    EXPECT_EQ(losses.at(2).lost, 1);
    EXPECT_EQ(losses.at(2).largest_lost, 1);
    EXPECT_EQ(losses.at(2).merged, 1);
    EXPECT_EQ(losses.at(1).components, 1);
    EXPECT_EQ(losses.at(1).lost + losses.at(1).merged, 0);
}

TEST(GeometricError, OfAPhaseWithoutParticlesIsAllOfIt) {
    const auto volume =
        body({20, 20, 20}, Vec3::Ones(), [](const Vec3& point) { return (point - Vec3(0.5, 0.5, 0.5)).norm() < 0.1; });
    const Tiling tiling = tiling_of(volume, 4, 0);
    const Places places = label_places(volume, tiling, nullptr, {}, 1);
    const GeometricError error = geometric_error(volume, tiling, places, nullptr, 1);
    EXPECT_DOUBLE_EQ(error.volume_error(), 1);
    EXPECT_DOUBLE_EQ(largest_volume_error(volume.histogram(), places.count()), 1);
    const auto table = error.json();
    EXPECT_EQ(table.at(1).at("label"), 2);
    EXPECT_DOUBLE_EQ(table.at(1).at("image_fraction"), 1.0 / 8000);
    EXPECT_FALSE(table.at(1).contains("components_lost"));
}

}  // namespace
}  // namespace tomodem::vol2pack
