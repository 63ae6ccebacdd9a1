#include "core/surface/filling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace tomodem {
namespace {

/// Face-centred cubic, a distance of 1 apart (so 1 / sqrt 2 mm^3 a centre), out of place by up to a twentieth.
std::vector<Vec3> fcc(int cells, const std::function<bool(const Vec3&)>& inside = {}) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> shift(-0.05, 0.05);
    const double a = std::sqrt(2.0);
    std::vector<Vec3> centres;
    for (int k = 0; k < 2 * cells; ++k)
        for (int j = 0; j < 2 * cells; ++j)
            for (int i = 0; i < 2 * cells; ++i) {
                if ((i + j + k) % 2 != 0) continue;
                const Vec3 place = 0.5 * a * Vec3(i, j, k);
                if (inside && !inside(place)) continue;
                centres.push_back(place + Vec3(shift(generator), shift(generator), shift(generator)));
            }
    return centres;
}

const double share = 1.0 / std::sqrt(2.0);

TEST(Filling, KnowsTheShareOfAParticleInABlockAndInAStrutOfTwo) {
    EXPECT_NEAR(filling_of(fcc(6), 0.5).particle, share, 0.01 * share);
    const auto strut = fcc(12, [](const Vec3& p) { return std::hypot(p.x() - 8.0, p.y() - 8.0) < 1.0; });
    EXPECT_NEAR(filling_of(strut, 0.5).particle, share, 0.05 * share);
    EXPECT_NEAR(filling_of(strut, 0.5).solid, share * double(strut.size()), 0.05 * share * double(strut.size()));
}

TEST(Filling, KnowsTheHullOfABlockOfWallsAndOfAFrameWhichAloneIsOpen) {
    const Filling block = filling_of(fcc(10), 0.5);
    const double edge = 19.0 * std::sqrt(0.5) + 0.1 + 0.16;  // out of place, and a twelfth of a diameter beyond
    EXPECT_NEAR(block.hull, edge * edge * edge, 0.01 * block.hull);
    EXPECT_FALSE(is_open(block));
    const auto walls = fcc(10, [](const Vec3& p) { return p.minCoeff() < 1.0 || p.maxCoeff() > 12.0; });
    const Filling empty = filling_of(walls, 0.5);
    EXPECT_NEAR(empty.hull, block.hull, 0.01 * block.hull);
    EXPECT_NEAR(empty.solid / block.solid, double(walls.size()) / double(fcc(10).size()), 0.03);
    EXPECT_FALSE(is_open(empty));
    const auto frame = fcc(10, [](const Vec3& p) {
        int at_edge = 0;
        for (const double x : {p.x(), p.y(), p.z()}) at_edge += x < 2.0 || x > 11.0;
        return at_edge >= 2;
    });
    EXPECT_TRUE(is_open(filling_of(frame, 0.5)));
}

TEST(Filling, IsUnknownWhereNoParticlesLieTogether) {
    std::vector<Vec3> apart;
    for (const Vec3& p : fcc(4)) apart.emplace_back(3.0 * p);
    const Filling filling = filling_of(apart, 0.5);
    EXPECT_EQ(filling.particle, 0.0);
    EXPECT_EQ(filling.solid, 0.0);
    EXPECT_GT(filling.hull, 0.0);
    EXPECT_FALSE(is_open(filling));
    EXPECT_EQ(filling_of(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 0.5).hull, 0.0);
}

TEST(WithoutLoose, LeavesOutSmallGroupsThatLieApart) {
    std::vector<Vec3> centres = fcc(4);
    const std::size_t block = centres.size();
    for (int i = 0; i < 5; ++i) centres.emplace_back(20.0 + i, 0.0, 0.0);  // five in a row
    centres.emplace_back(-1.5, 0.0, 0.0);                                  // within two diameters of the block
    const std::vector<std::int32_t> kept = without_loose(centres, 0.5);
    ASSERT_EQ(kept.size(), block + 1);
    EXPECT_EQ(kept.front(), 0);
    EXPECT_EQ(kept.back(), std::int32_t(centres.size()) - 1);
    EXPECT_EQ(centres_of(centres, kept).back(), centres.back());
    EXPECT_LT(filling_of(centres_of(centres, kept), 0.5).hull, 0.6 * filling_of(centres, 0.5).hull);
}

TEST(WithoutLoose, KeepsAllOfASampleOfFewParticles) {
    EXPECT_EQ(without_loose(std::vector<Vec3>{{0, 0, 0}, {9, 0, 0}}, 0.5).size(), 2u);
}

}  // namespace
}  // namespace tomodem
