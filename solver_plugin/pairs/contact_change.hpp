#pragma once
#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/packed_particles.hpp"
#include "solver_plugin/pairs/pair_step.hpp"

namespace tomodem::plugin {

/// Decides what the new pairs of a block are, and forgets the interfaces that have left the crown.
/// @param formed, left  one bit a neighbour
inline void change_contacts(PairBlock& block, unsigned formed, unsigned left, const PackedParticles::Row* rows,
                            const ParticleView& particles, const PairStep& step, ContactMemory& memory) {
    for (int lane = 0; lane < PairBlock::lanes; ++lane) {
        const unsigned bit = 1U << lane;
        const int j = block.neighbour[lane];
        if ((formed & bit) != 0) {
            const auto &here = rows[block.particle], &there = rows[j];
            const double line[3] = {there.position[0] - here.position[0], there.position[1] - here.position[1],
                                    there.position[2] - here.position[2]};
            if (memory.classify(block.particle, j, line, particles.id, step.number)) block.interface |= bit;
        }
        if ((left & bit) != 0) {
            memory.forget(block.particle, j, particles.id);
            block.interface &= ~bit;
        }
    }
}

}  // namespace tomodem::plugin
