#include "tools/metrics/fields/control.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem::fields {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* scene_text = R"(
seed_radius = 0.5
[phase.matrix]
label = 1
law = "bilin"
repulsive_stiffness = 5e9
natural_period = 0.1
[load]
axis = "z"
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]
time_step = 5e-4
)";

TEST(ControlNumbers, AreThoseOfTheThesis) {
    EXPECT_DOUBLE_EQ(stiffness_level(6e9, 1e8, 1.5), 40.0);
    EXPECT_DOUBLE_EQ(inertial_number(1e-3, 4e6, 1e8, 4.0), 1e-4);
    EXPECT_DOUBLE_EQ(kinetic_number(8.0, 2.0, 2.0), 0.5);
}

struct ControlFile : InTemporaryFolder {
    std::filesystem::path write(double seed_radius, const std::string& scene = scene_text) {
        const Packing packing = synthetic::sample(synthetic::cube(3, 2.0 * seed_radius), seed_radius);
        const auto path = folder / "run.h5";
        RunWriter writer(packing, path,
                         {.tool = "solve", .version = "0", .command_line = "", .scene = scene, .inputs = {}});
        for (int i = 0; i <= 30; ++i) {
            const auto add = [&](const char* name, const char* unit, double value) {
                writer.add_observable(name, unit, 20000 * i, 10.0 * i, value);
            };
            add("strain", "", -0.01 * i);
            add("stress_true", "Pa", i == 0 ? 0.0 : -1e8);
            add("kinetic_energy", "nJ", 64.0);
            add("potential_energy", "nJ", 32000.0);
        }
        for (int i = 0; i < 3; ++i) writer.add_frame({300000 * i, 150.0 * i, packing.position});
        writer.commit();
        return path;
    }
};

TEST_F(ControlFile, GivesTheConstantsOfTheSceneInTheLengthsOfTheSample) {
    // Ten times smaller particles: forces a hundredth, lengths a tenth; the dimensionless numbers are the same.
    for (const double seed_radius : {0.5, 0.05}) {
        const auto path = write(seed_radius);
        const RunFrames frames(path);
        const auto phases = phase_constants(frames);
        ASSERT_EQ(phases.size(), 1u);
        EXPECT_NEAR(phases[0].stiffness, 5e9 * seed_radius / 0.5, 1.0);
        EXPECT_NEAR(phases[0].mass / phases[0].stiffness, 0.01 / (4.0 * std::numbers::pi * std::numbers::pi), 1e-12);
        const ControlNumbers numbers =
            ControlCurves(path, 0.01).at(200.0, phases, frames.packing().size(), 2.0 * seed_radius);
        EXPECT_NEAR(numbers.rate, 1e-3, 1e-12);
        EXPECT_NEAR(*numbers.min_stiffness_level, 50.0, 1e-9);
        EXPECT_NEAR(*numbers.max_inertial_number, 1e-3 * 0.1 / (2.0 * std::numbers::pi) * std::sqrt(50.0), 1e-12);
        EXPECT_NEAR(*numbers.kinetic_number, 1.0 / (1e8 * std::pow(2.0 * seed_radius, 3)), 1e-18);
        EXPECT_NEAR(*numbers.kinetic_over_elastic, 0.002, 1e-12);
        EXPECT_NEAR(numbers.phases[0].chi, 1e-3 * 0.01 / 5e-4, 1e-12);
    }
}

TEST_F(ControlFile, HasNoNumbersThatDivideByAStressOfZero) {
    const auto path = write(0.5);
    const RunFrames frames(path);
    const ControlNumbers numbers = ControlCurves(path, 0.01).at(0.0, phase_constants(frames), 64, 1.0);
    EXPECT_EQ(numbers.stress, 0.0);
    EXPECT_FALSE(numbers.min_stiffness_level || numbers.max_inertial_number || numbers.kinetic_number);
}

TEST_F(ControlFile, NeedsAScene) {
    const RunFrames frames(write(0.5, ""));
    EXPECT_THAT([&] { phase_constants(frames); }, ThrowsMessage<InvalidInput>(HasSubstr("holds no scene")));
}

