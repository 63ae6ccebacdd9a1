#include "solver_plugin/run/solver.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "core/base/error.hpp"
#include "core/packing/packing_file.hpp"
#include "solver_plugin/run/guards.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string phase_a = R"(
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 0.1
)";

/// A cube of n^3 particles on a lattice that is slightly compressed and slightly shaken.
Packing block(int n, double seed_radius = 0.5) {
    Packing packing;
    packing.seed_radius = seed_radius;
    const double spacing = 1.96 * seed_radius;
    packing.box.edges = Vec3::Constant(n * spacing);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                const Vec3 shake = Vec3(std::sin(7 * i + 3 * j), std::sin(5 * j + 2 * k), std::sin(11 * k + i));
                packing.position.push_back(spacing * Vec3(i + 0.5, j + 0.5, k + 0.5) + 0.05 * seed_radius * shake);
                packing.species.push_back(1);
                packing.id.push_back(static_cast<std::int64_t>(packing.id.size()) + 1);
            }
    return packing;
}

Scene scene(const std::string& load, const std::string& accuracy = "") {
    return parse_scene(phase_a + "[load]\n" + load + "\n[accuracy]\n" + accuracy, "test");
}

class Solve : public InTemporaryFolder {};

TEST(Relax, KeepsEveryParticleAndItsOrder) {
    Packing sample = block(6);
    for (std::size_t i = 0; i < sample.size(); ++i) sample.radius.push_back(0.49 + 0.01 * static_cast<double>(i % 3));
    const Relaxation result =
        come_to_rest(sample, scene("steps = [ { strain = -0.1, rate = 1e-3 } ]"), {}, MPI_COMM_WORLD);
    ASSERT_EQ(result.sample.size(), sample.size());
    EXPECT_TRUE(result.sample.relaxed);
    EXPECT_EQ(result.sample.id, sample.id);
    EXPECT_EQ(result.sample.radius, sample.radius);
    EXPECT_LT(result.largest_displacement, 2);
    EXPECT_LT(result.residual_energy, 1e-4);
}

TEST(Relax, EndsWithinItsLimitsAndThenNothingMovesAnyMore) {
    const Packing sample = packgen::compact({.particles = 400, .density = 0.7}).packing;
    const Scene press = scene("steps = [ { strain = -0.1, rate = 1e-3 } ]");
    const Relaxation first = come_to_rest(sample, press, {}, MPI_COMM_WORLD);
    EXPECT_TRUE(first.at_rest);
    EXPECT_LE(first.energy_ratio, 1e-5);
    EXPECT_LE(first.force_balance, 1e-3);
    EXPECT_GT(first.periods, 5);
    EXPECT_GT(first.largest_displacement, 0.1);
    const Relaxation again = come_to_rest(first.sample, press, {}, MPI_COMM_WORLD);
    EXPECT_LT(again.largest_displacement, 0.1 * first.largest_displacement);
}

/// Keeps the warnings.
class Warnings final : public Reporter {
 public:
    std::string text;

    void report(const std::string&, double, const std::string&) override {}
    void report(const std::string&, std::int64_t, const std::string&) override {}
    void report(const std::string&, const std::string&) override {}
    void report_json(const std::string&, const nlohmann::ordered_json&) override {}
    void note(const std::string&) override {}
    void warn(const std::string& line) override { text += line + '\n'; }
    std::unique_ptr<Progress> progress(const std::string& label, double total) override {
        return silent_reporter().progress(label, total);
    }
};

TEST(Relax, EndsAtItsCapAndSaysThatItIsNotAtRest) {
    const Packing sample = packgen::compact({.particles = 400, .density = 0.7}).packing;
    const Scene press = scene("steps = [ { strain = -0.1, rate = 1e-3 } ]");
    Warnings reporter;
    const Relaxation result = come_to_rest(sample, press, {.max_periods = 2}, MPI_COMM_WORLD, reporter);
    EXPECT_THAT(reporter.text, testing::HasSubstr("not at rest after 2 natural periods"));
    EXPECT_FALSE(result.at_rest);
    EXPECT_NEAR(result.periods, 2, 0.2);
    EXPECT_GT(result.energy_ratio, 1e-5);
    EXPECT_GT(result.force_balance, 1e-3);
}

