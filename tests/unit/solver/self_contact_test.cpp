// Runs as a whole under mpirun with 1 to 4 processes; the first also computes everything alone.
#include <gmock/gmock.h>
#include <mpi.h>

#include <algorithm>

#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/solver/simulation_probe.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem {
namespace {

using plugin::Contact;
using plugin::ContactState;
using plugin::Simulation;

int rank() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

int processes() {
    int processes = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &processes);
    return processes;
}

/// Part of a dense random packing.
template <class Keep>
Packing cut(std::int64_t particles, double density, Keep keep) {
    const Packing brick = packgen::compact({.particles = particles, .density = density}).packing;
    Packing sample;
    sample.seed_radius = brick.seed_radius;
    sample.box = brick.box;
    for (const Vec3& point : brick.position) {
        if (!keep(point, brick.box.edges)) continue;
        sample.position.push_back(point);
        sample.species.push_back(1);
        sample.id.push_back(static_cast<std::int64_t>(sample.id.size()) + 1);
    }
    return sample;
}

/// Two flat arms, one over the other, joined at one end.
Packing jaw() {
    return cut(1600, 0.74, [](const Vec3& point, const Vec3& edges) {
        const double z = point.z();
        const bool gap = z > 2.8 && z < 4.8 && point.x() > 0.3 * edges.x();
        return z < 7.6 && !gap;
    });
}

Model pressed_at(double rate, double period, const Packing& sample) {
    const Scene scene = parse_scene(R"([phase.a]
label = 1
law = "trilin"
repulsive_stiffness = 1.42e9
natural_period = )" + std::to_string(period) +
                                        R"(
[contact]
self_contact = true
[load]
steps = [ { strain = -0.5, rate = )" + std::to_string(rate) +
                                        R"( } ]
[accuracy]
time_step = 0.1)",
                                    "test");
    return compile_model(scene, sample);
}

/// What a pressed sample has come to; complete on the first process.
struct Outcome {
    std::vector<Contact> contacts;
    std::vector<Vec3> positions, outward;
    std::int64_t neighbour_builds = 0;
    std::size_t changed_owner = 0;
    std::array<int, 3> grid{};

    std::size_t interfaces() const {
        return std::count_if(contacts.begin(), contacts.end(),
                             [](const Contact& contact) { return contact.state == ContactState::interface; });
    }
};

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double largest = 0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, (a[k] - b[k]).cwiseAbs().maxCoeff());
    return largest;
}

/// Brings a sample to rest on one process: all computations start from the same positions, bit by bit.
Packing at_rest(Packing sample) {
    Simulation simulation(sample, pressed_at(1e-3, 1, sample), 2, MPI_COMM_SELF);
    simulation.begin_relaxation();
    simulation.run(600);
    sample.position = simulation.positions();
    return sample;
}

/// Twice the calibrated period: a packing calm enough that round-off stays below 1e-9 for 500 steps.
Outcome fold(const Packing& sample, MPI_Comm communicator) {
    constexpr double rate = 1e-2;
    Simulation simulation(sample, pressed_at(rate, 2, sample), 2, communicator);
    simulation.place_planes();
    simulation.set_loading({.rate = {-rate}});
    simulation.run(0);
    const std::int64_t builds = simulation.neighbour_builds();
    const std::vector<int> before = plugin::SimulationProbe(simulation).owners();
    simulation.run(500);
    Outcome outcome{plugin::SimulationProbe(simulation).contacts(),
                    simulation.positions(),
                    plugin::SimulationProbe(simulation).outward_vectors(),
                    simulation.neighbour_builds() - builds,
                    0,
                    plugin::SimulationProbe(simulation).process_grid()};
    const std::vector<int> after = plugin::SimulationProbe(simulation).owners();
    for (std::size_t k = 0; k < before.size(); ++k) outcome.changed_owner += before[k] != after[k];
    return outcome;
}

TEST(SelfContact, OfAFoldingSampleIsClassifiedAsOnOneProcess) {
    const Packing sample = at_rest(jaw());
    const Outcome parallel = fold(sample, MPI_COMM_WORLD);
    if (rank() != 0) return;
    const Outcome alone = fold(sample, MPI_COMM_SELF);
    ASSERT_GT(parallel.neighbour_builds, 3);
    if (processes() > 1) {
        ASSERT_GT(parallel.changed_owner, 10u);
    }
    ASSERT_GT(alone.interfaces(), 100u);
    EXPECT_EQ(parallel.interfaces(), alone.interfaces());
    EXPECT_TRUE(parallel.contacts == alone.contacts);
    EXPECT_LT(largest_difference(parallel.outward, alone.outward), 1e-9);
    EXPECT_LT(largest_difference(parallel.positions, alone.positions), 1e-9);
}

TEST(SelfContact, FindsNoSeamInsideADenseBlock) {
    constexpr double height = 8, rate = 3e-3;
    const Packing sample = at_rest(cut(4000, 0.74, [](const Vec3& point, const Vec3&) { return point.z() < height; }));
    Simulation simulation(sample, pressed_at(rate, 1, sample), 2, MPI_COMM_WORLD);
    simulation.place_planes();
    simulation.set_loading({.rate = {-rate}});
    if (processes() == 4) {
        EXPECT_EQ(plugin::SimulationProbe(simulation).process_grid(), (std::array{2, 2, 1}));
    }
    // At first two diameters from every face: beside the free surface a pair may well be an interface.
    constexpr double depth = 2;
    const Vec3 far_corner(sample.box.edges.x(), sample.box.edges.y(), height);
    const auto inside = [&](std::int64_t particle) {
        const Vec3& point = sample.position[particle - 1];
        return point.minCoeff() >= depth && (far_corner - point).minCoeff() >= depth;
    };
    for (int look = 0; look < 20; ++look) {
        simulation.run(50);
        std::size_t pairs = 0, interfaces = 0;
        for (const Contact& contact : plugin::SimulationProbe(simulation).contacts()) {
            if (!inside(contact.a) || !inside(contact.b)) continue;
            ++pairs;
            interfaces += contact.state == ContactState::interface;
        }
        if (rank() != 0) continue;
        EXPECT_GT(pairs, 2000u);
        // A hot packing opens a gap here and there for a moment (1 pair in 3000 seen); a seam has 10 to 30.
        EXPECT_LE(interfaces, 3u) << "of " << pairs << " at strain " << simulation.strain();
    }
}

}  // namespace
}  // namespace tomodem
