#include "core/surface/pore_search.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A block of 18 x 18 x 18 centres, a diameter of 1 apart and out of place by up to a tenth, less those of a pore. Its
/// faces are at 0 and 17 of each axis.
std::vector<Vec3> block(const std::function<bool(const Vec3&)>& pore = {}) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> shift(-0.1, 0.1);
    std::vector<Vec3> centres;
    for (int k = 0; k < 18; ++k)
        for (int j = 0; j < 18; ++j)
            for (int i = 0; i < 18; ++i) {
                const Vec3 place(i, j, k);
                const Vec3 centre = place + Vec3(shift(generator), shift(generator), shift(generator));
                if (!pore || !pore(place)) centres.push_back(centre);
            }
    return centres;
}

/// 6 x 6 centres out of the upper face, to a depth of 8.
bool in_hole(const Vec3& p) {
    return p.x() > 5.5 && p.x() < 11.5 && p.y() > 5.5 && p.y() < 11.5 && p.z() > 9.5;
}

PoreSearch search(double lid_radius) {
    return {.probe_radius = 1.0, .seed_radius = 0.5, .lid_radius = lid_radius};
}

TEST(FindPores, FindsNoneInARoughBlock) {
    EXPECT_TRUE(find_pores(block(), search(8.0)).pores.empty());
    EXPECT_TRUE(find_pores(block(), search(0.0)).pores.empty());
}

TEST(FindPores, OfAHoleInAFaceIsOnePoreUnderALidAndNoneWithout) {
    const auto centres = block(in_hole);
    EXPECT_TRUE(find_pores(centres, search(0.0)).pores.empty());
    const Pores pores = find_pores(centres, search(30.0));
    ASSERT_EQ(pores.pores.size(), 1u);
    const Pore& pore = pores.pores.front();
    // Between the centres the hole is 7 x 7 x 8; along its edges the probe leaves half a square of 1 x 1.
    EXPECT_NEAR(pore.body.volume, 7.0 * 7.0 * 8.0 - 0.5 * (4 * 8 + 4 * 7), 0.03 * 7.0 * 7.0 * 8.0);
    EXPECT_LT(pore.mouth, 7.0 * 7.0);  // between the centres of the rim
    EXPECT_GT(pore.mouth, 6.0 * 6.0);  // between the particles
    EXPECT_NEAR(pore.body.centre.x(), 8.5, 0.1);
    EXPECT_NEAR(pore.body.centre.z(), 13.0, 0.3);
}

TEST(FindPores, HasTheSurfaceOfEveryPoreOrientedOutOfIt) {
    const Pores pores = find_pores(block(in_hole), search(30.0));
    EXPECT_NEAR(pores.surface.mesh.volume(), pores.volume(), 1e-9 * pores.volume());
    EXPECT_EQ(pores.surface.number.size(), pores.surface.mesh.triangles.size());
}

TEST(FindPores, OfAClosedPoreDoesNotDependOnLids) {
    const auto centres = block([](const Vec3& p) { return (p - Vec3(8.5, 8.5, 8.5)).norm() < 4.0; });
    const Pores without = find_pores(centres, search(0.0)), with = find_pores(centres, search(30.0));
    ASSERT_EQ(without.pores.size(), 1u);
    ASSERT_EQ(with.pores.size(), 1u);
    EXPECT_DOUBLE_EQ(with.volume(), without.volume());
    EXPECT_EQ(with.mouth(), 0.0);
    EXPECT_EQ(with.pores.front().body.particles, without.pores.front().body.particles);
}

TEST(FindPores, CountsPoresApartAndLeavesSmallOnesOut) {
    const auto centres = block([](const Vec3& p) { return in_hole(p) || (p - Vec3(8.5, 8.5, 3.5)).norm() < 2.0; });
    Pores pores = find_pores(centres, search(30.0));
    ASSERT_EQ(pores.pores.size(), 2u);
    EXPECT_GT(pores.pores[0].mouth, 0.0);
    EXPECT_EQ(pores.pores[1].mouth, 0.0);
    const double largest = pores.pores[0].body.volume;
    pores.leave_out_below(0.5 * largest);
    ASSERT_EQ(pores.pores.size(), 1u);
    EXPECT_NEAR(pores.surface.mesh.volume(), largest, 1e-9 * largest);
}

