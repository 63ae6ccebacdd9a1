#pragma once
#include <cstdint>
#include <vector>

#include "solver_plugin/norton/flow_pairs.hpp"
#include "solver_plugin/norton/flow_state.hpp"
#include "solver_plugin/norton/law_at_rate.hpp"

namespace tomodem::plugin {

/// The forces of pairs along their line that go by the distance alone: of overlapping cores, and of two objects, which
/// push by core and pressure. They are those of the end of an interval in which the particles move.
class Repulsions {
 public:
    /// Of two particles of one object.
    struct Core {
        std::uint32_t pair;
        std::int32_t particle, other;
        float stiffness, overlap;

        /// @param separation  rate of the distance [mm/s]
        float force(float separation, float interval) const { return stiffness * (overlap - interval * separation); }
    };

    /// Where the particles are now.
    void find(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics);

    /// Adds the forces on both particles.
    /// @param whole     the forces; else their change with the velocities alone, as shares of the last forces go on
    /// @param interval  [s]
    void add(const FlowPairs& pairs, const Four* velocity, float interval, bool whole, Four* net);
    void add_blocks(const FlowPairs& pairs, float interval, FlowBlock* blocks) const;
    /// Adds the cores' part of each particle's half sum of sym(f r), as FlowForces::sum_virials().
    void add_virials(const FlowPairs& pairs, FlowSums* sums) const;

    /// In the order of the pairs.
    const std::vector<Core>& cores() const { return cores_; }
    /// Of the k-th pair of two objects, with these velocities [uN].
    float push(std::size_t k, const FlowPairs& pairs, const Four* velocity, float interval) const;
    /// Of the cores; half of it for pairs with a ghost.
    double energy(int local_count) const;

 private:
    struct Push {
        float force, stiffness;  ///< now if it acts, and how fast it grows as they come nearer
        float rounding;          ///< of the corner where it begins to act [uN]
        float share;             ///< of the stiffness that acts, from 0 to 1

        /// The force where it would be `straight` if it could pull too; finds the share.
        float at(float straight);
    };

    void find_cores(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics);
    void find_pushes(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics);

    std::vector<Core> cores_;
    std::vector<Push> pushes_;
};

}  // namespace tomodem::plugin
