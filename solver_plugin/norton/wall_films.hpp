#pragma once
#include <cstdint>
#include <vector>

#include "solver_plugin/norton/film_balance.hpp"
#include "solver_plugin/norton/flow_pairs.hpp"
#include "solver_plugin/norton/flow_state.hpp"
#include "solver_plugin/norton/law_at_rate.hpp"

namespace tomodem::plugin {

/// What walls do to a sample: a viscous film at each wall's face, half a diameter before it, and a repulsion behind
/// that. The film acts where the sample meets the face, on the velocity of a particle's centre extrapolated by its own
/// flow; so a part of its force is a part of the particle's traction.
class WallFilms {
 public:
    /// A film of a particle of this process.
    struct Film {
        std::int32_t particle;
        Four normal;
        float velocity, depth;  ///< of the wall; of the particle's centre within the sample
        float damping, stiffness;
        float slip;  ///< of the sample at the face, in the last pass
    };

    /// @param material  of the particles, ghosts included, from 0
    void set(const LawAtRate& law, const std::vector<NearWall>& walls, const std::vector<std::uint8_t>& material);

    /// Finds the slips, and adds the films' part of the tractions.
    /// @param whole  with the walls' own velocities; else the change alone
    void add_to_states(const Four* velocity, bool whole, const FlowFabric* fabrics, FlowState* states);
    /// Adds the forces on the particles at the slips that were found.
    /// @param interval  that the particles move [s]
    void add_forces(const Four* velocity, float interval, bool whole, Four* net) const;
    void add_blocks(float interval, FlowBlock* blocks) const;

    const std::vector<Film>& films() const { return films_; }
    /// One of a particle, or null.
    const Film* of(std::int32_t particle) const {
        const std::int32_t film = of_particle_[static_cast<std::size_t>(particle)];
        return film < 0 ? nullptr : &films_[static_cast<std::size_t>(film)];
    }
    /// Of film and repulsion together [uN.s/mm]; by the walls' order.
    double stiffness(std::size_t wall, float interval) const {
        return films_[wall].damping + interval * films_[wall].stiffness;
    }

    /// The films at the planes for an explicit step, which finds their forces itself (FilmBalance): what a neighbour's
    /// velocity along the normal counts in the slip is w_ij r . lever (r from the neighbour to the particle), and the
    /// particle's own 1 less their sum.
    /// @param planes  FlowSurroundings::planes()
    /// @param weight  w_ij of a pair's particle, by the pair
    template <class Weight>
    void lay(const LawAtRate& law, const std::vector<NearWall>& planes, const std::vector<std::uint8_t>& material,
             const FlowPairs& pairs, const FlowFabric* fabrics, Weight weight, FilmBalance& balance) {
        lay_levers(law, planes, material, fabrics, balance);
        const std::vector<FlowPairs::Row>& rows = pairs.rows();
        for (std::size_t row = 0; row + 1 < rows.size(); ++row)
            for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
                add_shares(rows[row].particle, pairs.other()[k], weight(k), pairs.apart()[k], balance);
                add_shares(pairs.other()[k], rows[row].particle, weight(k) - 2, pairs.apart()[k], balance);
            }
        for (std::size_t f = 0; f < levers_.size(); ++f)
            balance.add_share(static_cast<std::uint32_t>(f), balance.films()[f].particle, -levers_[f][3]);
    }
    /// Of films that are solved: their part of the tractions.
    void add_to_states(const FilmBalance& balance, FlowState* states) const;

 private:
    void lay_levers(const LawAtRate& law, const std::vector<NearWall>& planes,
                    const std::vector<std::uint8_t>& material, const FlowFabric* fabrics, FilmBalance& balance);
    void add_shares(std::int32_t particle, std::int32_t neighbour, float weight, Four apart, FilmBalance& balance);

    std::vector<Film> films_;
    std::vector<std::int32_t> of_particle_;  ///< a film of each particle, or -1
    std::vector<Four> levers_;  ///< of the films of an explicit step; fourths: sum of the neighbours' shares
};

}  // namespace tomodem::plugin