TEST(ForceBalance, OfThreeOverlappingSeedsInARowIsThatOfTheirForces) {
    Packing row;
    row.box = {Vec3(-1, -1, -2), Vec3(2, 2, 4), {false, false, false}};
    row.seed_radius = 0.5;
    row.position = {Vec3(0, 0, -0.9), Vec3(0, 0, 0), Vec3(0, 0, 0.9)};
    row.species = {1, 1, 1};
    row.id = {1, 2, 3};
    const Model model = compile_model(scene("steps = [ { strain = -0.1, rate = 1e-3 } ]"), row);
    plugin::Simulation simulation(row, model, 2, MPI_COMM_WORLD);
    simulation.begin_relaxation();
    const plugin::ForceBalance forces = simulation.force_balance();
    // The ends are pushed out by f, the middle one is pushed from both sides: loads f, 2 f, f.
    EXPECT_NEAR(forces.net / forces.load, std::sqrt(2.0 / 3) / (4.0 / 3), 1e-6);
}

TEST_F(Solve, WritesFramesAndCurvesUpToTheTargetStrain) {
    const auto file = folder / "run.h5";
    const Scene press = scene("steps = [ { strain = -0.05, rate = 1e-2 } ]",
                              "strain_per_step = 5e-5\nframes = 5\ntime_step = \"auto\"");
    const RunResult result = solve(block(6), press, file, {}, MPI_COMM_WORLD);
    EXPECT_EQ(result.particles_lost, 0);
    EXPECT_NEAR(result.final_strain, -0.05, 1e-12);
    EXPECT_GT(result.cost.steps, 20 + 1000);  // relaxation, then 0.05 / 5e-5
    const RunReader run(file);
    EXPECT_EQ(run.frame_count(), 6u);
    EXPECT_EQ(run.frame_step(5), 1000);
    EXPECT_NEAR(run.frame_time(5), 5, 1e-9);
    const Observable& strain = run.observable("strain");
    EXPECT_EQ(strain.value.size(), 51u);  // at rest, and every tenth of the window
    const Vec3 first = run.frame(0).position.back(), last = run.frame(5).position.back();
    EXPECT_LT((last - first).z(), -0.05) << "the top layer did not move down";
    // Centred: both planes move.
    EXPECT_GT((run.frame(5).position.front() - run.frame(0).position.front()).z(), 0.05);
    const Observable& section = run.observable("section");
    EXPECT_NEAR(section.value.back(), std::pow(6 * 0.98, 2) * std::exp(0.05), 1e-9);
}

TEST_F(Solve, GivesTheSameStressForASampleOfAnotherSize) {
    const auto file = folder / "scaled.h5";
    const Scene press = scene("steps = [ { strain = -0.03, rate = 1e-2 } ]", "strain_per_step = 5e-5");
    const double large = solve(block(5, 0.5), press, file, {}, MPI_COMM_WORLD).final_stress;
    const double small = solve(block(5, 0.012), press, file, {}, MPI_COMM_WORLD).final_stress;
    EXPECT_LT(large, -1e6);
    // Round-off grows in a chaotic packing: equal for a while, not to the last digit.
    EXPECT_NEAR(small / large, 1, 1e-2);
}

