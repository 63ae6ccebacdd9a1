#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/packed_particles.hpp"
#include "solver_plugin/pairs/pair_step.hpp"
#include "solver_plugin/pairs/particle_view.hpp"

namespace tomodem::plugin {

/// A particle at a wall.
struct WallContact {
    int particle;
    int type;            ///< from 1
    double radius;       ///< of the particle's crown
    double distance;     ///< from its centre to the wall
    double rate;         ///< of the distance, relative to the wall
    double other_force;  ///< of everything else on the particle, along the normal
    double time_step_over_mass;
    double normal[3];  ///< from the wall to the particle
    int plane = -1;    ///< 0 and 1: the lower and the upper of the two planes; else another wall
};

/// A wall within reach of a particle, for a kernel that needs to know it before wall_force().
struct NearWall {
    int particle;
    int wall;          ///< its number: a particle may be near several
    double normal[3];  ///< from the wall to the particle
    double distance;   ///< of the particle's centre
    double velocity;   ///< of the wall along the normal: mean over the interval that is asked for
};

/// Passes over all pairs that a kernel which finds the velocities itself has made so far; one costs about half a step
/// of the explicit scheme.
struct FlowWork {
    std::int64_t steps = 0;
    std::int64_t solutions = 0;  ///< of a linear system: one or two a step
    std::int64_t geometries = 0, corrections = 0, forces = 0, products = 0, blocks = 0;

    std::int64_t evaluations() const { return geometries + corrections + forces + products + blocks; }
};

/// The simulation around a kernel that needs more of it than its pairs.
class FlowSurroundings {
 public:
    virtual ~FlowSurroundings() = default;
    /// Sums over the processes, in place; the same numbers on each of them.
    virtual void add_up(double* values, std::size_t count) const = 0;
    /// The largest over the processes, likewise.
    virtual void take_largest(double* values, std::size_t count) const = 0;
    /// Of the load, at a time after the present step [s], positive [1/s]; 0 where no planes press.
    virtual double rate(double start) const = 0;
    /// Whether the sample may turn as a whole: not between periodic sides.
    virtual bool can_turn() const = 0;
    /// Walls within reach of the particles of this process where the particles are now.
    /// @param start     of the interval, in time after the present step [s]
    /// @param interval  to come [s]
    virtual std::vector<NearWall> walls(double start, double interval) const = 0;
    /// The two planes alone (WallContact::plane is their number), likewise, ghosts' included; by particles.
    virtual std::vector<NearWall> planes(double start, double interval) const = 0;
};

/// The forces of one law in one simulation: a call for all pairs of a step, never one for a pair.
class PairKernel {
 public:
    /// (i, j, force on i [3], vector from j to i [3]) of a pair that acts; j may be a ghost.
    using UsePair = std::function<void(int, int, const double*, const double*)>;

    virtual ~PairKernel() = default;

    /// Where the kernel keeps particles and a list of its own; null: it runs over the list that it is given.
    virtual PackedParticles* packed() { return nullptr; }
    const PackedParticles* packed() const { return const_cast<PairKernel*>(this)->packed(); }
    /// Whether the kernel looks for its pairs itself: nobody need list them for it.
    virtual bool finds_pairs() const { return packed() != nullptr; }

    /// Adds the forces of all pairs to those of the local particles. Here: those of pair_forces(), without
    /// self-contact.
    /// @param forces  3 per local particle
    /// @param memory  of self-contact, whose next_outward() is added to; null without it
    /// @param use     is called for every pair too; null where nobody asks
    virtual void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step,
                            double* forces, ContactMemory* memory, const UsePair* use);

