#include "tools/plan/sample_plan.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "tests/unit/plan/drawn.hpp"

namespace tomodem::plan {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

SamplePlan planned(const LabelVolume& volume, const SampleRequest& request, const std::string& scene = "") {
    std::optional<Scene> given;
    if (!scene.empty()) given = parse_scene(scene, "scene.toml");
    return plan_sample(volume, solid_labels(volume), request, given, scene);
}

SampleRequest particles(double number) {
    return {.particles = number, .pixels_per_seed = {}, .names = {}};
}

SampleRequest pixels(double radius) {
    return {.particles = {}, .pixels_per_seed = radius, .names = {}};
}

TEST(SamplePlan, GivesTheParticlesTheSizeForTheNumberWanted) {
    const SamplePlan plan = planned(drawn::balls({12, 12}, 2), particles(5000));
    const double volume = 60.0 * 60 * 60;
    const double radius = std::cbrt(volume * 0.7 / 5000 * 3 / (4 * std::numbers::pi));
    EXPECT_NEAR(plan.pixels_per_seed, radius, 0.005);  // rounded to hundredths
    EXPECT_NEAR(plan.particles, 5000, 30);
    EXPECT_DOUBLE_EQ(plan.seed_radius, plan.pixels_per_seed * drawn::voxel);
    EXPECT_DOUBLE_EQ(plan.probe_radius, 1.6 * plan.seed_radius);
}

TEST(SamplePlan, TakesTheLabelWithMostVoxelsAsMatrixAndTheOthersAsObjects) {
    const SamplePlan plan = planned(drawn::balls({12, 12}, 2), particles(5000));
    EXPECT_THAT(plan.names, ElementsAre(Pair(1, "matrix"), Pair(2, "inclusion")));
    EXPECT_THAT(plan.objects, ElementsAre(2));
    EXPECT_EQ(plan.shown, 2);
    const Scene scene = parse_scene(plan.load.scene, "made");
    EXPECT_TRUE(scene.phase(2).objects);
    EXPECT_FALSE(scene.phase(1).objects);
    EXPECT_NEAR(scene.phase(1).norton->stress(1e-3), 100, 1);
    EXPECT_EQ(scene.scheme, Scheme::quasi_static);
    EXPECT_DOUBLE_EQ(scene.steps.at(0).strain, -0.3);
    const auto options = sample_options(plan);
    EXPECT_EQ(options.at("vol2pack"),
              "--pixels-per-seed 1.93 --labels 1=matrix,2=inclusion --objects 2 --min-component 44");
    EXPECT_EQ(load_options(plan.load).at("press"), "--press z");
    EXPECT_EQ(load_options(plan.load).at("equilibrium"), "--from 0.2");
}

TEST(SamplePlan, KeepsTheSceneOfTheUserWithItsNamesAxisAndStrain) {
    std::string scene = drawn::two_phases;
    scene.replace(scene.find("steps"), 0, "axis = \"x\"\n");
    scene.replace(scene.find("-0.3"), 4, "-0.12");
    const SamplePlan plan = planned(drawn::balls({12, 12}, 2), particles(5000), scene);
    EXPECT_EQ(plan.load.scene, scene);
    EXPECT_THAT(plan.names, ElementsAre(Pair(1, "a"), Pair(2, "b")));
    EXPECT_EQ(load_options(plan.load).at("press"), "--press x");
    EXPECT_EQ(load_options(plan.load).at("equilibrium"), "--from 0.08");
}

TEST(SamplePlan, TakesLooseBitsOutOfAPorousImageAlone) {
    const auto ball = [](double radius, std::int32_t void_label) {
        return drawn::volume(
            40, [=](const Vec3& at) { return (at - Vec3::Constant(20)).norm() < radius ? 1 : void_label; });
    };
    const double of_particle = 4 / 3.0 * std::numbers::pi * 8 / 0.7;
    EXPECT_EQ(planned(ball(18, 0), pixels(2)).min_component, std::ceil(20 * of_particle));
    EXPECT_EQ(planned(ball(40, 0), pixels(2)).min_component, std::ceil(of_particle));
    EXPECT_EQ(sample_options(planned(ball(18, 0), pixels(2))).at("inclusions"), "--only-species 1 --color phase");
}

TEST(SamplePlan, RefusesWhatDoesNotFitTheImage) {
    const LabelVolume volume = drawn::balls({12, 12}, 2);
    const auto refused = [&](const SampleRequest& request, const std::string& scene, const std::string& message) {
        EXPECT_THAT([&] { planned(volume, request, scene); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
    };
    refused(pixels(9), "",
            "the largest inclusion would have 2 particles, too few to have a shape; give --pixels-per-seed 1.95 or "
            "less (now 9)");
    SampleRequest named = particles(5000);
    named.names = {{1, "matrix"}};
    refused(named, "", "--labels does not name label 2");
    named.names = {{1, "matrix"}, {2, "inclusion"}, {5, "pore"}};
    refused(named, "", "--labels names label 5 (pore), which the image does not have");
    refused(particles(5000), drawn::one_phase, "no phase with label 2, which the image has");
    EXPECT_THAT([] { solid_labels(drawn::volume(20, [](const Vec3& at) { return int(at[0]); })); },
                ThrowsMessage<InvalidInput>(HasSubstr("the image has 20 different values: if it is grey")));
    EXPECT_THAT([] { solid_labels(drawn::volume(20, [](const Vec3&) { return 0; })); },
                ThrowsMessage<InvalidInput>(HasSubstr("all void")));
}

}  // namespace
}  // namespace tomodem::plan