TEST_F(Solve, PressesAlongTheAxisOfTheScene) {
    const auto file = folder / "axis.h5";
    const Scene press = scene("axis = \"x\"\nsteps = [ { strain = -0.4, rate = 1e-2 } ]", "strain_per_step = 5e-5");
    // A dense random packing: a lattice would compact sideways too.
    solve(packgen::compact({.particles = 500, .density = 0.7}).packing, press, file, {}, MPI_COMM_WORLD);
    const RunReader run(file);
    // Root mean square distance from the middle: unlike the outermost particles, it does not depend on rough faces.
    const auto extent = [&](std::size_t frame) {
        const std::vector<Vec3> points = run.frame(frame).position;
        Vec3 middle = Vec3::Zero(), squares = Vec3::Zero();
        for (const Vec3& point : points) middle += point / static_cast<double>(points.size());
        for (const Vec3& point : points) squares += (point - middle).cwiseAbs2() / static_cast<double>(points.size());
        return Vec3(squares.cwiseSqrt());
    };
    // The second half: first the planes flatten the rough faces.
    const Vec3 before = extent(15), after = extent(run.frame_count() - 1);
    EXPECT_NEAR(std::log(after.x() / before.x()), -0.2, 0.03);
    EXPECT_GT(after.y(), before.y());
    EXPECT_GT(after.z(), before.z());
}

TEST_F(Solve, StopsWithAReasonWhenThePackingFallsApart) {
    const auto file = folder / "apart.h5";
    const Scene violent = scene("steps = [ { strain = -1, rate = 5 } ]", "time_step = 5e-3");
    EXPECT_THAT([&] { solve(block(6), violent, file, {}, MPI_COMM_WORLD); },
                ThrowsMessage<InvalidInput>(HasSubstr("falls apart at strain")));
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Model, TakesTheFlowStressOfNortonAtTheScenesRate) {
    const Packing sample = block(3);
    const Scene norton = parse_scene(R"([phase.a]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ])",
                                     "test");
    const Model model = compile_model(norton, sample);
    // On the plateau sigma = 0.0150 k_rep / 2 r_s; the thesis' phase A has k_rep = 6.23e9.
    EXPECT_NEAR(model.phases[0].pair.repulsive_stiffness, 94.29e6 / 0.0150, 0.01 * 6.3e9);
    EXPECT_DOUBLE_EQ(model.time_step, 5e-6 / 1e-3);
    EXPECT_NEAR(model.phases[0].natural_period, 20 * model.time_step, 1e-12);
}

TEST(Model, RefusesWhatTheSampleDoesNotHave) {
    Packing sample = block(3);
    const Scene one_phase = scene("steps = [ { strain = -0.1, rate = 1e-3 } ]");
    sample.species[5] = 7;
    EXPECT_THAT([&] { compile_model(one_phase, sample); },
                ThrowsMessage<InvalidInput>(HasSubstr("no phase with label 7")));
    sample.species.assign(sample.size(), 7);
    EXPECT_THAT([&] { compile_model(one_phase, sample); },
                ThrowsMessage<InvalidInput>(HasSubstr("line 2: [phase.a] has no particle")));
}

TEST(Model, RefusesToDrawRadiiForASampleThatHasItsOwn) {
    Packing sample = block(3);
    sample.radius.assign(sample.size(), 0.5);
    const std::string load = "[load]\nsteps = [ { strain = -0.1, rate = 1e-3 } ]";
    EXPECT_THAT([&] { compile_model(parse_scene("radius_dispersion = 0.1\n" + phase_a + load, "test"), sample); },
                ThrowsMessage<InvalidInput>(
                    HasSubstr("radius_dispersion = 0.1 but the particles of the sample have radii of their own")));
    EXPECT_NO_THROW(compile_model(parse_scene(phase_a + load, "test"), sample));
    const Scene norton =
        parse_scene("[phase.a]\nlabel = 1\nlaw = \"norton\"\nnorton = { K = 100, M = 0.3 }\n" + load, "test");
    EXPECT_THAT([&] { compile_model(norton, sample); },
                ThrowsMessage<InvalidInput>(HasSubstr("law \"norton\" is made for equal radii")));
}

