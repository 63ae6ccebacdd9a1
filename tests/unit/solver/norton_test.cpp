// Runs as a whole under mpirun with 1, 2 and 4 processes; the first also computes everything alone.
#include <gmock/gmock.h>
#include <mpi.h>

#include "core/base/error.hpp"
#include "core/scene/laws/norton.hpp"
#include "core/scene/scene.hpp"
#include "solver_plugin/run/guards.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/law/norton_reference.hpp"
#include "tests/unit/solver/simulation_probe.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem {
namespace {

using plugin::Simulation;
using C = law::NortonConstants;

int rank() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

/// Two phases, and an upper half of another object.
Packing sample() {
    Packing packing = packgen::compact({.particles = 900, .density = 0.64}).packing;
    for (std::size_t k = 0; k < packing.size(); ++k) {
        packing.species[k] = packing.position[k].x() < packing.box.edges.x() / 2 ? 1 : 2;
        packing.object.push_back(packing.position[k].z() < 0.7 * packing.box.edges.z() ? 1 : 2);
    }
    return packing;
}

Model model_of(const Packing& packing, const std::string& contact = "objects_only_push = true") {
    return compile_model(parse_scene(R"([phase.a]
label = 1
law = "norton"
norton = { K = 120, M = 0.0305 }
[phase.b]
label = 2
law = "norton"
norton = { K = 5020, M = 0.49 }
[contact]
)" + contact + R"(
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]
scheme = "explicit"
)",
                                     "test"),
                         packing);
}

std::vector<Vec3> stirred(const Packing& packing) {
    std::vector<Vec3> velocities;
    for (const Vec3& point : packing.position)
        velocities.push_back(1e-3 * Vec3(std::sin(point.y()), std::cos(2 * point.z()), point.x() - point.z()));
    return velocities;
}

Model quasi_static(const Packing& packing, const std::string& contact, double strain_per_step, double imbalance) {
    Model model = model_of(packing, contact);
    model.scheme = Scheme::quasi_static;
    model.strain_per_step = strain_per_step;
    model.imbalance = imbalance;
    return model;
}

/// In the solver's units.
law::NortonReference reference(const Packing& packing, const Model& model, const std::vector<Vec3>& velocities) {
    law::NortonReference reference;
    reference.law = norton_of(model);
    const double scale = model.seed_radius / packing.seed_radius;
    for (std::size_t i = 0; i < packing.size(); ++i) {
        reference.positions.push_back(scale * packing.position[i]);
        reference.velocities.push_back(scale * velocities[i]);
        reference.materials.push_back(packing.species[i] - 1);
    }
    reference.objects = packing.object;
    return reference;
}

/// Largest difference over the largest force.
double error_of_forces(const Packing& packing) {
    const Model model = model_of(packing);
    const std::vector<Vec3> velocities = stirred(packing);
    Simulation simulation(packing, model, 2, MPI_COMM_WORLD);
    const std::vector<Vec3> forces = plugin::SimulationProbe(simulation).forces_at(velocities);
    if (rank() != 0) return 0;
    law::NortonReference reference = tomodem::reference(packing, model, velocities);
    std::vector<Vec3> expected = reference.forces(reference.corrected_states());
    for (Vec3& force : expected) force *= std::pow(packing.seed_radius / model.seed_radius, 2);
    double largest = 0, difference = 0;
    for (std::size_t k = 0; k < forces.size(); ++k) {
        largest = std::max(largest, expected[k].norm());
        difference = std::max(difference, (forces[k] - expected[k]).norm());
    }
    return difference / largest;
}

TEST(Norton, ForcesAreThoseOfTheFormulasOnAnyNumberOfProcesses) {
    Packing packing = sample();
    // Where two objects just touch, the corner of their repulsion is rounded.
    EXPECT_LT(error_of_forces(packing), 1e-3);
    packing.object.assign(packing.size(), 1);
    EXPECT_LT(error_of_forces(packing), 1e-5) << "of single precision";
}

