#pragma once
#include <functional>
#include <vector>

#include "core/law/norton_law.hpp"
#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/packed_particles.hpp"
#include "solver_plugin/pairs/pair_step.hpp"

namespace tomodem::plugin {

/// The NORTON law on four pairs at once (AVX2): a pass over the pairs for the sums of each particle, what follows from
/// them, an exchange with the ghosts, and a pass for the forces.
class NortonPairs {
 public:
    /// Numbers of a particle that its ghosts on other processes need.
    static constexpr int exchanged = 21;

    /// @param inner_skin  as PackedParticles
    void set_law(const law::Norton& law, double inner_skin);
    const law::Norton& law() const { return law_; }

    /// Adds the forces of all pairs to those of the local particles.
    /// @param forces    3 per local particle
    /// @param memory    of self-contact, whose next_outward() is added to; null without it
    /// @param exchange  brings the state of each ghost, by pack() and unpack(); called once
    void add_forces(const ParticleView& particles, const PairStep& step, double* forces, ContactMemory* memory,
                    const std::function<void()>& exchange);

    /// Of the last computed step; ghosts included.
    const law::NortonState& state(int i) const { return states_[i].of; }
    void pack(int i, double* numbers) const;
    void unpack(int i, const double* numbers);

    /// Whether the force of a listed pair holds it together: one object, no interface.
    bool bonded(const ParticleView& particles, int i, int j, const ContactMemory* memory) const;

    PackedParticles& packed() { return packed_; }
    const PackedParticles& packed() const { return packed_; }

 private:
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
