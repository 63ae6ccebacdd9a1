#pragma once
#include <cmath>

#include "solver_plugin/pairs/vector_pairs.hpp"

namespace tomodem::plugin {

/// The pair laws one pair at a time, straight from the formulas: the reference of VectorPairs, and what runs where
/// there is no AVX2. Same arguments and effects.
///
/// @param tally  called as (i, j, force on i [3], vector from j to i [3]) for each pair that acts
template <class Tally>
void scalar_pairs(const PairLaws& laws, const ParticleView& particles, const NeighbourView& list, const PairStep& step,
                  double* forces, ContactMemory* memory, Tally tally) {
    const auto object_of = [&](int i) { return particles.object ? particles.object[particles.id[i] - 1] : 0; };
    for (int row = 0; row < list.row_count; ++row) {
        const int i = list.rows[row];
        for (int entry = 0; entry < list.lengths[i]; ++entry) {
            const int j = list.neighbours[i][entry] & list.index_mask;
            law::Pair law = laws.of_types[(particles.type[i] - 1) * laws.type_count + particles.type[j] - 1];
            if (laws.dispersed) {
                law.crown_distance = particles.radius[i] + particles.radius[j];
                law.seed_distance = law.crown_distance * laws.seed_to_crown;
            }
            double apart[3], squared = 0, rate = 0, squared_before = 0;
            for (int c = 0; c < 3; ++c) {
                apart[c] = particles.position[3 * i + c] - particles.position[3 * j + c];
                const double speed = particles.velocity[3 * i + c] - particles.velocity[3 * j + c];
                const double before = step.set_up ? apart[c] : apart[c] - step.time_step * speed;
                squared += apart[c] * apart[c];
                squared_before += before * before;
                rate += apart[c] * speed;  // times the distance: only the sign counts
            }
            const double crown_squared = law.crown_distance * law.crown_distance;
            const bool inside = squared <= crown_squared;
            const bool same_object = object_of(i) == object_of(j);
            bool interface = false;
            if (memory != nullptr) {
                interface = memory->is_interface(i, particles.id[j]);
                if (interface && !inside) memory->forget(i, j, particles.id);
                const double line[3] = {-apart[0], -apart[1], -apart[2]};
                if (inside && !interface && squared_before > crown_squared && same_object)
                    interface = memory->classify(i, j, line, particles.id, step.number);
                if (inside && !interface && same_object)
                    for (int c = 0; c < 3; ++c) {
                        memory->next_outward()[i][c] += apart[c];
                        memory->next_outward()[j][c] -= apart[c];
                    }
            }
            if (!inside) continue;
            if (interface || !same_object) law.max_attraction = 0;
            const double distance = std::sqrt(squared);
            const double over_distance = law::pair_force(law, distance, rate) / distance;
            double force[3];
            for (int c = 0; c < 3; ++c) {
                force[c] = over_distance * apart[c];
                forces[3 * i + c] += force[c];
                if (j < particles.local_count) forces[3 * j + c] -= force[c];
            }
            tally(i, j, force, apart);
        }
    }
}

}  // namespace tomodem::plugin