TEST(Norton, StepsAreThoseOfOneProcess) {
    const Packing packing = sample();
    const Model model = model_of(packing);
    const auto pressed = [&](MPI_Comm communicator) {
        Simulation simulation(packing, model, 2, communicator);
        simulation.place_planes();
        simulation.set_loading({.rate = {-1e-3}});
        simulation.run(300);
        return simulation.positions();
    };
    const std::vector<Vec3> parallel = pressed(MPI_COMM_WORLD);
    if (rank() != 0) return;
    const std::vector<Vec3> alone = pressed(MPI_COMM_SELF);
    double difference = 0, way = 0;
    for (std::size_t k = 0; k < alone.size(); ++k) {
        difference = std::max(difference, (parallel[k] - alone[k]).norm());
        way = std::max(way, (alone[k] - packing.position[k]).norm());
    }
    EXPECT_GT(way, 0.05);
    // Sums in another order, in single precision.
    EXPECT_LT(difference, 1e-5 * way);
}

/// Of the whole sample, in its order, on every process.
std::vector<Vec3> velocities_of(const Simulation& simulation, const Packing& packing) {
    const RowBlock rows = simulation.velocity_rows();
    std::vector<double> all(3 * packing.size(), 0.0);
    std::copy(rows.values.begin(), rows.values.end(), all.begin() + 3 * static_cast<std::ptrdiff_t>(rows.first));
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    std::vector<Vec3> velocities;
    for (std::size_t k = 0; k < packing.size(); ++k) velocities.emplace_back(all.data() + 3 * k);
    return velocities;
}

/// At rest under the law without inertia, on every process.
Packing at_rest(Packing packing, const std::string& contact) {
    Simulation simulation(packing, quasi_static(packing, contact, 8e-3, 1e-2), 2, MPI_COMM_WORLD);
    simulation.begin_relaxation();
    simulation.run(15);
    simulation.end_relaxation();
    const std::size_t count = packing.size();
    packing.position = simulation.positions();
    packing.position.resize(count);
    MPI_Bcast(packing.position.data(), static_cast<int>(3 * count), MPI_DOUBLE, 0, MPI_COMM_WORLD);
    return packing;
}

TEST(Norton, VelocitiesThatAreFoundBalanceTheForcesOfTheFormulas) {
    Packing packing = sample();
    packing.object.assign(packing.size(), 1);
    packing = at_rest(packing, "");
    // So short a step that the elastic forces are those of the present places.
    const Model model = quasi_static(packing, "", 1e-9, 1e-3);
    Simulation simulation(packing, model, 2, MPI_COMM_WORLD);
    simulation.place_planes();
    simulation.set_loading({.rate = {-1e-3}, .time_step = 1e-6});
    // What is taken from the tractions goes by the velocities of the step before: those of the same places here.
    for (int step = 0; step < 3; ++step) simulation.run(1);
    std::vector<double> loads;
    law::NortonReference reference = tomodem::reference(packing, model, velocities_of(simulation, packing));
    const std::vector<Vec3> forces = reference.forces(reference.corrected_states(), &loads);
    double low = 1e300, high = -1e300, net = 0, load = 0;
    for (const Vec3& point : packing.position) {
        low = std::min(low, point.z());
        high = std::max(high, point.z());
    }
    for (std::size_t k = 0; k < packing.size(); ++k) {
        // The planes have no part in it: their film reaches the neighbours of what is within 0.75 diameters of a face.
        const double z = packing.position[k].z(), near = 5 * packing.seed_radius;
        if (z < low + near || z > high - near) continue;
        net += forces[k].squaredNorm();
        load += loads[k] * loads[k];
    }
    EXPECT_LT(std::sqrt(net / load), 1e-3);
}

