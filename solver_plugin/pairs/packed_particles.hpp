#pragma once
#include <cstdint>
#include <vector>

#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/pair_list.hpp"
#include "solver_plugin/pairs/particle_view.hpp"

namespace tomodem::plugin {

/// What the vector loops read and write of a particle, one cache line each, and the list of pairs that follows them.
///
/// The list (reach + an inner skin) is used until too many particles have moved half of that skin.
class PackedParticles {
 public:
    struct alignas(64) Row {
        double position[4];  // the fourth stays 0: it takes part in the sums
        double velocity[4];  // the fourth is the radius of the crown: it meets that 0 in every product
    };
    struct alignas(32) Force {
        double component[4];
    };

    void set_types(int count) { list_.set_types(count); }
    /// @param inner_skin  added to the reach when pairs are listed, in the lengths of the positions
    void set_inner_skin(double inner_skin) { inner_skin_ = inner_skin; }

    /// v += kick f / m, x += drift v; the next follow() finds these particles in their rows.
    void integrate(const MovingView& particles, double kick, double drift);

    /// Brings rows and list up to date.
    /// @param reach  of the list, without the skin
    /// @param memory  whose interfaces are marked in the list; null: none is
    /// @return whether every pair was listed anew
    bool follow(const ParticleView& particles, double reach, bool renumbered, const ContactMemory* memory);

    /// Adds the sums of the forces to those of the local particles, and clears them.
    void give_forces(const ParticleView& particles, double* forces);

    const Row* rows() const { return rows_.data(); }
    Force* forces() { return forces_.data(); }
    PairList& list() { return list_; }
    const PairList& list() const { return list_; }

 private:
    void make_room(int count);
    void copy(const ParticleView& particles, int first);

    double inner_skin_ = 0;
    std::vector<Row> rows_;
    int integrated_ = 0;  // rows that integrate() has brought up to date
    std::vector<Force> forces_;
    PairList list_;
    std::vector<std::int32_t> strayed_;  // moved by half the inner skin
};

}  // namespace tomodem::plugin
