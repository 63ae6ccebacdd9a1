#pragma once
#include <vector>

#include "core/law/norton_law.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// The NORTON law on four pairs at once (AVX2): a pass over the pairs for the sums of each particle, what follows from
/// them, an exchange with the ghosts, and a pass for the forces.
class NortonPairs final : public PairKernel {
 public:
    /// May be called between any two steps.
    /// @param list_skin  of its list, over the crown distance
    void set_law(const law::Norton& law, double list_skin);
    const law::Norton& law() const { return law_; }

    using PairKernel::packed;
    PackedParticles* packed() override { return &packed_; }
    void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step, double* forces,
                    ContactMemory* memory, const UsePair* use) override;
    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                     const UsePair& use) const override;
    double wall_force(const WallContact& contact) const override;
    double seed_energy(const ParticleView& particles, const NeighbourView& list) const override;
    int exchanged() const override { return 21; }
    void pack(int i, double* numbers) const override;
    void unpack(int i, const double* numbers) override;

 private:
    /// Of the last computed step; ghosts included.
    const law::NortonState& state(int i) const { return states_[i].of; }
    /// Whether the force of a listed pair holds it together: one object, no interface.
    bool bonded(const ParticleView& particles, int i, int j, const ContactMemory* memory) const;

    struct alignas(64) Sums {
        law::NortonSums of;
    };
    struct alignas(64) State {
        law::NortonState of;
    };

    void update_contacts(const ParticleView& particles, const PairStep& step, bool fresh, ContactMemory& memory);
    void add_sums();
    void find_states(const ParticleView& particles);
    void compute();

    law::Norton law_;
    PackedParticles packed_;
    std::vector<Sums> sums_;
    std::vector<State> states_;
};

}  // namespace tomodem::plugin