TEST(Model, RefusesATimeStepThatIsUnstable) {
    const Scene coarse = scene("steps = [ { strain = -0.1, rate = 1e-3 } ]", "time_step = 0.02");
    EXPECT_THAT([&] { compile_model(coarse, block(3)); }, ThrowsMessage<InvalidInput>(HasSubstr("unstable")));
}

TEST(CompileModel, KeepsTheInertiaBelowTheEquilibriumErrorAskedFor) {
    const auto compiled = [](const std::string& phase, double error) {
        return compile_model(
            parse_scene(fmt::format("[phase.a]\nlabel = 1\nlaw = \"bilin\"\n{}\n[load]\nsteps = [ {{ "
                                    "strain = -0.1, rate = 1e-3 }} ]\n[accuracy]\nmax_equilibrium_error = {}",
                                    phase, error),
                        "test"),
            block(3));
    };
    for (const double error : {1e-3, 1e-2}) {
        const Model viscous = compiled("norton = { K = 5020, M = 0.4 }", error);
        EXPECT_NEAR(0.7 * 1e-3 * viscous.phases[0].natural_period, error, 1e-6 * error);
        const Model plastic = compiled("norton = { K = 95.9, M = 2e-3 }", error);
        EXPECT_NEAR(60 * 1e-3 * plastic.time_step, error, 1e-6 * error);
    }
    EXPECT_THAT([&] { compiled("repulsive_stiffness = 1e9\nnatural_period = 5", 1e-3); },
                ThrowsMessage<InvalidInput>(HasSubstr("give a shorter one")));
}

/// Two particles at that height [seed diameters].
Packing column(double height) {
    Packing sample;
    sample.seed_radius = 0.25;
    sample.box.edges = Vec3(1, 1, 0.5 * (height + 1));
    sample.position = {Vec3(0.5, 0.5, 0.25), Vec3(0.5, 0.5, 0.25 + 0.5 * height)};
    sample.species = {1, 1};
    sample.object = {1, 1};
    sample.id = {1, 2};
    return sample;
}

Scene quasi_static(const std::string& load, const std::string& accuracy = "", const std::string& rest = "") {
    return parse_scene("[phase.a]\nlabel = 1\nlaw = \"norton\"\nnorton = { K = 100, M = 0.3 }\n" + rest + "[load]\n" +
                           load + "\n[accuracy]\n" + accuracy,
                       "test");
}

const std::string tool = "[[wall]]\nname = \"tool\"\nsurface = \"t.stl\"\n";

TEST(CompileModel, OfQuasiStaticStepsGoesByTheStrainWhateverTheHeight) {
    const std::string load = "steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = 1e-2 } ]";
    const Model model = compile_model(quasi_static(load), column(20));
    EXPECT_EQ(model.scheme, Scheme::quasi_static);
    EXPECT_DOUBLE_EQ(model.strain_per_step, 8e-3);
    EXPECT_DOUBLE_EQ(model.time_step, 0.8) << "at the highest rate";
    EXPECT_DOUBLE_EQ(model.imbalance, 1e-2);
    EXPECT_EQ(relaxation_steps(model, 20), 20);
    EXPECT_DOUBLE_EQ(model.law->relaxation_time_step(model), 0.3) << "a strain of 0.003";
    Scene explicit_steps = quasi_static(load);
    explicit_steps.scheme = Scheme::explicit_steps;
    const Model other = compile_model(explicit_steps, column(20));
    // Masses are for energies alone: a tall sample must not be taken for one that moves less.
    EXPECT_LT(other.phases[0].mass, model.phases[0].mass);
    EXPECT_EQ(compile_model(quasi_static(load), column(200)).phases[0].mass, model.phases[0].mass);
    EXPECT_EQ(other.law->evaluations(other, 50), 50);
    EXPECT_LT(other.time_step, 1e-2 * model.time_step);
    EXPECT_EQ(other.law->relaxation_time_step(other), other.time_step);

    const Model given = compile_model(quasi_static(load, "strain_per_step = 2e-3\nmax_imbalance = 1e-3\n"), column(20));
    EXPECT_DOUBLE_EQ(given.strain_per_step, 2e-3);
    EXPECT_DOUBLE_EQ(given.imbalance, 1e-3);
    EXPECT_THAT(
        given.law->time_step_reason(quasi_static(load, "strain_per_step = 2e-3\nmax_imbalance = 1e-3\n"), given),
        testing::AllOf(HasSubstr("0.002 in a step (given)"), HasSubstr("force balance of 0.001")));
}

