#include "tools/metrics/shapes/assignment.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace tomodem::shapes {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST(BestPairs, TakeTheLargestSumAndNotTheLargestFirst) {
    EXPECT_THAT(best_pairs({{1, 1, 0.9}, {1, 2, 0.8}, {2, 1, 0.8}}), ElementsAre(Pair(1, 2), Pair(2, 1)));
    EXPECT_THAT(best_pairs({{1, 1, 0.9}, {1, 2, 0.4}, {2, 1, 0.4}}), ElementsAre(Pair(1, 1)));
}

TEST(BestPairs, OfNothingAreNone) {
    EXPECT_THAT(best_pairs({}), IsEmpty());
}

TEST(BestPairs, LeaveWhatHasNoPartner) {
    EXPECT_THAT(best_pairs({{7, 3, 0.1}, {8, 3, 0.2}, {9, 3, 0.15}}), ElementsAre(Pair(8, 3)));
    EXPECT_THAT(best_pairs({{3, 7, 0.1}, {3, 8, 0.2}, {3, 9, 0.15}}), ElementsAre(Pair(3, 8)));
}

double sum_of(const std::vector<Candidate>& candidates, std::int32_t left, std::int32_t right) {
    for (const Candidate& candidate : candidates)
        if (candidate.left == left && candidate.right == right) return candidate.score;
    return 0.0;
}

TEST(BestPairs, AreAsGoodAsTheBestOfAllPermutationsInAnyOrder) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int trial = 0; trial < 200; ++trial) {
        const int lefts = 1 + trial % 5, rights = 1 + trial / 5 % 5;
        std::vector<Candidate> candidates;
        for (int i = 0; i < lefts; ++i)
            for (int j = 0; j < rights; ++j)
                if (uniform(random) < 0.6) candidates.push_back({i, j, 0.01 + uniform(random)});
        double best = 0.0;
        std::vector<int> order(std::max(lefts, rights));
        std::iota(order.begin(), order.end(), 0);
        do {
            double sum = 0.0;
            for (int i = 0; i < lefts; ++i) sum += sum_of(candidates, i, order[i]);
            best = std::max(best, sum);
        } while (std::next_permutation(order.begin(), order.end()));
        const auto pairs = best_pairs(candidates);
        double sum = 0.0;
        for (const auto& [left, right] : pairs) sum += sum_of(candidates, left, right);
        EXPECT_NEAR(sum, best, 1e-12);
        std::shuffle(candidates.begin(), candidates.end(), random);
        EXPECT_EQ(best_pairs(candidates), pairs);
    }
}

TEST(BestPairs, OfAShiftedChainOfThousandsAreThoseShifted) {
    // A chain in which each could have its own or the next one's, as in a scan that is shifted.
    std::vector<Candidate> candidates;
    for (std::int32_t i = 0; i < 20000; ++i) {
        candidates.push_back({i, i, 0.5});
        candidates.push_back({i, i + 1, 0.51});
        candidates.push_back({i, i + 141, 0.4});
    }
    const auto pairs = best_pairs(candidates);
    ASSERT_EQ(pairs.size(), 20000u);
    for (const auto& [left, right] : pairs) ASSERT_EQ(right, left + 1);
}

}  // namespace
}  // namespace tomodem::shapes