TEST_F(ControlFile, ScalesStiffnessAndMassWithTheHardening) {
    std::string scene = scene_text;
    scene.insert(scene.find("[load]"), "hardening = { table = [[0, 1], [300, 4]] }\n");
    const auto path = write(0.5, scene);
    const RunFrames frames(path);
    const ControlNumbers numbers = ControlCurves(path, 0.0).at(300.0, phase_constants(frames), 64, 1.0);
    EXPECT_NEAR(*numbers.min_stiffness_level, 200.0, 1e-9);
    EXPECT_NEAR(*numbers.max_inertial_number, 1e-4 / (2.0 * std::numbers::pi) * std::sqrt(200.0), 1e-12);
}

TEST(DeformedDensity, OfTouchingFccSpheresIsPiOverRoot18) {
    // Shaken a little: a perfect lattice has no one triangulation.
    std::mt19937_64 random(4);
    std::normal_distribution<double> shake(0.0, 0.03);
    std::vector<Vec3> centres;
    const double edge = std::numbers::sqrt2;
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
            for (int k = 0; k < 12; ++k)
                for (const Vec3& place : {Vec3(0, 0, 0), Vec3(.5, .5, 0), Vec3(.5, 0, .5), Vec3(0, .5, .5)})
                    centres.push_back(edge * (Vec3(i, j, k) + place) +
                                      Vec3(shake(random), shake(random), shake(random)));
    const auto found = deformed_density(synthetic::sample(centres));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->density, std::numbers::pi / std::sqrt(18.0), 0.003);
    EXPECT_NEAR(found->volume, double(centres.size()) * std::pow(edge, 3) / 4.0, 0.004 * found->volume);
}

TEST(FlowEnergy, OfACubeIsThatOfTheUniformFlow) {
    // Velocities rate (-x/2, -y/2, z): a cube of edge L has 1/2 m N rate^2 L^2 / 12 (1 + 1/4 + 1/4).
    const auto points = synthetic::cube(20, 0.1);
    const std::vector<PhaseConstants> phases{{1, 1.0, 3.0, 0.0, 1.0, {}}};
    const double n = double(points.size()), square = 0.01 * 20 * 22 / 12.0;  // of 21 equidistant places
    EXPECT_NEAR(flow_energy(points, std::vector<std::int32_t>(points.size(), 1), 0, 2.0, phases, 0.0),
                0.5 * 3.0 * n * 4.0 * square * 1.5, 1e-6);
}

using FramesFile = InTemporaryFolder;

TEST_F(FramesFile, KnowTheBoxThatPeriodicSidesHaveNow) {
    const auto path = folder / "run.h5";
    Packing packing = synthetic::sample(synthetic::cube(5, 1.0));
    for (const bool lateral : {false, true}) {
        packing.box.periodic = {!lateral, !lateral, !lateral};  // neither is what the scene says
        std::string scene = scene_text;
        if (lateral) scene.insert(scene.find("axis"), "lateral = \"periodic\"\n");
        RunWriter writer(packing, path,
                         {.tool = "solve", .version = "0", .command_line = "", .scene = scene, .inputs = {}});
        const double section = packing.box.edges.x() * packing.box.edges.y();
        for (int i = 0; i < 2; ++i) {
            writer.add_observable("strain", "", i, i, -0.2 * i);
            writer.add_observable("section", "mm^2", i, i, section * (1.0 + 0.44 * i));
            writer.add_frame({i, double(i), packing.position});
        }
        writer.commit();
        const RunFrames frames(path);
        const Box box = frames.box(1);
        EXPECT_EQ(box.periodic, (std::array<bool, 3>{lateral, lateral, false}));
        const double growth = lateral ? 1.2 : 1.0;
        EXPECT_NEAR(box.edges.x(), growth * packing.box.edges.x(), 1e-12);
        EXPECT_NEAR(box.edges.z(), packing.box.edges.z(), 1e-12);
        EXPECT_NEAR((box.origin + 0.5 * box.edges - packing.box.origin - 0.5 * packing.box.edges).norm(), 0.0, 1e-12);
    }
}

}  // namespace
}  // namespace tomodem::fields
