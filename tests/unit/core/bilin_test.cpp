#include "core/law/pair.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"

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

TEST(BilinMasterCurve, PassesThroughTheThesisPhases) {
    // Thesis: t0 and k_rep of both phases, time step 5e-4 s, 1e-3 /s.
    const auto flow_stress = [](double stiffness, double period) {
        return stiffness * bilin_master_curve(1e-3 * period * period / 5e-4) / 1e6;
    };
    EXPECT_NEAR(flow_stress(6.23e9, 1e-2), 94.3, 0.05 * 94.3);
    EXPECT_NEAR(flow_stress(2.65e9, 0.8), 170.1, 0.10 * 170.1);
}

TEST(BilinMasterCurve, RisesAndRefusesTheCollapse) {
    double last = 0;
    for (double chi = 0.01; chi < 41; chi *= 1.3) {
        EXPECT_GE(bilin_master_curve(chi), last);
        last = bilin_master_curve(chi);
    }
    EXPECT_THAT([] { bilin_master_curve(42); }, testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("collapses")));
}

TEST(BilinChi, HasTheSensitivityAskedFor) {
    for (double sensitivity : {0.05, 0.1, 0.2, 0.3, 0.4})
        EXPECT_NEAR(bilin_rate_sensitivity(bilin_chi_for(sensitivity)), sensitivity, 1e-6);
    EXPECT_EQ(bilin_chi_for(2.45e-3), 0);
    EXPECT_NEAR(bilin_rate_sensitivity(bilin_chi_for(0.49)), 0.49, 0.04);
    EXPECT_THAT([] { bilin_chi_for(0.8); }, testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("out of reach")));
}

}  // namespace
}  // namespace tomodem::law
