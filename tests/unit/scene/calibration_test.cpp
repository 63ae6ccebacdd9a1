#include "core/scene/calibration.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/scene/expected_flow.hpp"
#include "core/scene/laws/bilin.hpp"
#include "core/scene/laws/norton.hpp"
#include "core/scene/laws/trilin.hpp"
#include "core/scene/model.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string table = R"([calibration]
format = 1
name = "mine"
[calibration.bilin]
chi = [0.1, 1, 10]
flow = [0.02, 0.04, 0.08]
spread = [0.01, 0.02, 0.04]
greatest_sensitivity = 0.33
strain_per_step = [1e-6, 1e-4]
time_step_error = [0.01, 0.01, 0.01]
packings = 3
density = 0.7
crown = 1.5
stiffness_ratio = 10
particles = [100, 10000]
size = [0, 0.1]
strain = [0.2, 0.5]
strain_error = 0.1
)";

const std::string scene_text = R"([phase.a]
label = 1
law = "bilin"
norton = { K = 1000, M = 0.3 }
[load]
steps = [ { strain = -0.4, rate = 1e-2 } ]
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

Packing cloud(std::size_t count) {
    Packing sample;
    sample.seed_radius = 0.5;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t row = k / 10, layer = row / 10;
        sample.position.push_back({double(k % 10), double(row % 10), double(layer)});
        sample.species.push_back(1);
        sample.id.push_back(std::int64_t(k + 1));
    }
    sample.box.edges = {10, 10, double(count) / 100};
    return sample;
}

TEST(Calibration, ThatShipsHoldsEveryLaw) {
    const Calibration& shipped = shipped_calibration();
    for (const Law* law : laws()) ASSERT_TRUE(shipped.tables.contains(law->name()));
    EXPECT_EQ(shipped.find<NortonCalibration>()->flow, 0.988);
    // The thesis' calibration of TRILIN: K = 49.1 MPa.s^M for k_rep = 1.42e9 uN/mm, r_s = 0.5 mm, t0 = 1 s.
    EXPECT_NEAR(shipped.find<TrilinCalibration>()->flow.at(1) * 1.42e9, 49.1e6, 1);
}

TEST(Calibration, OfASceneGivesItsConstants) {
    // Both curves are straight in a log-log plot: here M = log10(2) everywhere.
    const Scene scene = parse_scene(scene_text + table, "s.toml");
    const Packing sample = cloud(1000);
    const Model model = compile_model(scene, sample);
    const PhaseModel& phase = model.phases.front();
    const double stress = 1000e6 * std::pow(1e-2, 0.3);
    EXPECT_NEAR(phase.pair.repulsive_stiffness * 0.04 * std::pow(phase.chi, std::log10(2.0)), stress, 1e-6 * stress);
    EXPECT_NE(phase.pair.repulsive_stiffness,
              compile_model(parse_scene(scene_text, "s.toml"), sample).phases.front().pair.repulsive_stiffness);
}

TEST(Calibration, SaysTheErrorToExpectAndItsWindow) {
    const Scene scene = parse_scene(scene_text + "[accuracy]\nstrain_per_step = 1e-5\n" + table, "s.toml");
    const Packing sample = cloud(1000);
    const Model model = compile_model(scene, sample);
    const ExpectedFlow found = expected_flows(scene, static_cast<std::int64_t>(sample.size()), model).at(0);
    EXPECT_EQ(found.phase, "a");
    EXPECT_NEAR(found.stress, 1000e6 * std::pow(1e-2, 0.3), 1);
    EXPECT_NEAR(found.size, 0.05, 1e-12) << "half way between 100 and 10,000 particles in the logarithm";
    EXPECT_NEAR(found.packings, 2 * scene.calibration->find<BilinCalibration>()->spread_at(model.phases[0].chi), 1e-12);
    EXPECT_NEAR(found.rates, std::abs(0.5 * std::pow(10, 0.3) - 1), 1e-3) << "a slope of 0.301 instead of 0.3";
    EXPECT_NEAR(found.error,
                std::sqrt(std::pow(found.size, 2) + std::pow(found.packings, 2) + std::pow(found.rates, 2) + 1e-4),
                1e-12);
    EXPECT_NEAR(found.rate[0], 1e-3, 1e-12);
    EXPECT_THAT(found.outside, testing::IsEmpty());
}

