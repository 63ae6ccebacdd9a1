#include "tools/plan/proposal.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "tests/unit/plan/drawn.hpp"

namespace tomodem::plan {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// Errors that fall from 20 % at 4 particles across to 5 % at 16; NORTON's half of that at ten times the cost of a
/// step.
const TradeTable table = [] {
    TradeTable made;
    TradeCurve curve{{4, 16}, {0.2, 0.05}, {0, 0}, {2e-5, 2e-4}, {0, 0.03}, 0.05, 1e-8, {1e7, 1000}, {0, 0}};
    TradeCurve dense{{500, 8000}, {0.2, 0.05}, {0, 0}, {2e-5, 2e-4}, {0, 0.03}, 0.05, 1e-8, {1e7, 1000}, {0, 0}};
    LawTrade bilin{0.7, {}};
    for (const Quantity quantity : quantities)
        bilin.curve[quantity] = quantity == Quantity::flow_stress ? dense : curve;
    LawTrade norton = bilin;
    norton.density = 0.64;
    for (auto& [quantity, one] : norton.curve) {
        one.bias = {0.1, 0.025};
        one.step = {0.02};
        one.step_error = {0};
        one.particle_step = 1e-7;
    }
    made.law = {{"bilin", bilin}, {"norton", norton}};
    return made;
}();

Plan planned(const LabelVolume& volume, const std::string& scene, PlanRequest request) {
    request.scene_text = scene;
    request.scene_name = "scene.toml";
    return make_plan(find_features(volume, readable_scene(scene, "scene.toml"), 1), request, table);
}

TEST(Plan, TakesTheParticlesAcrossThatTheTableHasAtTheError) {
    PlanRequest request;
    request.error = 0.1;
    request.of = {Quantity::shape_factor};
    request.law = "bilin";
    const Plan plan = planned(drawn::balls({12, 12}, 2), drawn::two_phases, request);
    // 0.2 - 0.15 log4(r / 4) = 0.1 is r = 4 4^(2/3) at the finest step; the cheapest step may ask for more.
    const double smallest = 4 * std::pow(4, 2.0 / 3);
    const double across = plan.proposal.errors.at(0).resolution;
    EXPECT_GE(across, smallest);
    EXPECT_LE(across, 1.2 * smallest);
    EXPECT_NEAR(plan.proposal.seed_radius, 0.24 / (2 * across), 0.002 * plan.proposal.seed_radius);
    EXPECT_LE(plan.proposal.error(), 0.1);
    EXPECT_GT(plan.proposal.error(), 0.09);
    // Particles: density 0.7 of 0.6^3 mm^3.
    const double volume = 4 * std::numbers::pi / 3 * std::pow(plan.proposal.seed_radius, 3);
    EXPECT_NEAR(plan.proposal.particles, 0.7 * 0.216 / volume, 1);
    EXPECT_NEAR(plan.proposal.bytes, 1e7 + 1000 * plan.proposal.particles, 1);
    EXPECT_NEAR(plan.proposal.cpu_seconds, 1e-8 * plan.proposal.particles * static_cast<double>(plan.proposal.steps),
                1e-9);
}

TEST(Plan, ResolvesTheSmallestObjectIfAsked) {
    PlanRequest request;
    request.error = 0.1;
    request.of = {Quantity::shape_factor};
    const Plan median = planned(drawn::balls({12, 6}, 2), drawn::two_phases, request);
    request.smallest = true;
    const Plan smallest = planned(drawn::balls({12, 6}, 2), drawn::two_phases, request);
    EXPECT_NEAR(median.proposal.seed_radius / smallest.proposal.seed_radius, 2, 0.03);
}

TEST(Plan, LooksAtEverythingThatTheImageHasUnlessToldWhat) {
    PlanRequest request;
    request.error = 0.2;
    EXPECT_THAT(planned(drawn::balls({12}, 2), drawn::two_phases, request).of,
                ElementsAre(Quantity::composite_stress, Quantity::shape_factor));
    EXPECT_THAT(planned(drawn::balls({12}, 0), drawn::one_phase, request).of, ElementsAre(Quantity::pore_volume));
    EXPECT_THAT(planned(drawn::balls({}, 0), drawn::one_phase, request).of, ElementsAre(Quantity::flow_stress));
}

TEST(Plan, TakesTheDearerLawWhereTheCheapOneCannot) {
    PlanRequest request;
    request.error = 0.04;
    const Plan plan = planned(drawn::balls({12}, 2), drawn::two_phases, request);
    EXPECT_EQ(plan.proposal.choice.law, "norton");
    EXPECT_THAT(plan.other_laws, IsEmpty());
    EXPECT_THAT(plan.not_taken, IsEmpty());  // BILIN can hold the scene, but not the error
}

TEST(Plan, LeavesOutALawThatCannotCarryTheLoad) {
    PlanRequest request;
    request.error = 0.2;
    std::string scene = drawn::two_phases;
    scene.replace(scene.find("-0.3"), 4, "0.3");
    const Plan plan = planned(drawn::balls({12}, 2), scene, request);
    EXPECT_EQ(plan.proposal.choice.law, "norton");
    ASSERT_EQ(plan.not_taken.size(), 1);
    EXPECT_THAT(plan.not_taken[0].second, HasSubstr("tension"));
}

TEST(Plan, LeavesOutALawThatHasNotTheSensitivity) {
    PlanRequest request;
    request.error = 0.2;
    std::string scene = drawn::two_phases;
    scene.replace(scene.find("0.0714"), 6, "0.8");
    const Plan plan = planned(drawn::balls({12}, 2), scene, request);
    EXPECT_EQ(plan.proposal.choice.law, "norton");
    EXPECT_THAT(plan.not_taken.at(0).second, HasSubstr("M = 0.8 is out of reach of law \"bilin\""));
}

TEST(Plan, LeavesOutNortonWhereSurfacesMeet) {
    PlanRequest request;
    request.error = 0.2;
    const Plan plan = planned(drawn::balls({12, 12}, 2),
                              std::string(drawn::two_phases) + "[contact]\nself_contact = true\n", request);
    ASSERT_EQ(plan.not_taken.size(), 1);
    EXPECT_EQ(plan.not_taken[0].first, "norton");
    EXPECT_THAT(plan.not_taken[0].second, HasSubstr("self_contact does not work under it"));
}

TEST(Plan, CountsADecadeOfRates) {
    PlanRequest request;
    request.error = 0.2;
    request.law = "bilin";
    request.of = {Quantity::shape_factor};
    std::string scene = drawn::two_phases;
    scene.replace(scene.find("{ strain = -0.3, rate = 1e-3 }"), 30,
                  "{ strain = -0.2, rate = 1e-3 }, { strain = -0.3, rate = 1e-5 }");
    const Plan plan = planned(drawn::balls({12}, 2), scene, request);
    EXPECT_NEAR(plan.proposal.errors.at(0).parts.rates, 2 * 0.05, 1e-9);
    EXPECT_LE(plan.proposal.error(), 0.2);
}

TEST(Plan, RejectsAnErrorOutOfReachWithTheLeastAndWhatLimitsIt) {
    PlanRequest request;
    request.error = 0.01;
    EXPECT_THAT([&] { planned(drawn::balls({12}, 2), drawn::two_phases, request); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("an error of 1 % is out of reach: the smallest is 2.5 %"),
                                                  HasSubstr("law \"norton\""), HasSubstr("resolution limits it"))));
}

TEST(Plan, RejectsAQuantityThatTheImageDoesNotHave) {
    PlanRequest request;
    request.error = 0.1;
    request.of = {Quantity::pore_volume};
    EXPECT_THAT([&] { planned(drawn::balls({12}, 2), drawn::two_phases, request); },
                ThrowsMessage<InvalidInput>(HasSubstr("pore_volume: the image has no closed pore")));
}

TEST(Plan, OfASceneThatNoLawCanHoldSaysWhyOfEach) {
    PlanRequest request;
    request.error = 0.1;
    request.law = "bilin";
    std::string scene = drawn::two_phases;
    scene.replace(scene.find("-0.3"), 4, "0.3");
    EXPECT_THAT([&] { planned(drawn::balls({12}, 2), scene, request); },
                ThrowsMessage<InvalidInput>(
                    AllOf(HasSubstr("no law can hold scene 'scene.toml': bilin: "), HasSubstr("tension"))));
}

}  // namespace
}  // namespace tomodem::plan
