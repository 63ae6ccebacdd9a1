#include "core/law/pair.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/law/self_contact.hpp"
#include "core/scene/laws/bilin.hpp"

namespace tomodem::law {
namespace {

constexpr Pair pair{1.0, 1.5, 6.0e9, 6.0e8};

TEST(BilinForce, IsLinearInTheSeedAndInTheCrown) {
    EXPECT_DOUBLE_EQ(pair_force(pair, 0.9, 0), 6.0e8);
    EXPECT_DOUBLE_EQ(pair_force(pair, 1.2, 1), -1.2e8);
    EXPECT_DOUBLE_EQ(pair_force(pair, 1.5, 1), -3.0e8);
}

TEST(BilinForce, VanishesWhileApproachingInTheCrownAndBeyondIt) {
    EXPECT_EQ(pair_force(pair, 1.2, -1), 0);
    EXPECT_EQ(pair_force(pair, 1.2, 0), 0);
    EXPECT_EQ(pair_force(pair, 1.5001, 1), 0);
    EXPECT_EQ(pair_force(pair, 1.0, 1), 0);
}

TEST(TrilinForce, PullsNoHarderThanItsBound) {
    Pair bounded = pair;
    bounded.max_attraction = 1e8;
    EXPECT_NEAR(pair_force(bounded, 1.1, 1), -0.6e8, 1);
    EXPECT_DOUBLE_EQ(pair_force(bounded, 1.4, 1), -1e8);
    EXPECT_EQ(pair_force(bounded, 1.4, -1), 0);
    EXPECT_DOUBLE_EQ(pair_force(bounded, 0.9, 1), 6.0e8);
}

TEST(TrilinWall, PullsThreeTimesAsHardWhateverTheRate) {
    Pair bounded = pair;
    bounded.max_attraction = 1e8;
    const Wall wall = against_wall(bounded);
    EXPECT_DOUBLE_EQ(wall_force(wall, 0.6, -1), -3 * 0.6e8);
    EXPECT_DOUBLE_EQ(wall_force(wall, 0.7, -1), -3e8);
    EXPECT_DOUBLE_EQ(wall_force(wall, 0.4, -1), 6.0e8);
    EXPECT_EQ(wall_force(wall, 0.76, 1), 0);
}

TEST(BilinWall, PullsLikeAParticleAndOnlyWhileSeparating) {
    EXPECT_DOUBLE_EQ(wall_force(against_wall(pair), 0.6, 1), -0.6e8);
    EXPECT_EQ(wall_force(against_wall(pair), 0.6, -1), 0);
}

TEST(SelfContact, IsAnInterfaceWhereTwoFreeSurfacesMeet) {
    const SelfContact law{.min_outward = 2.3};
    const double up[3] = {0, 0, 3}, down[3] = {0, 0, -3}, weak[3] = {0, 0, -2}, line_up[3] = {0, 0, 1.4};
    const double tilted[3] = {3 * std::sin(1.2), 0, 3 * std::cos(1.2)};
    EXPECT_TRUE(is_interface(law, up, down, line_up));
    EXPECT_TRUE(is_interface(law, up, weak, line_up)) << "one surface is enough";
    EXPECT_FALSE(is_interface(law, weak, weak, line_up)) << "inside";
    EXPECT_FALSE(is_interface(law, up, up, line_up)) << "one surface, not two";
    EXPECT_FALSE(is_interface(law, down, up, line_up)) << "surfaces that look away";
    EXPECT_TRUE(is_interface(law, up, tilted, line_up)) << "69 degrees between the surfaces";
}

TEST(BilinMasterCurve, PassesThroughTheThesisPhases) {
    // Thesis: t0 and k_rep of both phases, time step 5e-4 s, 1e-3 /s.
    const auto flow_stress = [](double stiffness, double period) {
        return stiffness * shipped_calibration().find<BilinCalibration>()->curve.at(1e-3 * period * period / 5e-4) /
               1e6;
    };
    EXPECT_NEAR(flow_stress(6.23e9, 1e-2), 94.3, 0.05 * 94.3);
    EXPECT_NEAR(flow_stress(2.65e9, 0.8), 170.1, 0.10 * 170.1);
}

TEST(BilinMasterCurve, RisesAndRefusesTheCollapse) {
    const BilinFlow& curve = shipped_calibration().find<BilinCalibration>()->curve;
    double last = 0;
    for (double chi = 0.01; chi < 41; chi *= 1.3) {
        EXPECT_GE(curve.at(chi), last);
        last = curve.at(chi);
    }
    EXPECT_THAT([&] { curve.at(42); }, testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("collapses")));
}

TEST(BilinChi, HasTheSensitivityAskedFor) {
    const BilinFlow& curve = shipped_calibration().find<BilinCalibration>()->curve;
    for (double sensitivity : {0.05, 0.1, 0.2, 0.3, 0.4})
        EXPECT_NEAR(curve.sensitivity(curve.chi_for(sensitivity)), sensitivity, 1e-6);
    EXPECT_EQ(curve.chi_for(2.45e-3), 0);
    EXPECT_NEAR(curve.sensitivity(curve.chi_for(0.49)), 0.49, 0.04);
    EXPECT_THAT([&] { curve.chi_for(0.8); },
                testing::ThrowsMessage<InvalidInput>(
                    testing::HasSubstr("out of reach of law \"bilin\", which holds up to 0.5; law \"norton\" can")));
}

}  // namespace
}  // namespace tomodem::law
