#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/load_path.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem {
namespace {

using plugin::Simulation;

constexpr double rate = 1e-3;

/// 5 x 5 x 5 particles that do not touch each other.
Packing loose_lattice() {
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box.edges = Vec3::Constant(15);
    for (int i = 0; i < 125; ++i) {
        const int row = i / 5, layer = row / 5;
        packing.position.push_back(3 * Vec3(i % 5, row % 5, layer));
        packing.species.push_back(1);
        packing.id.push_back(i + 1);
    }
    return packing;
}

/// Velocities at the end of the ramp of a scene with this initiation.
std::vector<Vec3> velocities_after_ramp(const std::string& initiation, int axis) {
    const Scene scene = parse_scene(
        "[phase.a]\nlabel = 1\nlaw = \"bilin\"\nrepulsive_stiffness = 6.23e9\nnatural_period = 0.1\n[load]\n"
        "steps = [ { strain = -0.1, rate = 1e-3 } ]\ninitiation = " +
            initiation,
        "test");
    Model model;
    model.seed_radius = 0.5;
    model.crown_radius = 0.75;
    model.time_step = 5e-3;
    model.phases = {{1, {1.0, 1.5, 6.23e9, 6.23e8}, 0.1, 1.578e6, 0.0}};
    Simulation simulation(loose_lattice(), model, axis, MPI_COMM_WORLD);
    simulation.place_planes();
    const auto path = load_path(scene, model);
    simulation.set_loading(path[0]);
    simulation.run(path[0].steps);
    const auto before = simulation.positions();
    simulation.set_loading(path[1]);
    simulation.run(1);
    std::vector<Vec3> velocities = simulation.positions();
    for (std::size_t k = 0; k < velocities.size(); ++k) velocities[k] = (velocities[k] - before[k]) / model.time_step;
    return velocities;
}

TEST(Initiation, GivesEveryParticleTheAffineVelocityOfTheFlow) {
    const Packing lattice = loose_lattice();
    for (int axis : {0, 2}) {
        const auto velocity = velocities_after_ramp("{ strain = 1e-3 }", axis);
        for (std::size_t k = 0; k < lattice.size(); ++k) {
            const Vec3 from_centre = lattice.position[k] - Vec3(6, 6, 6);
            if (std::abs(from_centre[axis]) > 5) continue;  // the planes touch the outermost
            Vec3 affine = 0.5 * rate * from_centre;
            affine[axis] = -rate * from_centre[axis];
            // Within the strain of the ramp.
            EXPECT_NEAR((velocity[k] - affine).norm(), 0, 2e-3 * rate * 6) << k;
        }
    }
}

TEST(Initiation, LeavesTheParticlesToThePlanesWithoutIt) {
    const auto velocity = velocities_after_ramp("{ strain = 1e-3, affine = false }", 2);
    EXPECT_EQ(velocity[62].norm(), 0);
    EXPECT_EQ(velocity[31].norm(), 0);
}

TEST(Initiation, AddsNoiseOfTheWantedSizeThatIsTheSameEveryTime) {
    const auto velocity = velocities_after_ramp("{ strain = 1e-3, affine = false, noise = 0.1 }", 2);
    const auto again = velocities_after_ramp("{ strain = 1e-3, affine = false, noise = 0.1 }", 2);
    double squares = 0;
    int count = 0;
    for (std::size_t k = 25; k < 100; ++k) {
        EXPECT_EQ(velocity[k], again[k]);
        squares += velocity[k].squaredNorm();
        count += 3;
    }
    // One standard deviation is 0.1 rate 2 r_s; 225 values tell it to 5 %.
    EXPECT_NEAR(std::sqrt(squares / count) / (0.1 * rate * 1.0), 1, 0.15);
}

}  // namespace
}  // namespace tomodem
