#pragma once
#include <vector>

#include "solver_plugin/pairs/pair_kernel.hpp"
#include "solver_plugin/pairs/vector_pairs.hpp"

namespace tomodem::plugin {

/// BILIN and TRILIN: VectorPairs where the machine has AVX2, scalar_pairs everywhere else and where each pair is asked
/// for. TOMODEM_KERNEL=scalar in the environment forces the latter.
class CrownPairs final : public PairKernel {
 public:
    CrownPairs();

    /// May be called between any two steps.
    /// @param list_skin  of the vector loop's list, over the largest crown distance
    void set_laws(const PairLaws& laws, double list_skin);

    using PairKernel::packed;
    PackedParticles* packed() override { return vectorised_ ? &vector_pairs_.packed() : nullptr; }
    void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step, double* forces,
                    ContactMemory* memory, const UsePair* use) override;
    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                     const UsePair& use) const override;
    double wall_force(const WallContact& contact) const override;
    double seed_energy(const ParticleView& particles, const NeighbourView& list) const override;

 private:
    const law::Pair& law_of(const ParticleView& particles, int i, int j) const {
        return laws_.of_types[(particles.type[i] - 1) * laws_.type_count + particles.type[j] - 1];
    }

    bool vectorised_;
    PairLaws laws_;
    std::vector<law::Wall> walls_;  // by type, from 1, of a particle of the type's nominal radius
    VectorPairs vector_pairs_;
};

}  // namespace tomodem::plugin
