#include "tools/metrics/curves/stress_resolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/metrics/synthetic_run.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem::curves {
namespace {

using StressResolutionOf = InTemporaryFolder;

StressResolution of_points(const std::vector<Vec3>& points, double difference, const std::filesystem::path& path) {
    synthetic::write_run(synthetic::sample(points), path, {});
    return stress_resolution(RunReader(path), difference);
}

/// Parallel rods of so many lattice points squared.
std::vector<Vec3> rods(int across) {
    std::vector<Vec3> points;
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(0, 20, 0)})
        for (int k = 0; k < 40; ++k)
            for (int j = 0; j < across; ++j)
                for (int i = 0; i < across; ++i) points.push_back(corner + Vec3(i, j, k));
    return points;
}

TEST_F(StressResolutionOf, ADenseSampleIsReliable) {
    const StressResolution dense = of_points(synthetic::cube(7, 1.0), 0.02, folder / "run.h5");
    EXPECT_GT(dense.particles_across, 5.0);
    EXPECT_TRUE(dense.reliable());
    EXPECT_EQ(dense.particles_to_do, 0);
}

TEST_F(StressResolutionOf, ThinRodsAreNotAndTheNumberThatWouldDoMakesThemThickEnough) {
    const StressResolution thin = of_points(rods(2), 0.02, folder / "run.h5");
    EXPECT_NEAR(thin.particles_across, 0.65 + 1.15, 0.05);  // the envelope is a rod of 1 x 1
    EXPECT_EQ(thin.particles_needed, 3.0);
    EXPECT_FALSE(thin.fine_enough());
    EXPECT_FALSE(thin.reliable());
    const double ratio = 3.0 / thin.particles_across;
    EXPECT_GE(thin.particles_to_do, 3 * 160 * std::pow(ratio, 3));
    EXPECT_LE(thin.particles_to_do, 1.1 * 3 * 160 * std::pow(ratio, 3));
    EXPECT_TRUE(of_points(rods(5), 0.02, folder / "fine.h5").reliable());
}

TEST_F(StressResolutionOf, PlanesThatFeelDifferentForcesAreNot) {
    const auto path = folder / "run.h5";
    EXPECT_TRUE(of_points(synthetic::cube(7, 1.0), 0.09, path).reliable());
    const StressResolution loose = of_points(synthetic::cube(7, 1.0), 0.96, path);
    EXPECT_TRUE(loose.fine_enough());
    EXPECT_FALSE(loose.in_equilibrium());
    EXPECT_FALSE(loose.reliable());
    EXPECT_TRUE(of_points(synthetic::cube(7, 1.0), std::numeric_limits<double>::quiet_NaN(), path).in_equilibrium());
}

}  // namespace
}  // namespace tomodem::curves