TEST_F(Solve, CountsTheEvaluationsOfAQuasiStaticLoadStepByStep) {
    const auto evaluations = [&](const Scene& scene, bool relaxed) {
        Packing sample = block(5);
        sample.relaxed = relaxed;
        return solve(sample, scene, folder / "run.h5", {}, MPI_COMM_WORLD).cost.evaluations;
    };
    const std::string load = "steps = [ { strain = -0.04, rate = 1e-3 } ]";
    const Scene five = quasi_static(load, "strain_per_step = 8e-3\n");
    const std::int64_t counted = evaluations(five, true);
    const std::vector<double> curve = RunReader(folder / "run.h5").observable("evaluations").value;
    ASSERT_EQ(curve.size(), 6u);
    EXPECT_EQ(curve[0], 0);
    // Geometry and forces of a step that is in balance as it begins; blocks, one product and forces of any other.
    for (std::size_t k = 1; k < curve.size(); ++k) EXPECT_GE(curve[k], 2) << k;
    EXPECT_EQ(static_cast<double>(counted), std::accumulate(curve.begin(), curve.end(), 0.0));
    EXPECT_GT(evaluations(quasi_static(load, "strain_per_step = 8e-3\nmax_imbalance = 1e-3\n"), true), 1.5 * counted);
    EXPECT_LT(evaluations(five, false), 2 * counted) << "those of the relaxation do not count";
    EXPECT_GT(come_to_rest(block(5), five, {}, MPI_COMM_WORLD).cost.evaluations, 20);

    Scene explicit_steps = five;
    explicit_steps.scheme = Scheme::explicit_steps;
    explicit_steps.strain_per_step.reset();
    explicit_steps.steps.front().strain = -1e-4;
    EXPECT_EQ(evaluations(explicit_steps, true), 0);
    EXPECT_THROW(RunReader(folder / "run.h5").observable("evaluations"), InvalidInput);
}

/// Counted by bench/norton to strain 0.3: means of two or three packings, or one.
TEST(CompileModel, ForeseesTheEvaluationsOfAQuasiStaticLoadWithinThirtyPercent) {
    struct Count {
        std::string exponent;
        double particles, steps, evaluations;
        std::string accuracy;
    };
    const Count counts[] = {
        {"0.03", 2000, 38, 598, ""},
        {"0.3", 2000, 38, 581, ""},
        {"1", 2000, 38, 583, ""},
        {"0.03", 10000, 38, 590, ""},
        {"0.5", 10000, 38, 578, ""},
        {"1", 10000, 38, 580, ""},
        {"0.3", 50000, 38, 591, ""},
        {"0.3", 2000, 38, 414, "max_imbalance = 3e-2\n"},
        {"0.3", 10000, 38, 367, "max_imbalance = 3e-2\n"},
        {"0.3", 2000, 38, 1186, "max_imbalance = 1e-3\n"},
        {"0.3", 10000, 38, 1119, "max_imbalance = 1e-3\n"},
        {"0.3", 10000, 75, 962, "strain_per_step = 4e-3\n"},
        {"0.3", 2000, 15, 279, "strain_per_step = 2e-2\n"},
        {"0.3", 2000, 150, 1707, "strain_per_step = 2e-3\n"},
    };
    for (const Count& count : counts) {
        const Scene scene =
            parse_scene("[phase.a]\nlabel = 1\nlaw = \"norton\"\nnorton = { K = 100, M = " + count.exponent +
                            " }\n[load]\nsteps = [ { strain = -0.3, rate = 1e-3 } ]\n"
                            "[accuracy]\n" +
                            count.accuracy,
                        "test");
        const Model model = compile_model(scene, column(20));
        EXPECT_NEAR(model.law->evaluations(model, count.steps) / count.evaluations, 1, 0.3)
            << count.exponent << " " << count.particles << " " << count.steps << " " << count.accuracy;
    }
}

