#include <gtest/gtest.h>

#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/solver/simulation_probe.hpp"

namespace tomodem {
namespace {

/// Force along x on a particle at a periodic side from the image of one at the other side, both at rest, 1.2 apart.
double force_across_the_side(double strain_rate) {
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box.edges = Vec3::Constant(10);
    packing.position = {Vec3(0.6, 5, 2), Vec3(9.4, 5, 2), Vec3(5, 5, 8)};
    packing.species = {1, 1, 1};
    packing.id = {1, 2, 3};
    Model model;
    model.seed_radius = 0.5;
    model.crown_radius = 0.75;
    model.time_step = 5e-4;
    model.phases = {{1, {1.0, 1.5, 6.23e9, 6.23e8}, 0.1, 1.578e6, 0.0}};
    model.lateral = Lateral::isochoric;
    plugin::Simulation simulation(packing, model, 2, MPI_COMM_WORLD);
    simulation.place_planes();
    simulation.set_loading({.rate = {strain_rate}, .steps = 1, .time_step = model.time_step});
    return plugin::SimulationProbe(simulation).forces_at({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()})[0].x();
}

TEST(LateralBox, MovesImagesWithTheRateOfTheEdge) {
    // Pressed, the sides part, and the pair is pulled together; drawn, they close in, and it is let go.
    EXPECT_NEAR(force_across_the_side(-1e-3) / (-0.2 * 6.23e8), 1, 1e-12);
    EXPECT_EQ(force_across_the_side(1e-3), 0);
}

}  // namespace
}  // namespace tomodem