    /// Reports the force of every pair as the law saw it in the last step, and changes nothing.
    /// @param particles  with velocities half a step old
    /// @param memory     null without self-contact
    virtual void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                             const UsePair& use) const = 0;

    /// Force of a wall along its normal, repulsion positive [uN]. The caller adds it to the particle; what a wall does
    /// to the neighbours through their flow is added by add_forces().
    virtual double wall_force(const WallContact& contact) const = 0;
    /// Distance from one of the two planes up to which a particle feels it.
    /// @param radius  of the particle's crown
    virtual double plane_reach(double radius) const { return radius; }
    /// Distance from a wall at which its force acts on the material; the lever of its force in a stress ends there.
    virtual double face() const { return 0; }

    /// Elastic energy of the overlapping seeds; half of it for pairs with a ghost.
    virtual double seed_energy(const ParticleView& particles, const NeighbourView& list) const = 0;

    /// Whether add_forces() finds the velocities with which the particles go on, and writes them (PairStep::velocity),
    /// instead of forces that accelerate them.
    virtual bool finds_velocities() const { return false; }
    /// Of such a kernel: how long its velocities are good for [s]; a step may have to be made in parts.
    virtual double interval() const { return 0; }
    /// Of such a kernel: whether a step that it cannot make at once is made in parts; while a sample comes to rest,
    /// time does not count, and it is cut short.
    virtual bool keeps_time() const { return true; }
    /// What such a kernel has done so far, the same on every process; null: it does one pass in each step.
    virtual const FlowWork* work() const { return nullptr; }
    void set_surroundings(const FlowSurroundings* surroundings) { surroundings_ = surroundings; }

    /// Numbers of a particle that its ghosts on other processes need between two passes of add_forces(); 0: none.
    virtual int exchanged() const { return 0; }
    /// How many of them the present exchange carries.
    virtual int carried() const { return exchanged(); }
    virtual void pack(int /*i*/, double* /*numbers*/) const {}
    virtual void unpack(int /*i*/, const double* /*numbers*/) {}
    /// @param exchange  brings those of each ghost, by pack() and unpack(); collective
    void set_exchange(std::function<void()> exchange) { exchange_ = std::move(exchange); }

    /// Calls use(i, j) for every pair that may be in the crown: those of two particles of this process once, those
    /// with a ghost with i of this process.
    template <class Use>
    void for_each_pair(const NeighbourView& list, Use use) const {
        if (const PackedParticles* const own = packed()) {
            own->list().for_each_pair(use);
            return;
        }
        for (int row = 0; row < list.row_count; ++row)
            for (int entry = 0, i = list.rows[row]; entry < list.lengths[i]; ++entry)
                use(i, list.neighbours[i][entry] & list.index_mask);
    }

 protected:
    void exchange() const { exchange_(); }
    const FlowSurroundings& surroundings() const { return *surroundings_; }

    /// Of seeds that overlap as springs do.
    /// @param seeds  (i, j) to {sum of the seed radii, stiffness}
    template <class Seeds>
    double spring_energy(const ParticleView& particles, const NeighbourView& list, Seeds seeds) const {
        double energy = 0;
        for_each_pair(list, [&](int i, int j) {
            double squared = 0;
            for (int axis = 0; axis < 3; ++axis)
                squared += std::pow(particles.position[3 * i + axis] - particles.position[3 * j + axis], 2);
            const auto [distance, stiffness] = seeds(i, j);
            if (squared >= distance * distance) return;
            // A pair across a process boundary is seen from both sides.
            const double share = j < particles.local_count ? 1.0 : 0.5;
            energy += share * 0.5 * stiffness * std::pow(distance - std::sqrt(squared), 2);
        });
        return energy;
    }

 private:
    std::function<void()> exchange_;
    const FlowSurroundings* surroundings_ = nullptr;
};

inline void PairKernel::add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep&,
                                   double* forces, ContactMemory*, const UsePair* use) {
    pair_forces(particles, list, nullptr, [&](int i, int j, const double* force, const double* apart) {
        for (int c = 0; c < 3; ++c) {
            forces[3 * i + c] += force[c];
            if (j < particles.local_count) forces[3 * j + c] -= force[c];
        }
        if (use != nullptr) (*use)(i, j, force, apart);
    });
}

}  // namespace tomodem::plugin
