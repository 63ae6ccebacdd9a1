#include "tools/packgen/contact_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "tools/packgen/neighbour_list.hpp"

namespace tomodem::packgen {
namespace {

// Forces on particles that all see each other.
std::vector<Row> forces(std::vector<Row> position, double diameter, ForceSums* sums = nullptr,
                        const Region& region = {}) {
    const std::size_t count = position.size();
    std::vector<std::int32_t> entries;
    std::vector<std::uint32_t> first_block{0};
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j)
            if (j != i) entries.push_back(static_cast<std::int32_t>(j));
        entries.resize((entries.size() + 3) / 4 * 4, static_cast<std::int32_t>(i));
        first_block.push_back(static_cast<std::uint32_t>(entries.size() / 4));
    }
    const std::vector<std::uint8_t> at_boundary(count, 1);
    const std::vector<Row> velocity(count, Row{1.0, 0.0, 0.0});
    std::vector<Row> force(count);
    const ForceSums found = contact_forces(position.data(), velocity.data(), force.data(), 0, count,
                                           {entries.data(), first_block.data(), at_boundary.data()}, diameter, region);
    if (sums != nullptr) *sums = found;
    return force;
}

TEST(ContactForce, OfTwoSpheresIsTheirOverlapAlongTheLineOfCentres) {
    // Centres 0.05 apart along (3, 0, 4) / 5, d = 0.1: overlap one half.
    const std::vector<Row> force = forces({{0.5, 0.5, 0.5}, {0.53, 0.5, 0.54}}, 0.1);
    EXPECT_NEAR(force[1].x, 0.5 * 0.6, 1e-13);
    EXPECT_NEAR(force[1].y, 0.0, 1e-13);
    EXPECT_NEAR(force[1].z, 0.5 * 0.8, 1e-13);
    EXPECT_EQ(force[0].x, -force[1].x);
    EXPECT_EQ(force[0].z, -force[1].z);
}

TEST(ContactForce, ActsThroughThePeriodicBoundary) {
    const std::vector<Row> force = forces({{0.99, 0.5, 0.01}, {0.02, 0.5, 0.97}}, 0.1);
    EXPECT_NEAR(force[1].x, 0.5 * 0.6, 1e-13);
    EXPECT_NEAR(force[1].z, -0.5 * 0.8, 1e-13);
}

TEST(ContactForce, IsZeroBeyondContactAndForCoincidentCentres) {
    const std::vector<Row> force = forces({{0.5, 0.5, 0.5}, {0.6001, 0.5, 0.5}, {0.5, 0.5, 0.5}}, 0.1);
    for (const Row& f : force) EXPECT_EQ(f.x * f.x + f.y * f.y + f.z * f.z, 0.0);
}

TEST(ContactForce, SumsAreThoseOfTheForcesReturned) {
    ForceSums sums;
    const std::vector<Row> force = forces({{0.5, 0.5, 0.5}, {0.55, 0.5, 0.5}, {0.5, 0.575, 0.5}}, 0.1, &sums);
    double power = 0.0, squared = 0.0;
    for (const Row& f : force) {
        power += f.x;
        squared += f.x * f.x + f.y * f.y + f.z * f.z;
    }
    EXPECT_NEAR(sums.force_velocity, power, 1e-15);
    EXPECT_NEAR(sums.force_squared, squared, 1e-15);
    EXPECT_EQ(sums.velocity_squared, 3.0);
    const double third = 1.0 - std::hypot(0.05, 0.075) / 0.1;
    EXPECT_NEAR(sums.load, 2.0 * (0.5 + 0.25 + third), 1e-12);
}

TEST(ContactForce, OfSpheresOfTheirOwnRadiiIsWhatTheSumOfThemLacks) {
    const Region region{{1.0, 2.0, 3.0}, {true, true, true}, false};
    // d = 0.1, radii 0.03 and 0.05, centres 0.05 apart across the faces at y = 0 and 2: depth 0.03, over d 0.3.
    const std::vector<Row> force = forces({{0.5, 0.02, 0.5, 0.3}, {0.5, 1.98, 0.53, 0.5}}, 0.1, nullptr, region);
    EXPECT_NEAR(force[0].y, 0.3 * 0.8, 1e-12);
    EXPECT_NEAR(force[0].z, -0.3 * 0.6, 1e-12);
    EXPECT_EQ(force[1].y, -force[0].y);
}

TEST(ContactForce, OfAWallIsTheDepthOfTheSphereInIt) {
    const Region region{{1.0, 1.0, 4.0}, {false, true, false}, true};
    ForceSums sums;
    const std::vector<Row> force = forces({{0.02, 0.01, 3.99}, {0.5, 0.99, 0.5}}, 0.1, &sums, region);
    EXPECT_NEAR(force[0].x, 0.3, 1e-12);   // (0.05 - 0.02) / 0.1
    EXPECT_NEAR(force[0].z, -0.4, 1e-12);  // (0.05 - 0.01) / 0.1
    EXPECT_EQ(force[0].y, 0.0);            // periodic, and nobody near
    EXPECT_EQ(force[1].x, 0.0);
    EXPECT_NEAR(sums.load, 0.7, 1e-12);
}

TEST(ContactForce, HasTheSameBitsOnEveryInstructionSet) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform;
    std::vector<Row> position(60);
    for (Row& p : position) p = {uniform(random), uniform(random), uniform(random), 0.0};
    const std::vector<Row> best = forces(position, 0.3);
    use_instruction_set(InstructionSet::baseline);
    const std::vector<Row> baseline = forces(position, 0.3);
    use_instruction_set(InstructionSet::best);
    EXPECT_EQ(std::memcmp(best.data(), baseline.data(), best.size() * sizeof(Row)), 0);
}

}  // namespace
}  // namespace tomodem::packgen