TEST(CompileModel, OfQuasiStaticStepsLimitsTheWayOfThePlanes) {
    const std::string load = "steps = [ { strain = -0.1, rate = 1e-3 } ]";
    const auto way = [](const Scene& scene, double height) {
        const Model model = compile_model(scene, column(height));
        double highest = 0;
        for (const LoadStep& step : scene.steps) highest = std::max(highest, step.strain);
        return model.strain_per_step * height * std::exp(highest) / 2;
    };
    EXPECT_NEAR(way(quasi_static(load), 200), 0.35, 1e-9);
    EXPECT_NEAR(way(quasi_static("steps = [ { strain = 1, rate = 1e-3 } ]"), 200), 0.35, 1e-9);
    EXPECT_NEAR(way(quasi_static(load, "", tool), 50), 0.1, 1e-9);
    EXPECT_NEAR(way(quasi_static(load, "", "[contact]\nobjects_only_push = true\n"), 50), 0.1, 1e-9);
    EXPECT_NEAR(way(quasi_static(load, "", tool), 10), 8e-3 * 10 / 2, 1e-9);
}

TEST(Guards, RefuseAQuasiStaticStepInWhichPlanesOrWallsJumpOverParticles) {
    const std::string load = "steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = 1 } ]";
    const auto check = [](const Scene& scene, double height) {
        Warnings reporter;
        const Packing sample = column(height);
        check_plane_speed(scene, compile_model(scene, sample), sample, reporter);
        return reporter.text;
    };
    EXPECT_EQ(check(quasi_static(load), 200), "") << "the default is good";
    EXPECT_EQ(check(quasi_static(load, "strain_per_step = 0.0074\n"), 100), "");
    EXPECT_THAT([&] { check(quasi_static(load, "strain_per_step = 0.0076\n"), 100); },
                ThrowsMessage<InvalidInput>(HasSubstr(
                    "the planes move by 0.51 crown radii in one step, at most 0.5; take a smaller strain_per_step")));
    // 8 s a step, then 8 ms; the crown radius of the sample is 0.375 mm, of which the wall may go half.
    const auto moving = [&](const std::string& velocity, const std::string& times = "") {
        return quasi_static(load, "strain_per_step = 8e-3\n", tool + "velocity = [0, 0, " + velocity + "]\n" + times);
    };
    EXPECT_EQ(check(moving("0.023"), 20), "");
    EXPECT_THAT([&] { check(moving("0.025"), 20); },
                ThrowsMessage<InvalidInput>(HasSubstr("[[wall]] 'tool' moves by 0.51 crown radii in one step")));
    EXPECT_EQ(check(moving("20", "start = 100.001\n"), 20), "") << "it moves in short steps only";
    EXPECT_THAT([&] { check(moving("20", "start = 99\n"), 20); }, ThrowsMessage<InvalidInput>(HasSubstr("'tool'")));
}

