#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <optional>

#include "core/base/error.hpp"
#include "core/law/pair.hpp"
#include "core/packing/packing_file.hpp"
#include "solver_plugin/run/solver.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/solver/simulation_probe.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem {
namespace {

using plugin::Simulation;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double relative = 1e-12;

Model one_phase() {
    Model model;
    model.seed_radius = 0.5;
    model.crown_radius = 0.75;
    model.time_step = 5e-4;
    model.phases = {{1, {1.0, 1.5, 6.23e9, 6.23e8}, 0.1, 1.578e6, 0.0}};
    return model;
}

/// n x n squares of two triangles across z at `height`, from `low` to `high` in x and y.
TriangleMesh plate(int n, double low, double high, double height) {
    TriangleMesh mesh;
    const double edge = (high - low) / n;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) mesh.vertices.push_back(Vec3(low + i * edge, low + j * edge, height));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j, b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

/// Two particles far apart; the lower one stands over `foot` of a plate at z = 0.
Packing over(const Vec3& foot, double distance) {
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box.edges = Vec3::Constant(20);
    packing.position = {foot + Vec3(0, 0, distance), foot + Vec3(0, 0, distance + 10)};
    packing.species = {1, 1};
    packing.id = {1, 2};
    return packing;
}

class WallFeature : public testing::TestWithParam<Vec3> {};

INSTANTIATE_TEST_SUITE_P(FaceEdgeDiagonalVertex, WallFeature,
                         testing::Values(Vec3(4.7, 4.2, 0), Vec3(5, 4.3, 0), Vec3(4.5, 4.5, 0), Vec3(5, 5, 0)));

TEST_P(WallFeature, OfAFlatSurfaceGivesTheForceOfAPlane) {
    const Model model = one_phase();
    const law::Wall law{{model.seed_radius, model.crown_radius, 6.23e9, 6.23e8}};
    for (double distance : {0.3, 0.45, 0.55, 0.7, 0.76})
        for (double speed_away : {-0.2, 0.2})
            for (int axis : {0, 1, 2}) {
                Simulation simulation(over(GetParam(), distance), model, axis, MPI_COMM_WORLD);
                simulation.place_wall(plate(10, 0, 10, 0), {});
                const auto forces =
                    plugin::SimulationProbe(simulation).forces_at({Vec3(0.1, -0.2, speed_away), Vec3(0, 0, 0)});
                const double expected = law::wall_force(law, distance, speed_away);
                EXPECT_NEAR(forces[0].z(), expected, relative * law.repulsive_stiffness) << distance << speed_away;
                EXPECT_NEAR(forces[0].x(), 0, relative * law.repulsive_stiffness);
                EXPECT_NEAR(forces[0].y(), 0, relative * law.repulsive_stiffness);
                EXPECT_EQ(forces[1].norm(), 0);
            }
}

TEST(Wall, CountsTheParticlesThatItStandsIn) {
    Simulation simulation(over(Vec3(4.7, 4.2, 0), 0.2), one_phase(), 2, MPI_COMM_WORLD);
    EXPECT_EQ(simulation.place_wall(plate(10, 0, 10, 0), {}), 1);
    EXPECT_EQ(simulation.place_wall(plate(10, 0, 10, -0.1), {}), 0);
}

TEST(Wall, MovesBetweenItsStartAndItsStop) {
    // A heavy particle at rest: the force tells where the wall is.
    const Model model = one_phase();
    Simulation simulation(over(Vec3(4.7, 4.2, 0), 0.5), model, 2, MPI_COMM_WORLD);
    Wall wall;
    wall.velocity = {0, 0, 1e-3};
    wall.start = 2 * model.time_step;
    wall.stop = 5 * model.time_step;
    simulation.place_wall(plate(10, 0, 10, 0), wall);
    simulation.set_loading({});
    double overlap = 0;
    for (int step = 1; step <= 8; ++step) {
        simulation.run(1);
        overlap += step > 2 && step <= 5 ? 1e-3 * model.time_step : 0;
        const double force = simulation.take_wall_forces()[0].z();
        EXPECT_NEAR(force, 6.23e9 * overlap, 0.05 * 6.23e9 * 1e-3 * model.time_step) << step;
    }
}

class LoadTime : public testing::TestWithParam<Scheme> {};

INSTANTIATE_TEST_SUITE_P(BothSchemes, LoadTime, testing::Values(Scheme::explicit_steps, Scheme::quasi_static));

TEST_P(LoadTime, OfSegmentsWithTimeStepsOfTheirOwnMovesWallsAndHardens) {
    // Steps of 5e-4 s, then of a thousandth of that; the wall moves from 2.5 steps of the first to 4 of the second
    // kind.
    Model model = one_phase();
    model.scheme = GetParam();
    const bool quasi_static = GetParam() == Scheme::quasi_static;
    const double slow = model.time_step, fast = 1e-3 * slow, speed = 1e-3, stiffness = 6.23e9;
    model.phases[0].natural_period = 1e3;  // so heavy that it stays where it is
    model.phases[0].hardening = Hardening{.table = {{0, 1}, {10 * slow, 2}}};
    std::optional<Simulation> simulation(std::in_place, over(Vec3(4.7, 4.2, 0), 0.5), model, 2, MPI_COMM_WORLD);
    Wall wall;
    wall.velocity = {0, 0, speed};
    wall.start = 2.5 * slow;
    wall.stop = 6 * slow + 4 * fast;
    simulation->place_wall(plate(10, 0, 10, 0), wall);
    double time = 0;
    const auto expect_force = [&](Simulation& one, double time_step) {
        one.run(1);
        const double way = speed * std::max(0.0, std::min(time + time_step, wall.stop) - wall.start);
        const double strength = model.phases[0].hardening->factor(quasi_static ? time + time_step : time);
        EXPECT_NEAR(one.take_wall_forces()[0].z(), strength * stiffness * way,
                    1e-3 * stiffness * speed * slow + 1e-12 * stiffness)
            << time;
        time += time_step;
    };
    simulation->set_loading({.steps = 6, .time_step = slow});
    for (int step = 0; step < 6; ++step) expect_force(*simulation, slow);
    EXPECT_NEAR(time, 6 * slow, 1e-15);
    simulation->set_loading({.steps = 1000, .time_step = fast});
    for (int step = 0; step < 3; ++step) expect_force(*simulation, fast);

    // A simulation that resumes goes by the same clock.
    FoundCheckpoint found;
    simulation->rest();
    simulation->save(found.checkpoint);
    simulation.reset();  // LIGGGHTS bears one at a time
    Simulation resumed(over(Vec3(4.7, 4.2, 0), 0.5), model, 2, MPI_COMM_WORLD);
    resumed.restore(found);
    resumed.place_wall(plate(10, 0, 10, 0), wall);
    resumed.continue_loading({.steps = 1000, .time_step = fast}, 6);
    for (int step = 0; step < 3; ++step) expect_force(resumed, fast);
    EXPECT_NEAR(time, 6 * slow + 6 * fast, 1e-15);
}

TEST(Wall, GivesItsForceInTheAxesAndLengthsOfTheSample) {
    // A sample 50 times smaller: forces are 2500 times smaller.
    Packing small = over(Vec3(4.7, 4.2, 0), 0.4);
    small.seed_radius /= 50;
    for (Vec3& point : small.position) point /= 50;
    TriangleMesh mesh = plate(10, 0, 10, 0);
    for (Vec3& vertex : mesh.vertices) vertex /= 50;
    for (int axis : {0, 1, 2}) {
        Simulation simulation(small, one_phase(), axis, MPI_COMM_WORLD);
        simulation.place_wall(mesh, {});
        simulation.set_loading({});
        simulation.run(0);
        simulation.run(1);
        const Vec3 force = simulation.take_wall_forces()[0];
        EXPECT_NEAR(force.z() * 2500 / 6.23e8, 1, 1e-3);
        EXPECT_LT(std::abs(force.x()) + std::abs(force.y()), 1e-6 * force.z());
    }
}

class SolveWithWalls : public InTemporaryFolder {
 protected:
    static constexpr const char* phase =
        "[phase.a]\nlabel = 1\nlaw = \"bilin\"\nrepulsive_stiffness = 6.23e9\n"
        "natural_period = 0.1\n";
    static constexpr const char* accuracy = "[accuracy]\ntime_step = 5e-3\naveraging_strain = 3e-4\nframes = 2\n";

