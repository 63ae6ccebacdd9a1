#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/law/pair.hpp"
#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/packed_particles.hpp"
#include "solver_plugin/pairs/pair_step.hpp"

namespace tomodem::plugin {

/// What a sample needs of the pair loop; each combination has a loop of its own.
struct PairLaws {
    std::vector<law::Pair> of_types;  ///< type_count^2, row by row, for particles of the type's nominal radius
    int type_count = 1;
    bool dispersed = false;    ///< radii differ within a type
    double seed_to_crown = 0;  ///< r_s / r_c, the same for all
};

/// The pair laws on four pairs at once (AVX2), without branches, on a list of its own.
class VectorPairs {
 public:
    /// Whether this machine can run the kernel.
    static bool supported();

    /// @param inner_skin  added to the crowns when pairs are listed, in the lengths of the positions
    void set_laws(const PairLaws& laws, double inner_skin);

    /// Adds the forces of all pairs to those of the local particles.
    /// @param forces  3 per local particle
    /// @param memory  of self-contact, whose next_outward() is added to; null without it
    void add_forces(const ParticleView& particles, const PairStep& step, double* forces,
                    ContactMemory* memory = nullptr);

    /// Elastic energy of the overlapping seeds at the last computed step; half of it for pairs with a ghost.
    double seed_energy(int local_count) const;

    PackedParticles& packed() { return packed_; }
    const PackedParticles& packed() const { return packed_; }

 private:
    using Row = PackedParticles::Row;
    struct PairConstants {
        double seed_distance, crown_squared, repulsive_stiffness, attractive_stiffness, min_force;
        bool same_object;
    };

    /// One loop for each combination of several laws (1), bounded attraction (2), dispersed radii (4), memory (8).
    template <unsigned features>
    void compute(const ParticleView& particles, const PairStep& step, bool fresh, ContactMemory* memory);

    std::vector<PairConstants> constants_;  // of the pairs of types, then the same without attraction
    std::vector<double> crown_;
    bool bounded_ = false, dispersed_ = false;
    double seed_to_crown_ = 0;
    int type_count_ = 0;
    PackedParticles packed_;
};

}  // namespace tomodem::plugin
