#include "solver_plugin/norton/flow_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

namespace tomodem::plugin {
namespace {

constexpr double reach = 1.5, skin = 0.1;

using Pairs = std::set<std::pair<int, int>>;

/// Random particles of two objects, the last of them ghosts.
class FlowPairsTest : public testing::Test {
 protected:
    static constexpr int count = 600, ghosts = 150, local = count - ghosts;

    FlowPairsTest() : position(3 * count), object(count), id(count), random(5) {
        std::uniform_real_distribution<double> place(-4, 4);
        for (double& coordinate : position) coordinate = place(random);
        for (std::int32_t& one : object) one = static_cast<std::int32_t>(random() % 2);
        std::iota(id.begin(), id.end(), 1);
    }
    ParticleView view() const {
        return {position.data(), nullptr, nullptr, nullptr, id.data(), local, count, object.data()};
    }
    double distance(int i, int j) const {
        double squared = 0;
        for (int c = 0; c < 3; ++c) squared += std::pow(position[3 * i + c] - position[3 * j + c], 2);
        return std::sqrt(squared);
    }
    /// Of one object, or of two.
    Pairs wanted(bool pushing) const {
        Pairs pairs;
        for (int i = 0; i < local; ++i)
            for (int j = i + 1; j < count; ++j)
                if (distance(i, j) < reach && (object[i] != object[j]) == pushing) pairs.emplace(i, j);
        return pairs;
    }
    /// Likewise; every pair has to be there once and at the place of its particles.
    Pairs found(const FlowPairs& from, bool pushing) const {
        Pairs pairs;
        const auto add = [&](int i, int j, Four apart) {
            EXPECT_TRUE(pairs.emplace(std::minmax(i, j)).second) << i << " " << j;
            EXPECT_LT(i, local);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(apart[c], position[3 * i + c] - position[3 * j + c], 1e-6);
            EXPECT_NEAR(apart[3], distance(i, j), 1e-6);
        };
        if (pushing)
            for (const FlowPairs::Pushing& one : from.pushing()) add(one.particle, one.other, one.apart);
        else
            for (std::size_t row = 0; row + 1 < from.rows().size(); ++row)
                for (std::size_t k = from.rows()[row].begin; k < from.rows()[row + 1].begin; ++k)
                    add(from.rows()[row].particle, from.other()[k], from.apart()[k]);
        return pairs;
    }
    void expect_all(const FlowPairs& pairs) const {
        for (const bool pushing : {false, true}) EXPECT_EQ(found(pairs, pushing), wanted(pushing));
        EXPECT_EQ(pairs.size(), wanted(false).size());
    }
    /// By at most the length, in a direction of its own.
    void stir(double length) {
        std::uniform_real_distribution<double> way(-length / std::sqrt(3.0), length / std::sqrt(3.0));
        for (double& coordinate : position) coordinate += way(random);
    }

    std::vector<double> position;
    std::vector<std::int32_t> object, id;
    std::mt19937_64 random;
};

TEST_F(FlowPairsTest, AreThoseInTheCrownAndSearchedForAtEveryCallWithoutASkin) {
    FlowPairs pairs;
    for (int call = 1; call < 4; ++call) {
        pairs.find(view(), reach);
        expect_all(pairs);
        EXPECT_EQ(pairs.searches(), call);
        stir(0.3);
    }
}

TEST_F(FlowPairsTest, AreSearchedForAgainWhenAParticleHasMovedByHalfTheSkin) {
    FlowPairs pairs;
    pairs.set_skin(skin);
    pairs.find(view(), reach, true);
    // Not one of them farther than 9 * 0.005.
    for (int call = 0; call < 9; ++call) {
        stir(0.005);
        pairs.find(view(), reach, false);
        expect_all(pairs);
    }
    EXPECT_EQ(pairs.searches(), 1);
    // One ghost alone, into the middle of the others.
    for (int c = 0; c < 3; ++c) position[3 * (count - 1) + c] = 0;
    pairs.find(view(), reach, false);
    expect_all(pairs);
    EXPECT_EQ(pairs.searches(), 2);
    for (int call = 0; call < 60; ++call) {
        stir(0.02);
        pairs.find(view(), reach, false);
        expect_all(pairs);
    }
    EXPECT_GT(pairs.searches(), 3);
    EXPECT_LT(pairs.searches(), 30);
}

TEST_F(FlowPairsTest, AreSearchedForAgainWhenParticlesHaveOtherNumbersOrAnotherReach) {
    FlowPairs pairs;
    pairs.set_skin(skin);
    pairs.find(view(), reach, true);
    // Others stand in the same places: those of before would be pairs of the wrong kind.
    std::shuffle(object.begin(), object.end(), random);
    pairs.find(view(), reach, true);
    expect_all(pairs);
    EXPECT_EQ(pairs.searches(), 2);
    pairs.find(view(), 1.1 * reach, false);
    EXPECT_EQ(pairs.searches(), 3);
    EXPECT_GT(pairs.size(), wanted(false).size());
}

TEST_F(FlowPairsTest, AreNoneOfTwoParticlesInOnePlace) {
    for (int c = 0; c < 3; ++c) position[c] = position[3 + c] = 100;
    FlowPairs pairs;
    pairs.find(view(), reach);
    for (const bool pushing : {false, true}) EXPECT_FALSE(found(pairs, pushing).contains({0, 1}));
}

}  // namespace
}  // namespace tomodem::plugin