TEST(FindPores, WantsALidWiderThanTheProbe) {
    EXPECT_THAT([] { find_pores(block(), search(1.5)); }, ThrowsMessage<InvalidInput>(HasSubstr("a lid of 1.5 mm")));
}

TEST(LastingNumbers, FollowAPoreByTheCentresAroundIt) {
    const auto pores = [](std::vector<std::vector<std::int32_t>> around) {
        Pores result;
        for (auto& centres : around) result.pores.emplace_back().around = std::move(centres);
        return result;
    };
    std::int64_t next = 1;
    const Pores first = pores({{1, 2, 3, 4, 5}, {10, 11, 12, 13}, {20, 21}});
    const auto numbers = lasting_numbers(first, {}, {}, next);
    EXPECT_THAT(numbers, testing::ElementsAre(1, 2, 3));
    // The second is now the largest, the first shares one of five, the third has closed, and another opened.
    const Pores second = pores({{9, 10, 11, 12}, {30, 31, 32}, {5, 6, 7, 8, 40}});
    EXPECT_THAT(lasting_numbers(second, first, numbers, next), testing::ElementsAre(2, 4, 5));
    EXPECT_EQ(next, 6);
}

TEST(Sphericity, IsOneOfARoughBallAndThatOfWadellOfARoughCube) {
    const double pi = std::numbers::pi, smooth = 0.87;
    Pore ball, cube;
    ball.body.volume = 4.0 / 3.0 * pi, ball.body.area = 4.0 * pi / smooth;
    cube.body.volume = 8.0, cube.body.area = 24.0 / smooth;
    EXPECT_NEAR(ball.sphericity(), 1.0, 1e-12);
    EXPECT_NEAR(cube.sphericity(), std::cbrt(pi / 6.0), 1e-12);
}

TEST(OutwardVectors, PointAwayFromTheNeighboursWithinReach) {
    const std::vector<Vec3> centres{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}};
    const auto outward = outward_vectors(centres, 1.2);
    EXPECT_EQ(outward[0], Vec3(-1, -1, 0));
    EXPECT_EQ(outward[1], Vec3(1, 0, 0));
    EXPECT_EQ(outward[3], Vec3(0, 0, 0));
}

TEST(PoresByOutwardVectors, LeavesTheExteriorOutAndWrapsThePore) {
    const auto centres = block([](const Vec3& p) { return (p - Vec3(8.5, 8.5, 8.5)).norm() < 4.0; });
    const auto outward = outward_vectors(centres, 1.5);
    const Pores pores =
        pores_by_outward_vectors(centres, outward, 1.9, {.probe_radius = 2.0, .seed_radius = 0.5, .lid_radius = 8.0});
    ASSERT_FALSE(pores.pores.empty());
    const Body& body = pores.pores.front().body;
    EXPECT_NEAR(body.centre.x(), 8.5, 0.3);
    // Through the centres of the wall's particles, on the far side of its first layer: more than the ball that was cut.
    const double ball = 4.0 / 3.0 * std::numbers::pi * 64.0;
    EXPECT_GT(body.volume, ball);
    EXPECT_LT(body.volume, 2.0 * ball);
    EXPECT_NEAR(pores.surface.mesh.volume(), pores.volume(), 1e-9 * pores.volume());
}

TEST(ProbeDifference, IsThePoreAndTheRoughnessOfTheOutside) {
    const auto hole = [](const Vec3& p) { return (p - Vec3(8.5, 8.5, 8.5)).norm() < 3.0; };
    const double with = probe_difference(block(hole), 0.9, 8.0), without = probe_difference(block(), 0.9, 8.0);
    EXPECT_GT(without, 0.0);
    const double pore = find_pores(block(hole), search(0.0)).volume();
    EXPECT_NEAR(with - without, pore, 0.1 * pore);
    EXPECT_THAT([] { probe_difference(block(), 2.0, 1.0); }, ThrowsMessage<InvalidInput>(HasSubstr("is not larger")));
}

}  // namespace
}  // namespace tomodem
