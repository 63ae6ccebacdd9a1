#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver_plugin/norton/flow_pairs.hpp"
#include "solver_plugin/norton/flow_state.hpp"
#include "solver_plugin/norton/law_at_rate.hpp"
#include "solver_plugin/norton/repulsions.hpp"
#include "solver_plugin/norton/wall_films.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// The forces of law NORTON between particles that stand still for a moment, as a function of their velocities
/// (docs/norton.md): what a quasi-static step solves.
///
/// The elastic part is that of the end of an interval in which the particles move with the velocities (semi-implicit):
/// it would be unstable at steps this long otherwise.
///
/// Vectors have a Four for every particle; ghosts follow those of this process.
class FlowForces {
 public:
    using Carry = FilmBalance::Carry;

    void set_law(const law::Norton& law) { law_.set(law); }
    const law::Norton& law() const { return law_.law(); }
    void set_carry(Carry carry) { carry_ = std::move(carry); }

    /// Of the load now, which films and elastic parts go by; before place() [1/s].
    void set_rate(double rate) { law_.set_rate(rate); }
    /// Skin of the pairs, for particles that move little from one place() to the next [mm].
    void set_skin(double skin) { pairs_.set_skin(skin); }
    /// Pairs, fabric and pressure where the particles are now; after it comes correct().
    /// @param renumbered  whether particles or ghosts are others than in the call before
    void place(const ParticleView& particles, bool renumbered = true);
    /// How long the particles will move with the velocities that are sought [s].
    void set_interval(double interval) { interval_ = static_cast<float>(interval); }
    /// The walls near the particles: none after place().
    void set_walls(const std::vector<NearWall>& walls) { films_.set(law_, walls, type_); }
    /// What goes by the flow but is not found anew with every velocity: the weights of pairs of two phases, and what is
    /// taken from the tractions (docs/norton.md).
    /// @param velocity  about as they will be, ghosts included
    void correct(const Four* velocity);
    /// Evaluations that correct() takes.
    int passes_of_a_correction() const { return law().materials.size() > 1 && !law().at_rest ? 3 : 1; }

    /// Forces with these velocities; the viscosities that they make are used by product() and prepare_blocks() from
    /// here on.
    /// @param velocity  of the particles, ghosts included
    void find(const Four* velocity);
    /// What correct() and find() do at the same velocities, with one flow less to find; without walls.
    void find_corrected(const Four* velocity);
    /// Of the particles: net force of pairs and walls [uN]; the fourth is the sum of the magnitudes of the pairs'
    /// viscous parts.
    const Four* net() const { return net_.data(); }

    /// Change of the forces with a change of the velocities, at frozen viscosities; negative, so that it opposes.
    /// @param direction  of the particles; room for the ghosts behind, which are brought
    void product(Four* direction);
    /// Of the last product: change of the net force.
    const Four* change() const { return net_.data(); }

    /// Of all particles, at the viscosities of the last find().
    void prepare_blocks(std::vector<FlowBlock>& blocks);

    /// Of a wall on a particle along its normal, in the last find(), repulsion positive [uN].
    double wall_force(const WallContact& contact) const;
    /// The films at the planes for an explicit step, which finds their forces itself: set_walls() knows nothing of
    /// them. After find_corrected(), by whose weights the flow at the face is seen.
    /// @param planes  FlowSurroundings::planes()
    void lay_films(const std::vector<NearWall>& planes, FilmBalance& films) {
        films_.lay(
            law_, planes, type_, pairs_, fabrics_.data(), [this](std::uint32_t k) { return weight(k); }, films);
    }
    /// Of films that are solved: their part of the pairs' forces, for for_each_force() alone.
    void add_to_tractions(const FilmBalance& films) { films_.add_to_states(films, states_.data()); }
    /// Of the film at a wall and of the repulsion behind its face, together [uN.s/mm]; by the walls' order.
    double wall_stiffness(std::size_t wall) const { return films_.stiffness(wall, interval_); }
    /// Of the last find().
    double viscosity(int i) const { return states_[static_cast<std::size_t>(i)].viscosity(); }
    double strength(int i) const { return fabrics_[static_cast<std::size_t>(i)].strength(); }

    /// Every pair with its force in the last find(), for velocities that are those of it.
    void for_each_force(const Four* velocity, const PairKernel::UsePair& use) const;
    /// Elastic energy of overlapping cores; half of it for pairs with a ghost.
    double core_energy() const { return repulsions_.energy(local_count_); }

 private:
    void sum_fabric();
    void find_geometry();
    void find_fabric();
    void add_moments(const Four* velocity);
    void find_states(bool fresh_viscosity);
    void find_flow(const Four* velocity);
    void weigh();
    void sum_virials(const Four* velocity);
    void add_pair_forces(const Four* velocity);
    void add_forces(const Four* velocity);
    void add_changes(const Four* direction);
    void add_block_parts(std::vector<FlowBlock>& blocks) const;
    void clear_sums();
    /// Of pair k's particle in the flow; its neighbour's is 2 less that.
    float weight(std::uint32_t k) const { return weights_.empty() ? 1 : weights_[k]; }

    LawAtRate law_;
    Carry carry_;
    float interval_ = 0;
    int local_count_ = 0, count_ = 0;
    std::vector<std::uint8_t> type_;  ///< of the particles, from 0
    FlowPairs pairs_;
    Repulsions repulsions_;
    WallFilms films_;
    std::vector<float> damping_;  ///< of each pair [uN.s/mm]
    std::vector<float> weights_;  ///< of each pair; empty where there is one material
    /// Of each particle: columns of what is taken from its traction.
    struct Correction {
        Four column[3];
    };
    std::vector<Correction> corrections_;
    std::vector<FlowFabric> fabrics_;
    std::vector<FlowSums> sums_;
    std::vector<FlowState> states_;
    std::vector<Four> net_;
};

}  // namespace tomodem::plugin
