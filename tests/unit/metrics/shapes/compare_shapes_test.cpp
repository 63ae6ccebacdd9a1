#include "tools/metrics/shapes/compare_shapes.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"
#include "tools/metrics/shapes/voxelised_run.hpp"

namespace tomodem::shapes {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

struct Ball {
    Vec3 centre;
    double radius;
};
const std::vector<Ball> balls{{{6, 6, 6}, 3.5}, {{14, 7, 13}, 4}, {{6, 14, 14}, 3}};
constexpr double edge = 20.0, spacing = edge / 33;

/// Overlap of a ball of particles with the ball itself: the interface half way between particles is some 0.3 of them
/// away from the ball's, here and there.
double least_dice(double radius) {
    return 1.0 - 1.5 * 0.3 * spacing / radius;
}

std::int32_t ball_at(const Vec3& place) {
    for (std::size_t i = 0; i < balls.size(); ++i)
        if ((place - balls[i].centre).norm() < balls[i].radius) return std::int32_t(i + 1);
    return 0;
}

/// A cube of matrix (1) with balls (2), objects in the order of their first voxels.
Packing packing() {
    std::vector<Vec3> centres = synthetic::cube(32, spacing, Vec3::Constant(0.5 * spacing));
    std::mt19937 random(1);
    for (Vec3& p : centres)
        for (int c = 0; c < 3; ++c) p[c] += 0.2 * spacing * (double(random()) / 4294967296.0 - 0.5);
    Packing sample = synthetic::sample(std::move(centres), 0.5 * spacing);
    sample.box = {Vec3::Zero(), Vec3::Constant(edge), {false, false, false}};
    sample.object.resize(sample.size());
    for (std::size_t i = 0; i < sample.size(); ++i) {
        sample.object[i] = ball_at(sample.position[i]);
        sample.species[i] = sample.object[i] > 0 ? 2 : 1;
    }
    return sample;
}

/// The same as an image, its voxels moved by `shift` and stretched.
LabelVolume image(const Vec3& stretch = Vec3::Ones(), const Vec3& shift = Vec3::Zero(), std::int32_t balls_drawn = 3) {
    constexpr int n = 60;
    LabelVolume volume({n, n, n}, stretch * edge / n, shift);
    for (int k = 0; k < n; ++k) {
        std::vector<std::int32_t> slice;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const std::int32_t ball = ball_at(edge / n * Vec3(i + 0.5, j + 0.5, k + 0.5));
                slice.push_back(ball > 0 && ball <= balls_drawn ? 2 : 1);
            }
        volume.set_slice(k, slice);
    }
    return volume;
}

struct Compared {
    LabelVolume volume;
    ImageObjects objects;
    std::vector<RunBody> bodies;
    Comparison comparison;
};

Compared compared(const Packing& sample, LabelVolume volume) {
    ImageObjects objects = image_objects(volume, {.components = {2}}, {});
    const AlphaSurface surface = surface_of_all(sample.position, sample.seed_radius);
    std::vector<RunBody> bodies = measure_objects(sample, surface, choose_objects(sample, {}).used, 2);
    Compared result{std::move(volume), std::move(objects), std::move(bodies), {}};
    const LabelVolume& voxels = result.volume;
    const VoxelisedRun run = voxelise(sample, surface, {voxels.size(), voxels.spacing(), voxels.origin()}, 2);
    result.comparison =
        compare(run.species, {run.object, {}, result.bodies}, voxels,
                {result.objects.region, result.objects.number_of_region, result.objects.used}, Connectivity::faces);
    return result;
}

TEST(Compare, ASampleWithItsOwnImage) {
    const Compared same = compared(packing(), image());
    ASSERT_EQ(same.comparison.matches.size(), 3u);
    for (const Match& match : same.comparison.matches) {
        EXPECT_EQ(match.by, MatchedBy::overlap);
        EXPECT_NEAR((match.run->shape.centre - match.image->shape.centre).norm(), 0.0, 0.06);
        EXPECT_NEAR(match.run->shape.shape_factor, match.image->shape.shape_factor, 0.02);
        EXPECT_NEAR(match.run->shape.volume / match.image->shape.volume, 1.0, 0.05);  // 500 particles
        EXPECT_GT(match.dice, least_dice(balls[match.run->number - 1].radius));
        EXPECT_NEAR(match.iou, match.dice / (2.0 - match.dice), 1e-12);
    }
    EXPECT_GT(same.comparison.phase.at(1).dice(), 0.97);
    EXPECT_GT(same.comparison.phase.at(2).dice(), least_dice(3));
    EXPECT_EQ(same.comparison.image_porosity, 0.0);
}

