// two_blocks PARTICLES SEED RATE: two labelled blocks of TRILIN are crushed onto one another and pulled apart with
// self-contact (thesis section 15.1). Every pair that forms is checked; the counts are printed as JSON.
#include <fmt/format.h>
#include <mpi.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/solver/simulation_probe.hpp"
#include "tools/packgen/compaction.hpp"

namespace {

using namespace tomodem;
using plugin::Contact;
using plugin::ContactState;
using plugin::Simulation;

struct Errors {
    long across = 0, across_internal = 0;   ///< new pairs of both blocks; those taken as internal
    long within = 0, within_interface = 0;  ///< new pairs of one block; those taken as interface
};

/// The two halves of a brick, moved apart until no crowns meet.
Packing two_blocks(std::int64_t particles, std::int64_t seed, double gap) {
    Packing sample = packgen::compact({.particles = particles, .density = 0.74, .random_seed = seed}).packing;
    sample.box.periodic = {false, false, false};
    const double middle = sample.box.edges.z() / 2;
    for (std::size_t k = 0; k < sample.size(); ++k) {
        const bool upper = sample.position[k].z() > middle;
        sample.species[k] = upper ? 2 : 1;
        if (upper) sample.position[k].z() += gap;
    }
    sample.box.edges.z() += gap;
    return sample;
}

Model model_of(const Packing& sample, double rate) {
    std::string text;
    for (int label : {1, 2})
        text += fmt::format(
            "[phase.block{0}]\nlabel = {0}\nlaw = \"trilin\"\nrepulsive_stiffness = 1.42e9\n"
            "natural_period = 1\n",
            label);
    text += fmt::format(
        "[contact]\nself_contact = true\n[load]\nsteps = [ {{ strain = -0.5, rate = {} }} ]\n"
        "[accuracy]\ntime_step = 0.1\n",
        rate);
    return compile_model(parse_scene(text, "two_blocks"), sample);
}

/// Counts the pairs that were not in the crown one step ago.
void check(const std::vector<Contact>& before, const std::vector<Contact>& now, const Packing& sample, Errors& errors) {
    auto old = before.begin();
    for (const Contact& contact : now) {
        const std::pair key(contact.a, contact.b);
        while (old != before.end() && std::pair(old->a, old->b) < key) ++old;
        if (old != before.end() && std::pair(old->a, old->b) == key) continue;
        const bool interface = contact.state == ContactState::interface;
        if (sample.species[contact.a - 1] != sample.species[contact.b - 1]) {
            ++errors.across;
            errors.across_internal += !interface;
        } else {
            ++errors.within;
            errors.within_interface += interface;
        }
    }
}

/// Particles most of whose internal neighbours are of the other block.
long carried_by_the_other(const std::vector<Contact>& contacts, const Packing& sample) {
    std::vector<std::array<int, 2>> neighbours(sample.size());
    for (const Contact& contact : contacts) {
        if (contact.state != ContactState::internal) continue;
        const bool same = sample.species[contact.a - 1] == sample.species[contact.b - 1];
        for (std::int64_t particle : {contact.a, contact.b}) ++neighbours[particle - 1][same];
    }
    long count = 0;
    for (const auto& [other, own] : neighbours) count += other > own;
    return count;
}

}  // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    if (argc != 4) return 2;
    const double rate = std::atof(argv[3]);
    constexpr double gap = 2.0;
    {
        const Packing sample = two_blocks(std::atoll(argv[1]), std::atoll(argv[2]), gap);
        Simulation simulation(sample, model_of(sample, rate), 2, MPI_COMM_WORLD);
        for (const bool between_planes : {false, true}) {
            if (between_planes) simulation.place_planes();
            simulation.begin_relaxation();
            simulation.run(400);
            simulation.end_relaxation();
        }
        Errors errors;
        std::vector<Contact> before = plugin::SimulationProbe(simulation).contacts();
        // Far enough apart again for the blocks to separate.
        double strain = 0;
        for (const double target : {-0.5, 0.2}) {
            simulation.set_loading({.strain = strain, .rate = {target > strain ? rate : -rate}});
            const long steps = std::lround(std::abs(target - strain) / (rate * 0.1));
            for (long step = 0; step < steps; ++step) {
                simulation.run(1);
                std::vector<Contact> now = plugin::SimulationProbe(simulation).contacts();
                check(before, now, sample, errors);
                before = std::move(now);
            }
            strain = target;
        }
        fmt::print(
            "{{\"particles\": {}, \"new_across\": {}, \"across_internal\": {}, \"new_within\": {}, "
            "\"within_interface\": {}, \"carried_by_the_other\": {}}}\n",
            sample.size(), errors.across, errors.across_internal, errors.within, errors.within_interface,
            carried_by_the_other(before, sample));
    }
    MPI_Finalize();
}
