#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/law/norton_law.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"
#include "solver_plugin/quasi_static/film_balance.hpp"
#include "solver_plugin/quasi_static/flow_pairs.hpp"
#include "solver_plugin/quasi_static/four.hpp"

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

    void set_law(const law::Norton& law) {
        law_ = law;
        set_rate(law.flow_rate);
    }
    const law::Norton& law() const { return law_; }
    void set_carry(Carry carry) { carry_ = std::move(carry); }

    /// Of the load now, which films and elastic parts go by; before place() [1/s].
    void set_rate(double rate);
    /// Skin of the pairs, for particles that move little from one place() to the next [mm].
    void set_skin(double skin) { pairs_.set_skin(skin); }
    /// Pairs, fabric and pressure where the particles are now; after it comes correct().
    /// @param renumbered  whether particles or ghosts are others than in the call before
    void place(const ParticleView& particles, bool renumbered = true);
    /// How long the particles will move with the velocities that are sought [s].
    void set_interval(double interval) { interval_ = static_cast<float>(interval); }
    /// The walls near the particles.
    void set_walls(const std::vector<NearWall>& walls);
    /// What goes by the flow but is not found anew with every velocity: the weights of pairs of two phases, and what is
    /// taken from the tractions (docs/norton.md).
    /// @param velocity  about as they will be, ghosts included
    void correct(const Four* velocity);
    /// Evaluations that correct() takes.
    int passes_of_a_correction() const { return law_.materials.size() > 1 && !law_.at_rest ? 3 : 1; }

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

    /// The 3 x 3 blocks of particles with themselves: {xx, yy, zz, -}, {xy, yz, zx, -}.
    struct Block {
        Four diagonal, off;
    };
    void prepare_blocks(std::vector<Block>& blocks);

    /// Sum of f_a r_a over this process' share of the pairs in the last find() [uN mm]; a = x, y, z.
    Four virial() const { return virial_; }
    /// Of a wall on a particle along its normal, in the last find(), repulsion positive [uN].
    double wall_force(const WallContact& contact) const;
    /// The films at the planes for an explicit step, which finds their forces itself: set_walls() knows nothing of
    /// them. After find_corrected(), by whose weights the flow at the face is seen.
    /// @param planes  FlowSurroundings::planes()
    void lay_films(const std::vector<NearWall>& planes, FilmBalance& films);
    /// Of films that are solved: their part of the pairs' forces, for for_each_force() alone.
    void add_to_tractions(const FilmBalance& films);
    /// Of the film at a wall and of the repulsion behind its face, together [uN.s/mm]; by the walls' order.
    double wall_stiffness(std::size_t wall) const { return films_[wall].damping + interval_ * films_[wall].stiffness; }
    /// Of the last find().
    double viscosity(int i) const { return states_[static_cast<std::size_t>(i)].traction[1][3]; }
    double strength(int i) const { return fabrics_[static_cast<std::size_t>(i)].inverse[2][3]; }

    /// Every pair with its force in the last find(), for velocities that are those of it.
    void for_each_force(const Four* velocity, const PairKernel::UsePair& use) const;
    /// Elastic energy of overlapping cores; half of it for pairs with a ghost.
    double core_energy() const;
    std::size_t pairs() const { return pairs_.size() + pairs_.pushing().size(); }

 private:
    /// What the positions alone make of a particle.
    struct Fabric {
        Four inverse[3];  ///< rows of A*^-1 [1/mm^2]; fourths: pressure [uN], eta [Pa.s], strength [Pa]
        Four outward;     ///< n / sqrt(n^2 + n_0^2); the fourth is w, from 0 at a surface to 1
    };
    /// Between a particle and a wall: a viscous film at the wall's face, half a diameter before it, and a repulsion
    /// behind that.
    struct Film {
        std::int32_t particle;
        Four normal;
        float velocity, depth;  ///< of the wall; of the particle's centre behind the face
        float damping, stiffness;
        float slip;  ///< of the sample at the face, in the last pass
    };
    struct Sums {
        Four moment[3];  ///< rows of sum v r
        Four outward;    ///< change of n; the fourth: of rho
    };
    struct State {
        Four traction[3];  ///< columns of T; fourths: pressure, eta, unused
        Four diagonal;     ///< of D
        Four off;          ///< 2 D_xy, 2 D_yz, 2 D_zx
        Four lateral;      ///< a_n p n / sqrt(n^2 + n_0^2)
    };
    struct Core {
        std::uint32_t pair, row;
        float stiffness, overlap;
    };

    void sum_fabric();
    void find_geometry();
    void find_fabric();
    void find_cores();
    void find_pushes();
    /// Of a pair of two objects.
    struct Push {
        float force, stiffness;  ///< now if it acts, and how fast it grows as they come nearer
        float rounding;          ///< of the corner where it begins to act [uN]
        float share;             ///< of the stiffness that acts, from 0 to 1

        /// The force where it would be `straight` if it could pull too; finds the share.
        float at(float straight);
    };

    void add_moments(const Four* velocity);
    void find_states(bool fresh_viscosity);
    void find_flow(const Four* velocity);
    void weigh();
    void sum_virials(const Four* velocity);
    void add_films_to_states(const Four* velocity, bool whole);
    void add_films(const Four* velocity, bool whole);
    float film_damping(int type) const;
    float film_stiffness(int type, double depth) const;
    void add_pair_forces(const Four* velocity);
    float background(const Fabric& fabric) const;
    /// Of pair k's particle in the flow; its neighbour's is 2 less that.
    float weight(std::uint32_t k) const { return weights_.empty() ? 1 : weights_[k]; }
    void add_forces(const Four* velocity);
    void add_changes(const Four* direction);
    void add_cores(const Four* velocity, bool whole);
    void add_pushes(const Four* velocity, bool whole);
    void add_block_parts(std::vector<Block>& blocks) const;
    void clear_sums();

    law::Norton law_;
    Carry carry_;
    float interval_ = 0;
    int local_count_ = 0, count_ = 0;
    std::vector<std::uint8_t> type_;  ///< of the particles, from 0
    FlowPairs pairs_;
    std::vector<Core> cores_;
    std::vector<float> damping_;  ///< of each pair [uN.s/mm]
    std::vector<float> weights_;  ///< of each pair; empty where there is one material
    std::vector<Film> films_;
    std::vector<std::int32_t> film_of_;  ///< a film of each particle, or -1
    double rate_ = 0;                    ///< of the load now [1/s]
    std::vector<double> strengths_;      ///< by material, at that rate [Pa]
    /// Of each particle: columns of what is taken from its traction.
    struct Correction {
        Four column[3];
    };
    std::vector<Correction> corrections_;
    std::vector<Push> pushes_;
    std::vector<Four> levers_;  ///< of the films of an explicit step; fourths: sum of the neighbours' shares
    std::vector<Fabric> fabrics_;
    std::vector<Sums> sums_;
    std::vector<State> states_;
    std::vector<Four> net_;
    Four virial_{};
};

}  // namespace tomodem::plugin