TEST(CompileModel, GivesTrilinItsCalibratedConstants) {
    const auto trilin = [](const std::string& constants, double sensitivity_rate) {
        return compile_model(parse_scene(fmt::format("[phase.a]\nlabel = 1\nlaw = \"trilin\"\n{}\n[load]\n"
                                                     "steps = [ {{ strain = 0.1, rate = {} }} ]\n",
                                                     constants, sensitivity_rate),
                                         "test"),
                             block(3));
    };
    const Model thesis = trilin("norton = { K = 49.1, M = 0.0714 }", 1e-3);
    EXPECT_DOUBLE_EQ(thesis.time_step, 0.1);
    EXPECT_NEAR(thesis.phases[0].natural_period, 1, 1e-12);
    EXPECT_NEAR(thesis.phases[0].pair.repulsive_stiffness / 1.42e9, 1, 1e-9);
    EXPECT_NEAR(thesis.phases[0].pair.max_attraction, 1e8, 2e5);
    // A rate ten times higher: the same packing ten times faster, under the stress of that rate.
    const Model fast = trilin("norton = { K = 49.1, M = 0.0714 }", 1e-2);
    EXPECT_NEAR(fast.phases[0].natural_period, 0.1, 1e-12);
    EXPECT_NEAR(fast.phases[0].pair.repulsive_stiffness / 1.42e9, std::pow(10, 0.0714), 1e-9);
    EXPECT_THAT([&] { trilin("norton = { K = 49.1, M = 0.3 }", 1e-3); },
                ThrowsMessage<InvalidInput>(HasSubstr("law \"bilin\" can")));
}

TEST_F(Solve, ScalesEveryForceWithTheHardeningAndMovesNothing) {
    const auto press = [&](const std::string& hardening) {
        const Scene scene = parse_scene(
            "[phase.a]\nlabel = 1\nlaw = \"trilin\"\nrepulsive_stiffness = 1.42e9\n"
            "natural_period = 1\n" +
                hardening + "\n[load]\nsteps = [ { strain = -0.03, rate = 1e-3 } ]\n",
            "test");
        solve(block(5), scene, folder / "run.h5", {}, MPI_COMM_WORLD);
        return std::pair(RunReader(folder / "run.h5").observable("stress_true").value,
                         RunReader(folder / "run.h5").frame(30).position);
    };
    const auto [plain, still] = press("");
    const auto [hard, moved] = press("hardening = { table = [[0, 2]] }");
    ASSERT_EQ(plain.size(), hard.size());
    for (std::size_t k = 1; k < plain.size(); ++k) EXPECT_NEAR(hard[k], 2 * plain[k], 1e-6 * std::abs(plain[k]));
    for (std::size_t k = 0; k < still.size(); ++k) EXPECT_LT((still[k] - moved[k]).norm(), 1e-9);
}

TEST(Model, RefusesASoftPhaseThatSwingsTooFastBetweenStiffParticles) {
    Packing sample = block(3);
    sample.species[5] = 2;
    const auto press = [](const std::string& stiffness) {
        return parse_scene("unusual_values = true\n" + phase_a +
                               "[phase.b]\nlabel = 2\nlaw = \"bilin\"\nrepulsive_stiffness = " + stiffness +
                               "\nnatural_period = 0.1\n[load]\nsteps = [ { strain = -0.1, rate = 1e-3 } ]\n"
                               "[accuracy]\ntime_step = 5e-3",
                           "test");
    };
    EXPECT_NO_THROW(compile_model(press("6.23e10"), sample));
    EXPECT_THAT([&] { compile_model(press("6.23e13"), sample); },
                ThrowsMessage<InvalidInput>(HasSubstr("[phase.a] is so much softer than [phase.b]")));
}

TEST(Model, RefusesARateThatThePackingCannotFollow) {
    const std::string load = "[load]\nsteps = [ { strain = -0.1, rate = 30 } ]\n[accuracy]\ntime_step = ";
    EXPECT_THAT([&] { compile_model(parse_scene(phase_a + load + "5e-3", "test"), block(3)); },
                ThrowsMessage<InvalidInput>(HasSubstr("the packing collapses")));
    const std::string trilin =
        "[phase.t]\nlabel = 1\nlaw = \"trilin\"\nrepulsive_stiffness = 1e9\nnatural_period = 0.1\n";
    EXPECT_THAT([&] { compile_model(parse_scene(trilin + load + "1e-2", "test"), block(3)); },
                ThrowsMessage<InvalidInput>(HasSubstr("the planes outrun the packing")));
}

}  // namespace
}  // namespace tomodem
