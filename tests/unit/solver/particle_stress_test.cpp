#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/scene/model.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem {
namespace {

using plugin::Simulation;

constexpr double stiffness = 6.23e9;

/// So heavy that nothing moves in a few steps.
Model heavy_model(const Packing& sample) {
    return compile_model(
        parse_scene("unusual_values = true\n[phase.a]\nlabel = 1\nlaw = \"bilin\"\nrepulsive_stiffness = 6.23e9\n"
                    "natural_period = 1e9\n[load]\nsteps = [ { strain = -0.1, rate = 1e-20 } ]\n"
                    "[accuracy]\ntime_step = 1e-3\n",
                    "test"),
        sample);
}

Packing two_particles(const Vec3& apart) {
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box.edges = Vec3(2, 3, 4);
    packing.position = {Vec3(3, 4, 5), Vec3(3, 4, 5) + apart};
    packing.species = {1, 1};
    packing.id = {1, 2};
    return packing;
}

TEST(ParticleStress, OfAPairIsForceTimesHalfTheBranchInTheSamplesAxes) {
    const Vec3 direction = Vec3(1, -2, 2) / 3;
    const Packing sample = two_particles(0.9 * direction);
    for (int axis = 0; axis < 3; ++axis) {
        Simulation simulation(sample, heavy_model(sample), axis, MPI_COMM_WORLD);
        simulation.run_to_stress_sample(1);
        const RowBlock stress = simulation.stress_rows();
        const double volume = 2 * 3 * 4 / 2.0, force = stiffness * 0.1;
        EXPECT_DOUBLE_EQ(simulation.volume_per_particle(), volume);
        constexpr int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2};
        for (int particle = 0; particle < 2; ++particle)
            for (int k = 0; k < 6; ++k)
                EXPECT_NEAR(stress.values[6 * particle + k],
                            -force * 0.45 * direction[first[k]] * direction[second[k]] / volume, 1e-12 * force)
                    << "axis " << axis << " component " << k;
    }
}

TEST(ParticleStress, OfAColumnAtRestSumsUpToTheForceOnThePlanesTimesTheirDistance) {
    // Both contacts with the planes get the overlap that the one between the particles has: every force is the same.
    const double overlap = 0.05, gap = 1 - overlap, time_step = 1e-3;
    const Packing sample = two_particles(Vec3(0, gap, 0));
    Simulation simulation(sample, heavy_model(sample), 1, MPI_COMM_WORLD);
    simulation.place_planes();
    const double height = simulation.initial_height();
    simulation.set_loading(
        {.rate = {std::log(1 - 2 * overlap / height) / time_step}, .steps = 1, .time_step = time_step});
    simulation.run_to_stress_sample(1);
    const RowBlock stress = simulation.stress_rows();
    const plugin::PlaneForces forces = simulation.take_forces();
    const double force = stiffness * overlap, distance = gap + 2 * (0.5 - overlap);
    EXPECT_NEAR(forces.top, -force, 1e-9 * force);
    EXPECT_NEAR(forces.bottom, -force, 1e-9 * force);
    const double total = (stress.values[1] + stress.values[7]) * simulation.volume_per_particle();
    EXPECT_NEAR(total, forces.top * distance, 1e-12 * force);
    for (const int k : {0, 2, 3, 4, 5}) EXPECT_EQ(stress.values[k], 0) << k;
}

TEST(ParticleStress, IsScaledToTheLengthsOfTheSample) {
    Packing small = two_particles(Vec3(0, 0, 0.09));
    small.seed_radius = 0.05;
    small.box.edges = Vec3(0.2, 0.3, 0.4);
    const Packing large = two_particles(Vec3(0, 0, 0.9));
    const auto stress = [](const Packing& sample) {
        Simulation simulation(sample, heavy_model(sample), 2, MPI_COMM_WORLD);
        simulation.run_to_stress_sample(1);
        return simulation.stress_rows().values[2];
    };
    EXPECT_NEAR(stress(small), stress(large), 1e-9 * std::abs(stress(large)));
}

}  // namespace
}  // namespace tomodem
