#include "solver_plugin/pairs/pair_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace tomodem::plugin {
namespace {

/// Particles in a flat, a long or a full cell of particles; the last third of them ghosts.
class PairSearchTest : public testing::TestWithParam<std::array<double, 3>> {};

TEST_P(PairSearchTest, FindsEveryPairWithinReachOnceAndNoneBeyond) {
    constexpr int count = 700, local = 467;
    constexpr double reach = 1.6, margin = 1e-4;
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> place(0, 1);
    std::vector<double> position;
    for (int i = 0; i < count; ++i)
        for (const double edge : GetParam()) position.push_back(edge * (place(random) - 0.3));

    PairSearch search;
    search.sort(position.data(), local, count, reach);
    std::set<std::pair<int, int>> found;
    std::vector<std::int32_t> others;
    for (int cell = 0; cell < search.cell_count(); ++cell) {
        search.enter(cell);
        others.resize(static_cast<std::size_t>(search.most_found()));
        for (int slot = search.first_slot(cell); slot < search.first_slot(cell + 1); ++slot) {
            const int here = search.particle(slot), number = search.find(slot, others.data());
            for (int k = 0; k < number; ++k)
                EXPECT_TRUE(found.emplace(std::minmax(here, static_cast<int>(others[k]))).second)
                    << here << " and " << others[k] << " are found twice";
        }
    }
    int inside = 0;
    for (int i = 0; i < local; ++i)
        for (int j = i + 1; j < count; ++j) {
            double squared = 0;
            for (int c = 0; c < 3; ++c) squared += std::pow(position[3 * i + c] - position[3 * j + c], 2);
            const double distance = std::sqrt(squared);
            inside += distance < reach ? 1 : 0;
            const bool is_found = found.contains({i, j});
            EXPECT_TRUE(is_found || distance >= reach) << distance;
            EXPECT_FALSE(is_found && distance > reach + margin) << distance;
        }
    EXPECT_GT(inside, 1000);
    for (const auto& [i, j] : found) EXPECT_LT(i, local) << "two ghosts";
}

INSTANTIATE_TEST_SUITE_P(Shapes, PairSearchTest,
                         testing::Values(std::array{8.0, 8.0, 8.0}, std::array{20.0, 20.0, 1.0},
                                         std::array{1.0, 150.0, 1.0}, std::array{2.0, 2.0, 2.0}));

}  // namespace
}  // namespace tomodem::plugin
