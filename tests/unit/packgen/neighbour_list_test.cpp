#include "tools/packgen/neighbour_list.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace tomodem::packgen {
namespace {

std::vector<Row> random_points(std::size_t count) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-0.5, 1.5);  // the list wraps them
    std::vector<Row> points(count);
    for (Row& p : points) p = {uniform(random), uniform(random), uniform(random), 0.0};
    return points;
}

double distance(const Row& a, const Row& b) {
    const auto nearest = [](double s) { return s - std::round(s); };
    return std::hypot(nearest(a.x - b.x), nearest(a.y - b.y), nearest(a.z - b.z));
}

class NeighboursWithin : public testing::TestWithParam<double> {};

TEST_P(NeighboursWithin, AreThoseOfAllPairs) {
    std::vector<Row> position = random_points(700), travellers = position;
    NeighbourList list;
    ThreadTeam team(2);
    list.build(position, travellers, GetParam(), team);
    for (std::size_t i = 0; i < position.size(); ++i) {
        const NeighbourBlocks blocks = list.chunk(i / NeighbourList::chunk_size);
        const std::size_t k = i % NeighbourList::chunk_size;
        std::set<std::size_t> found, expected;
        std::size_t listed = 0;
        for (std::size_t e = 4 * blocks.first_block[k]; e < 4 * blocks.first_block[k + 1]; ++e) {
            const auto j = static_cast<std::size_t>(blocks.entries[e]);
            if (j == i) continue;
            found.insert(j);
            ++listed;
            if (blocks.at_boundary[k] == 0) {  // then the kernel leaves the nearest image out
                EXPECT_LT(std::hypot(position[i].x - position[j].x, position[i].y - position[j].y,
                                     position[i].z - position[j].z),
                          GetParam());
            }
        }
        for (std::size_t j = 0; j < position.size(); ++j)
            if (j != i && distance(position[i], position[j]) < GetParam()) expected.insert(j);
        ASSERT_EQ(found, expected) << "particle " << i;
        ASSERT_EQ(listed, expected.size()) << "particle " << i;
    }
}

// 1, 3, 4 and 9 cells an edge.
INSTANTIATE_TEST_SUITE_P(Cutoffs, NeighboursWithin, testing::Values(0.45, 0.33, 0.25, 0.11));

// Boxes of few and of many cells along an axis, some with walls, which points may lie behind.
TEST(NeighbourList, IsThatOfAllPairsInAnyRegion) {
    for (const Region& region :
         {Region{{1.0, 4.0, 2.0}, {true, true, true}, true}, Region{{3.0, 1.0, 1.5}, {true, false, true}, true},
          Region{{3.0, 1.0, 1.5}, {false, true, false}, false}, Region{{1.0, 1.0, 5.0}, {false, false, false}, false}})
        for (const double cutoff : {0.12, 0.3, 0.45}) {
            std::vector<Row> position = random_points(600);
            for (std::size_t i = 0; i < position.size(); ++i) {
                Row& p = position[i];
                p = {p.x * region.edges[0], p.y * region.edges[1], p.z * region.edges[2],
                     0.3 + 0.4 * static_cast<double>(i % 11) / 10.0};
            }
            std::vector<Row> travellers = position;
            const double diameter = cutoff / 1.5, skin = 0.1 * diameter;
            NeighbourList list;
            ThreadTeam team(2);
            list.build(position, travellers, cutoff, team, region, diameter, skin);
            for (std::size_t i = 0; i < position.size(); ++i) {
                const NeighbourBlocks blocks = list.chunk(i / NeighbourList::chunk_size);
                const std::size_t k = i % NeighbourList::chunk_size;
                std::multiset<std::size_t> found, expected;
                for (std::size_t e = 4 * blocks.first_block[k]; e < 4 * blocks.first_block[k + 1]; ++e)
                    if (const auto j = static_cast<std::size_t>(blocks.entries[e]); j != i) found.insert(j);
                for (std::size_t j = 0; j < position.size(); ++j) {
                    const Row &p = position[i], &q = position[j];
                    const double apart = std::hypot(region.nearest(0, p.x - q.x), region.nearest(1, p.y - q.y),
                                                    region.nearest(2, p.z - q.z));
                    const double reach =
                        region.equal_radii ? cutoff : std::min(cutoff, (p.radius + q.radius) * diameter + skin);
                    if (j != i && apart < reach) expected.insert(j);
                }
                ASSERT_EQ(found, expected) << "particle " << i << ", cutoff " << cutoff;
            }
        }
}

TEST(NeighbourList, SortsTheTravellersWithTheirParticles) {
    std::vector<Row> position = random_points(300);
    std::vector<Row> travellers = position;
    NeighbourList list;
    ThreadTeam team(1);
    list.build(position, travellers, 0.2, team);
    for (std::size_t i = 0; i < position.size(); ++i) EXPECT_NEAR(distance(position[i], travellers[i]), 0.0, 1e-15);
}

TEST(ThreadTeam, DoesEachPieceOfWorkOnce) {
    ThreadTeam team(3);
    for (const std::size_t count : {0, 1, 2, 7, 1000}) {
        std::vector<int> done(count, 0);
        for (int repeat = 0; repeat < 50; ++repeat) team.for_each(count, [&](std::size_t i) { ++done[i]; });
        for (const int times : done) ASSERT_EQ(times, 50);
    }
}

}  // namespace
}  // namespace tomodem::packgen