TEST(Norton, QuasiStaticStepsAreThoseOfOneProcess) {
    const Packing packing = at_rest(sample(), "");
    const auto pressed = [&](MPI_Comm communicator) {
        Simulation simulation(packing, quasi_static(packing, "", 8e-3, 1e-3), 2, communicator);
        simulation.place_planes();
        simulation.set_loading({.rate = {-1e-3}, .time_step = 8});
        simulation.run(6);
        return std::pair(simulation.positions(), simulation.take_forces());
    };
    const auto [parallel, forces] = pressed(MPI_COMM_WORLD);
    if (rank() != 0) return;
    const auto [alone, forces_alone] = pressed(MPI_COMM_SELF);
    double difference = 0, way = 0;
    for (std::size_t k = 0; k < alone.size(); ++k) {
        difference = std::max(difference, (parallel[k] - alone[k]).norm());
        way = std::max(way, (alone[k] - packing.position[k]).norm());
    }
    EXPECT_GT(way, 0.1);
    // Both are solutions within the balance that is asked for.
    EXPECT_LT(difference, 1e-2 * way);
    EXPECT_NEAR(forces.top, forces_alone.top, 1e-3 * std::abs(forces_alone.top));
}

TEST(Norton, QuasiStaticStepsHaveTheStressOfTheExplicitOnes) {
    const Packing packing = at_rest(sample(), "");
    struct Found {
        double force, virial;
    };
    const auto at_strain = [&](const Model& model, double time_step, double strain, double window) {
        Simulation simulation(packing, model, 2, MPI_COMM_WORLD);
        simulation.place_planes();
        simulation.set_loading({.rate = {-1e-3}, .time_step = time_step});
        simulation.run(std::llround((strain - window) / 1e-3 / time_step));
        simulation.take_forces();
        simulation.run(std::llround(window / 1e-3 / time_step));
        const plugin::PlaneForces forces = simulation.take_forces();
        return Found{(forces.top + forces.bottom) / 2, simulation.axial_virial()};
    };
    const Model explicit_steps = model_of(packing, "");
    const Found reference = at_strain(explicit_steps, explicit_steps.time_step, 0.08, 0.016);
    const Found found = at_strain(quasi_static(packing, "", 4e-3, 1e-2), 4, 0.08, 0.016);
    // The planes also accelerate the masses of the explicit scheme: that is the most of it.
    EXPECT_NEAR(found.force, reference.force, 0.01 * std::abs(reference.force));
    EXPECT_NEAR(found.virial, reference.virial, 0.005 * std::abs(reference.virial));
}

TEST(Norton, TheVelocitiesToBeFoundAreGuessedFromThoseOfTheRateBefore) {
    const Packing packing = at_rest(sample(), "objects_only_push = true");
    Model model = model_of(packing);
    model.scheme = Scheme::quasi_static;
    model.strain_per_step = 8e-3;
    model.imbalance = 1e-2;
    Simulation simulation(packing, model, 2, MPI_COMM_WORLD);
    simulation.place_planes();
    simulation.set_loading({.rate = {-1e-3}, .time_step = 8});
    simulation.run(1);  // not the uniform flow any more
    const std::vector<double> slow = simulation.velocity_rows().values;
    simulation.set_loading({.rate = {1}, .time_step = 8e-3});
    const std::vector<double> fast = simulation.velocity_rows().values;
    ASSERT_EQ(slow.size(), fast.size());
    double largest = 0;
    for (std::size_t k = 0; k < slow.size(); ++k) {
        largest = std::max(largest, std::abs(slow[k]));
        EXPECT_NEAR(fast[k], -1000 * slow[k], 1e-9 * std::abs(fast[k]));
    }
    EXPECT_GT(largest, 1e-4) << "there was no flow to begin with";
}

TEST(Norton, ASampleBeginsWithTheFlowAndIsRefusedWhenItHeats) {
    const Packing packing = sample();
    Simulation simulation(packing, model_of(packing), 2, MPI_COMM_WORLD);
    simulation.place_planes();
    simulation.set_loading({.rate = {-1e-3}});
    simulation.run(0);
    const double flow = simulation.flow_energy();
    ASSERT_GT(flow, 0);
    EXPECT_NEAR(simulation.energies().kinetic, flow, 1e-9 * flow);
    refuse_heat(simulation, 9 * flow, model_of(packing), "here");
    EXPECT_THAT(
        [&] { refuse_heat(simulation, 11 * flow, model_of(packing), "here"); },
        testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("the packing heats up here (step 0): its kinetic "
                                                                "energy is 11 times that of the flow")));
}

}  // namespace
}  // namespace tomodem