TEST(Calibration, NamesWhatIsOutsideOfIt) {
    const auto outside = [](const std::string& scene, std::size_t particles) {
        const Scene read = parse_scene(scene + table, "s.toml");
        const Packing sample = cloud(particles);
        return expected_flows(read, static_cast<std::int64_t>(sample.size()), compile_model(read, sample))
            .at(0)
            .outside;
    };
    EXPECT_THAT(outside(scene_text, 50), testing::ElementsAre("50 particles, measured with 100 to 10000"));
    EXPECT_THAT(outside(with(scene_text, "-0.4", "-0.6"), 1000), testing::ElementsAre(HasSubstr("strain 0.6")));
    EXPECT_THAT(outside(with(scene_text, "-0.4", "-0.1"), 1000),
                testing::ElementsAre(HasSubstr("strain 0.1: the stress has risen")));
    EXPECT_THAT(outside("crown_radius = 0.8\n" + scene_text, 1000),
                testing::ElementsAre(HasSubstr("a crown of 1.6 seed radii")));
    EXPECT_THAT(outside(with(scene_text, "M = 0.3 }", "M = 0.3 }\nstiffness_ratio = 5"), 1000),
                testing::ElementsAre("stiffness_ratio 5, measured with 10"));
    EXPECT_THAT(
        outside(with(scene_text, "-0.4, rate = 1e-2", "-0.2, rate = 1e-2 }, { strain = -0.4, rate = 1e-4"), 1000),
        testing::ElementsAre(HasSubstr("the rate falls to 0.0001 /s")));
}

TEST(Calibration, TellsTensionFromCompression) {
    const Packing sample = cloud(2000);
    const auto expected = [&](const std::string& strain) {
        const Scene scene = parse_scene(
            "[phase.a]\nlabel = 1\nlaw = \"trilin\"\nnorton = { K = 49.1, M = 0.0714 }\n[load]\nsteps = [ { strain = " +
                strain + ", rate = 1e-3 } ]",
            "s.toml");
        return expected_flows(scene, static_cast<std::int64_t>(sample.size()), compile_model(scene, sample)).at(0);
    };
    const TrilinCalibration& shipped = *shipped_calibration().find<TrilinCalibration>();
    EXPECT_NEAR(expected("-0.3").error, std::hypot(*shipped.error.compression, 0.04), 1e-9);
    EXPECT_NEAR(expected("0.3").error, std::hypot(*shipped.error.tension, 0.04), 1e-9);
    EXPECT_THAT(expected("-0.8").outside, testing::IsEmpty());
    EXPECT_THAT(expected("0.8").outside, testing::ElementsAre(HasSubstr("strain 0.8")));
}

TEST(Calibration, NeedsNoneForConstantsThatAreGiven) {
    const Scene scene = parse_scene(
        with(scene_text, "norton = { K = 1000, M = 0.3 }", "repulsive_stiffness = 1e9\nnatural_period = 0.1"),
        "s.toml");
    const Packing sample = cloud(1000);
    EXPECT_THAT(expected_flows(scene, static_cast<std::int64_t>(sample.size()), compile_model(scene, sample)),
                testing::IsEmpty());
}

TEST(Calibration, RefusesWhatItDoesNotHold) {
    const Packing sample = cloud(1000);
    const auto compile = [&](const std::string& text) { compile_model(parse_scene(text, "s.toml"), sample); };
    EXPECT_THAT([&] { compile(with(scene_text, "bilin", "norton") + table); },
                ThrowsMessage<InvalidInput>(
                    HasSubstr("line 1: [phase.a] has law \"norton\", which the calibration 'mine' does not hold")));
    EXPECT_THAT([&] { compile(with(scene_text, "M = 0.3", "M = 0.8")); },
                ThrowsMessage<InvalidInput>(HasSubstr("law \"norton\" can, for any M up to 1")));
    EXPECT_THAT([&] { compile(with(with(scene_text, "M = 0.3", "M = 0.8"), "bilin", "trilin")); },
                ThrowsMessage<InvalidInput>(HasSubstr("law \"norton\" can, for any M up to 1")));
}

TEST(Calibration, RefusesATableThatIsWrongWithItsLine) {
    const auto refused = [](const std::string& from, const std::string& to, const std::string& message) {
        EXPECT_THAT([&] { parse_calibration(with(table, from, to), "t.toml"); },
                    ThrowsMessage<InvalidInput>(HasSubstr(message)));
    };
    refused("[0.1, 1, 10]", "[0.1, 10, 1]", "calibration 't.toml' line 5: chi in [calibration.bilin] must rise");
    refused("[0.02, 0.04, 0.08]", "[0.02, 0.04]", "line 6: flow in [calibration.bilin] must be a list of 3 numbers");
    refused("[0.02, 0.04, 0.08]", "[0.02, 0.04, 0]", "line 6: flow of the master curve must be above 0");
    refused("density", "densty", "[calibration.bilin] has no 'density'");
    refused("packings = 3", "packings = 3\npaking = 2", "line 12: unknown key 'paking' in [calibration.bilin]");
    refused("format = 1", "format = 2", "line 2: format is another than 1");
    refused("[0.2, 0.5]", "[0.5, 0.2]", "strain in [calibration.bilin] must be [smallest, largest]");
    EXPECT_THAT([] { parse_calibration("a = 1", "t.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr("has no table [calibration]")));
}

}  // namespace
}  // namespace tomodem
