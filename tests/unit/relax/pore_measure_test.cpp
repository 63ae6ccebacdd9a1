#include "tools/relax/pore_measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/relax/images.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem::relax {
namespace {

constexpr double seed_radius = 0.5;

/// A random packing that fills space, and spheres of void in it: where the material ends is known.
struct Hole {
    Packing brick = packgen::compact({.particles = 4000, .density = 0.66, .seed_radius = seed_radius}).packing;
    Matter matter{seed_radius, 0.66};

    std::vector<Vec3> around(const Vec3& centre, double radius, double shell) const {
        const double edge = brick.box.edges[0];
        std::vector<Vec3> centres;
        for (int a = 0; a < 27; ++a) {
            const int row = a / 3, layer = row / 3;
            for (const Vec3& point : brick.position) {
                const Vec3 there = point + edge * Vec3(a % 3, row % 3, layer);
                const double apart = (there - centre).norm();
                if (apart >= radius && apart < radius + shell) centres.push_back(there);
            }
        }
        return centres;
    }
};

TEST(PoreMeasure, OfASphereCutOutIsRightWithinTwoPercentFromTwelveParticlesOn) {
    const Hole hole;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> shift(20, 21);
    for (const double across : {12.0, 16.0}) {
        for (int k = 0; k < 3; ++k) {
            const Vec3 centre(shift(random), shift(random), shift(random));
            const double radius = across / 2, half = radius + 5;
            const auto voxels = static_cast<std::int32_t>(2 * half / 0.25);
            const LabelVolume image =
                image_of({voxels, voxels, voxels}, Vec3::Constant(0.25), centre - Vec3::Constant(half),
                         [&](const Vec3& p) { return (p - centre).norm() < radius; });
            const ImagePores pores = find_pores(image, seed_radius, 4, 4, 1);
            const auto centres = hole.around(centre, radius, 4);
            const auto belongs = [&](const Vec3& p) { return (p - centre).norm() < radius + 2; };
            const double truth = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
            const PoreMeasure shape = measure_pore(centres, pores.pores[0].distance, belongs, hole.matter);
            EXPECT_NEAR(shape.volume / truth, 1, 0.02);
            EXPECT_FALSE(shape.leaks);
            EXPECT_NEAR(shape.distance, 0, 0.1 * seed_radius);
            const PoreOverlap grid = overlap_pore(centres, pores.pores[0].distance, belongs, hole.matter, across);
            EXPECT_NEAR(grid.volume / truth, 1, 0.025);
            EXPECT_NEAR(grid.image / truth, 1, 0.02);
            EXPECT_GT(grid.intersection / grid.united, 0.9);
        }
    }
}

TEST(PoreMeasure, OfASphereShiftedByHalfItsRadiusIntersectsAsTheGeometrySays) {
    const Hole hole;
    const Vec3 centre(20, 20, 20), shifted = centre + Vec3(3, 0, 0);
    const double radius = 6, half = 14;
    const LabelVolume image = image_of({112, 112, 112}, Vec3::Constant(0.25), centre - Vec3::Constant(half),
                                       [&](const Vec3& p) { return (p - centre).norm() < radius; });
    const ImagePores pores = find_pores(image, seed_radius, 4, 4.5, 1);
    const auto near = [&](const Vec3& p) { return (p - centre).norm() < 10; };
    const PoreOverlap grid =
        overlap_pore(hole.around(shifted, radius, 8), pores.pores[0].distance, near, hole.matter, 12);
    // Lens of two spheres of radius r at distance s: pi (4 r + s) (2 r - s)^2 / 12.
    const double lens = std::numbers::pi * (24 + 3) * 81 / 12, ball = 4.0 / 3 * std::numbers::pi * 216;
    EXPECT_NEAR(grid.intersection / grid.united, lens / (2 * ball - lens), 0.02);
}

TEST(PoreMeasure, IsNothingInADensePacking) {
    const Hole hole;
    const Vec3 centre(20, 20, 20);
    const LabelVolume image = image_of({80, 80, 80}, Vec3::Constant(0.25), centre - Vec3::Constant(10),
                                       [&](const Vec3& p) { return (p - centre).norm() < 4; });
    const ImagePores pores = find_pores(image, seed_radius, 4, 4, 1);
    const auto centres = hole.around(centre, 0, 8);
    const auto everywhere = [](const Vec3&) { return true; };
    EXPECT_EQ(measure_pore(centres, pores.pores[0].distance, everywhere, hole.matter).volume, 0);
    EXPECT_EQ(
        overlap_pore(
            centres, pores.pores[0].distance, [&](const Vec3& p) { return (p - centre).norm() < 6; }, hole.matter, 8)
            .volume,
        0);
}

TEST(PoreMeasure, LeavesOutTheVoidBehindAWall) {
    const Hole hole;
    const Vec3 centre(20, 20, 20);
    const LabelVolume image = image_of({80, 80, 80}, Vec3::Constant(0.25), centre - Vec3(10, 10, 10),
                                       [&](const Vec3& p) { return (p - centre).norm() < 5; });
    const ImagePores pores = find_pores(image, seed_radius, 4, 4, 1);
    std::vector<Vec3> centres;  // the sample ends three particles behind the pore
    for (const Vec3& point : hole.around(centre, 5, 9))
        if (point.x() < centre.x() + 8) centres.push_back(point);
    const auto belongs = [&](const Vec3& p) { return (p - centre).norm() < 9; };
    const double truth = 4.0 / 3 * std::numbers::pi * 125;
    const PoreMeasure shape = measure_pore(centres, pores.pores[0].distance, belongs, hole.matter);
    EXPECT_NEAR(shape.volume / truth, 1, 0.03);
    EXPECT_FALSE(shape.leaks);
    const PoreOverlap grid = overlap_pore(centres, pores.pores[0].distance, belongs, hole.matter, 10);
    EXPECT_NEAR(grid.volume / truth, 1, 0.03);
}

TEST(PoreMeasure, SaysThatAPoreLeaksIntoItsNeighbour) {
    const Hole hole;
    const Vec3 centre(20, 20, 20);
    const LabelVolume image = image_of({120, 80, 80}, Vec3::Constant(0.25), centre - Vec3(10, 10, 10),
                                       [&](const Vec3& p) { return (p - centre).norm() < 5; });
    const ImagePores pores = find_pores(image, seed_radius, 4, 4, 1);
    std::vector<Vec3> centres;
    for (const Vec3& point : hole.around(centre, 5, 9))
        if ((point - centre - Vec3(7, 0, 0)).norm() > 3) centres.push_back(point);
    const auto belongs = [&](const Vec3& p) { return (p - centre).norm() < 7; };
    const PoreMeasure shape = measure_pore(centres, pores.pores[0].distance, belongs, hole.matter);
    EXPECT_TRUE(shape.leaks);
}

}  // namespace
}  // namespace tomodem::relax