TEST(Compare, AnImageStretchedByAKnownFactor) {
    const Compared same = compared(packing(), image());
    const Vec3 stretch(1.1, 1.1, 0.8);
    const Compared stretched = compared(packing(), image(stretch));
    ASSERT_EQ(stretched.comparison.matches.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const Shape& before = same.comparison.matches[i].image->shape;
        const Shape& after = stretched.comparison.matches[i].image->shape;
        EXPECT_NEAR(after.shape_factor / before.shape_factor, 0.8 / 1.1, 1e-9);
        EXPECT_NEAR(after.volume / before.volume, 1.1 * 1.1 * 0.8, 1e-9);
        EXPECT_NEAR((after.centre - before.centre.cwiseProduct(stretch)).norm(), 0.0, 1e-9);
        EXPECT_EQ(stretched.comparison.matches[i].by, MatchedBy::overlap);
    }
}

TEST(Compare, ARunStretchedAsTheImageIsStillTheSame) {
    const Vec3 stretch(1.1, 1.1, 0.8);
    Packing sample = packing();
    for (Vec3& p : sample.position) p = p.cwiseProduct(stretch);
    for (const Match& match : compared(sample, image(stretch)).comparison.matches) {
        EXPECT_NEAR(match.run->shape.shape_factor, match.image->shape.shape_factor, 0.015);
        EXPECT_GT(match.dice, least_dice(balls[match.run->number - 1].radius));
    }
}

TEST(Compare, WhatNoLongerOverlapsIsMatchedByItsCentre) {
    // The first ball lies further away than its diameter, in what was matrix.
    Packing sample = packing();
    const Vec3 way(0, 7.5, 0);
    for (std::size_t i = 0; i < sample.size(); ++i) {
        if (sample.object[i] == 1) sample.object[i] = 0;
        if (sample.object[i] == 0) sample.species[i] = 1;
    }
    for (std::size_t i = 0; i < sample.size(); ++i)
        if ((sample.position[i] - balls[0].centre - way).norm() < balls[0].radius && sample.object[i] == 0) {
            sample.object[i] = 1;
            sample.species[i] = 2;
        }
    const Compared moved = compared(sample, image());
    const Match& first = moved.comparison.matches.front();
    ASSERT_EQ(first.by, MatchedBy::centre);
    EXPECT_EQ(first.run->number, 1);
    EXPECT_EQ(first.image->number, 1);
    EXPECT_NEAR((first.run->shape.centre - first.image->shape.centre - way).norm(), 0.0, 0.15);
    EXPECT_EQ(first.dice, 0.0);
    EXPECT_EQ(moved.comparison.matches[1].by, MatchedBy::overlap);
}

TEST(Compare, AnObjectWithoutAnotherIsListed) {
    const Compared two = compared(packing(), image(Vec3::Ones(), Vec3::Zero(), 2));
    ASSERT_EQ(two.comparison.matches.size(), 3u);
    EXPECT_EQ(two.comparison.matches[2].by, MatchedBy::run_only);
    EXPECT_EQ(two.comparison.matches[2].run->number, 3);
    const PhaseOverlap& balls_of = two.comparison.phase.at(2);
    const double voxel = std::pow(edge / 60, 3), missing = 4.0 / 3.0 * std::numbers::pi * 27;
    EXPECT_NEAR(voxel * double(balls_of.run - balls_of.image) / missing, 1.0, 0.1);
    EXPECT_EQ(two.comparison.equal, two.comparison.phase.at(1).both + balls_of.both);
    Packing sample = packing();
    for (std::size_t i = 0; i < sample.size(); ++i)
        if (sample.object[i] == 3) {
            sample.object[i] = 0;
            sample.species[i] = 1;
        }
    const Compared other = compared(sample, image());
    ASSERT_EQ(other.comparison.matches.size(), 3u);
    EXPECT_EQ(other.comparison.matches[2].by, MatchedBy::image_only);
    EXPECT_EQ(other.comparison.matches[2].image->number, 3);
}