    Packing relaxed_sample() const {
        const Scene scene =
            parse_scene(std::string(phase) + "[load]\nsteps = [ { strain = -0.1, rate = 1e-3 } ]", "test");
        return come_to_rest(packgen::compact({.particles = 300, .density = 0.7}).packing, scene, {}, MPI_COMM_WORLD)
            .sample;
    }
    Scene scene(const std::string& text) const { return parse_scene(text, (folder / "scene.toml").string()); }
};

TEST_F(SolveWithWalls, PlatesAtTheSpeedOfThePlanesGiveTheirCurve) {
    const Packing sample = relaxed_sample();
    double low = 1e300, high = -1e300;
    for (const Vec3& point : sample.position) {
        low = std::min(low, point.z());
        high = std::max(high, point.z());
    }
    const double height = high - low, rate = 1e-2, speed = 0.5 * rate * height;
    // Planes of constant speed for a second: H = H0 (1 - a t), so the true rate is a + a^2 t + a^3 t^2 + ...
    std::string coefficients;
    for (int k = 1; k <= 6; ++k) coefficients += fmt::format("{:.17g}, ", std::pow(rate, k));
    const Scene planes = scene(fmt::format("{}[load]\nsteps = [ {{ strain = {:.17g}, rate = [{}] }} ]\n{}", phase,
                                           std::log1p(-rate), coefficients, accuracy));
    const RunResult pressed = solve(sample, planes, folder / "planes.h5", {}, MPI_COMM_WORLD);

    write_mesh(plate(7, -20, 30, low - 0.5), folder / "bottom.ply");
    write_mesh(plate(9, -20, 30, high + 0.5), folder / "top.ply");
    const Scene walls = scene(
        fmt::format("{}{}[[wall]]\nname = \"top\"\nsurface = \"top.ply\"\nvelocity = [0, 0, {:.17g}]\n"
                    "[[wall]]\nname = \"bottom\"\nsurface = \"bottom.ply\"\nvelocity = [0, 0, {:.17g}]\n"
                    "[load]\nduration = {:.17g}\nrate = {:.17g}\n",
                    phase, accuracy, -speed, speed, pressed.cost.steps * 5e-3, 0.01 / (pressed.cost.steps * 5e-3)));
    const RunResult driven = solve(sample, walls, folder / "walls.h5", {}, MPI_COMM_WORLD);
    EXPECT_EQ(driven.cost.steps, pressed.cost.steps);

    const RunReader a(folder / "planes.h5"), b(folder / "walls.h5");
    for (const auto& [plane, wall] :
         {std::pair{"force_top", "wall_top_force_z"}, std::pair{"force_bottom", "wall_bottom_force_z"}}) {
        const Observable &expected = a.observable(plane), &found = b.observable(wall);
        ASSERT_EQ(found.step, expected.step);
        ASSERT_EQ(static_cast<std::int64_t>(found.step.size()), pressed.cost.steps + 1) << "a point every step";
        double largest = 0;
        for (double force : expected.value) largest = std::max(largest, std::abs(force));
        ASSERT_GT(largest, 1e7);
        for (std::size_t k = 0; k < found.value.size(); ++k)
            EXPECT_NEAR(found.value[k], expected.value[k], 1e-6 * largest) << wall << " at step " << found.step[k];
    }
    EXPECT_FALSE(b.observables().contains("stress_true")) << "walls alone have no stress";
}

TEST_F(SolveWithWalls, RefuseAWallInsideTheSample) {
    const Packing sample = relaxed_sample();
    write_mesh(plate(7, -20, 30, 3), folder / "tool.stl");
    const Scene inside = scene(std::string(phase) + "[[wall]]\nname = \"tool\"\nsurface = \"tool.stl\"\n" +
                               "[load]\nsteps = [ { strain = -0.1, rate = 1e-3 } ]");
    EXPECT_THAT([&] { solve(sample, inside, folder / "run.h5", {}, MPI_COMM_WORLD); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("scene.toml' line 6: wall 'tool'"),
                                                  HasSubstr("particles are nearer than half a seed radius"))));
}

TEST_F(SolveWithWalls, RefuseASurfaceThatCannotBeRead) {
    const Packing sample = relaxed_sample();
    const Scene missing = scene(std::string(phase) + "[[wall]]\nname = \"tool\"\nsurface = \"tool.stl\"\n" +
                                "[load]\nsteps = [ { strain = -0.1, rate = 1e-3 } ]");
    const auto expect_refused = [&](const std::string& what) {
        EXPECT_THAT([&] { solve(sample, missing, folder / "run.h5", {}, MPI_COMM_WORLD); },
                    ThrowsMessage<InvalidInput>(AllOf(HasSubstr("line 6: wall 'tool'"), HasSubstr(what))));
    };
    expect_refused("tool.stl");
    std::ofstream(folder / "tool.stl") << "solid cut\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
    expect_refused("cut short");
    std::ofstream(folder / "tool.stl") << "solid empty\nendsolid\n";
    expect_refused("no triangle with an area");
}

}  // namespace
}  // namespace tomodem
