#include "solver_plugin/pairs/crown_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "solver_plugin/pairs/scalar_pairs.hpp"

namespace tomodem::plugin {
namespace {

bool scalar_asked_for() {
    const char* const kernel = std::getenv("TOMODEM_KERNEL");
    return kernel != nullptr && std::string_view(kernel) == "scalar";
}

}  // namespace

CrownPairs::CrownPairs() : vectorised_(VectorPairs::supported() && !scalar_asked_for()) {}

void CrownPairs::set_laws(const PairLaws& laws, double list_skin) {
    laws_ = laws;
    walls_.assign(1, {});
    for (int type = 0; type < laws.type_count; ++type)
        walls_.push_back(law::against_wall(laws.of_types[type * laws.type_count + type]));
    double crown = 0;
    for (const law::Pair& law : laws_.of_types) crown = std::max(crown, law.crown_distance);
    vector_pairs_.set_laws(laws_, list_skin * crown);
}

void CrownPairs::add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step,
                            double* forces, ContactMemory* memory, const UsePair* use) {
    if (vectorised_ && use == nullptr) {
        vector_pairs_.add_forces(particles, step, forces, memory);
    } else if (use != nullptr) {
        scalar_pairs(laws_, particles, list, step, forces, memory, std::cref(*use));
    } else {
        scalar_pairs(laws_, particles, list, step, forces, memory, [](int, int, const double*, const double*) {});
    }
}

void CrownPairs::pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                             const UsePair& use) const {
    for_each_pair(list, [&](int i, int j) {
        law::Pair law = law_of(particles, i, j);
        if (laws_.dispersed) {
            law.crown_distance = particles.radius[i] + particles.radius[j];
            law.seed_distance = law.crown_distance * laws_.seed_to_crown;
        }
        double apart[3], squared = 0, rate = 0;
        for (int c = 0; c < 3; ++c) {
            apart[c] = particles.position[3 * i + c] - particles.position[3 * j + c];
            squared += apart[c] * apart[c];
            rate += apart[c] * (particles.velocity[3 * i + c] - particles.velocity[3 * j + c]);
        }
        if (squared > law.crown_distance * law.crown_distance) return;
        if (!particles.same_object(i, j) || (memory != nullptr && memory->is_interface(i, particles.id[j])))
            law.max_attraction = 0;
        const double distance = std::sqrt(squared);
        const double over_distance = law::pair_force(law, distance, rate) / distance;
        const double force[3] = {over_distance * apart[0], over_distance * apart[1], over_distance * apart[2]};
        use(i, j, force, apart);
    });
}

double CrownPairs::wall_force(const WallContact& contact) const {
    law::Wall law = walls_[contact.type];
    law.seed_distance *= contact.radius / law.crown_distance;
    law.crown_distance = contact.radius;
    return law::wall_force(law, contact.distance, contact.rate);
}

double CrownPairs::seed_energy(const ParticleView& particles, const NeighbourView& list) const {
    if (vectorised_) return vector_pairs_.seed_energy(particles.local_count);
    return spring_energy(particles, list, [&](int i, int j) {
        return std::pair((particles.radius[i] + particles.radius[j]) * laws_.seed_to_crown,
                         law_of(particles, i, j).repulsive_stiffness);
    });
}

}  // namespace tomodem::plugin