TEST(Compare, PoresOfBothAreMeasuredOnTheSameVoxels) {
    // The balls are void.
    Packing sample = packing(), solid;
    solid.box = sample.box;
    solid.seed_radius = sample.seed_radius;
    for (std::size_t i = 0; i < sample.size(); ++i)
        if (sample.object[i] != 1) {
            solid.position.push_back(sample.position[i]);
            solid.species.push_back(sample.species[i]);
            solid.object.push_back(sample.object[i]);
            solid.id.push_back(std::int64_t(solid.position.size()));
        }
    LabelVolume volume = image();
    std::vector<std::int32_t> slice;
    for (int k = 0; k < 60; ++k) {
        volume.slice(k, slice);
        for (int j = 0; j < 60; ++j)
            for (int i = 0; i < 60; ++i)
                if (ball_at(edge / 60 * Vec3(i + 0.5, j + 0.5, k + 0.5)) == 1) slice[60 * j + i] = 0;
        volume.set_slice(k, slice);
    }
    const Compared porous = compared(solid, std::move(volume));
    EXPECT_NEAR(porous.comparison.image_porosity, 179.6 / 8000, 1e-3);
    EXPECT_NEAR(porous.comparison.run_porosity / porous.comparison.image_porosity, 1.0, 0.05);
    EXPECT_GT(porous.comparison.phase.at(0).dice(), least_dice(3.5));

    // The pore itself, side by side.
    const AlphaSurface surface = surface_of_all(solid.position, solid.seed_radius);
    const LabelVolume& voxels = porous.volume;
    const VoxelisedRun run = voxelise(solid, surface, {voxels.size(), voxels.spacing(), voxels.origin()}, 2);
    const VoidParts of_run = void_parts(run.species, Connectivity::faces, {});
    const VoidParts of_image = void_parts(voxels, Connectivity::faces, {});
    const std::vector<RunBody> pores = bodies_of_pores(of_run);
    const Comparison both = compare(run.species, {of_run.region, of_run.number_of_region, pores}, voxels,
                                    {of_image.region, of_image.number_of_region, of_image.closed}, Connectivity::faces);
    ASSERT_EQ(both.matches.size(), 1u);
    EXPECT_EQ(both.matches[0].by, MatchedBy::overlap);
    EXPECT_GT(both.matches[0].dice, least_dice(3.5));
    EXPECT_NEAR(both.matches[0].run->shape.volume / both.matches[0].image->shape.volume, 1.0, 0.05);
    EXPECT_NEAR(both.matches[0].run->shape.shape_factor, 1.0, 0.03);
}

TEST(CentreOfMatter, LeavesOutVoid) {
    LabelVolume volume({10, 4, 4}, Vec3::Constant(0.5), Vec3(1, 2, 3));
    std::vector<std::int32_t> slice(40, 0);
    slice[8] = slice[9] = 5;
    volume.set_slice(2, slice);
    EXPECT_NEAR((centre_of_matter(volume) - Vec3(1 + 4.5, 2.25, 4.25)).norm(), 0.0, 1e-12);
    EXPECT_THAT(
        [] {
            centre_of_matter(LabelVolume({2, 2, 2}, Vec3::Ones()));
        },
        ThrowsMessage<InvalidInput>(HasSubstr("all of the image is void")));
}

TEST(RequireSamePlace, RejectsAnotherSizeOrPlace) {
    require_same_place(image(), packing());
    EXPECT_THAT([] { require_same_place(image(Vec3::Constant(2)), packing()); },
                ThrowsMessage<InvalidInput>(HasSubstr("check --voxel-size")));
    EXPECT_THAT(
        [] {
            require_same_place(image(Vec3::Ones(), {12, 0, 0}), packing());
        },
        ThrowsMessage<InvalidInput>(HasSubstr("--align centre")));
}

}  // namespace
}  // namespace tomodem::shapes
