#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver_plugin/norton/four.hpp"
#include "solver_plugin/pairs/pair_search.hpp"
#include "solver_plugin/pairs/particle_view.hpp"

namespace tomodem::plugin {

/// The pairs of particles in each other's crown at one moment, each once; those with a ghost from the particle of this
/// process. Row by row: the pairs of one particle follow one another.
///
/// They are searched for within the reach and a skin, and taken from what was found as long as no particle has moved by
/// half of the skin since.
class FlowPairs {
 public:
    struct Row {
        std::int32_t particle;
        std::uint32_t begin;  ///< of its pairs; they end where the next row's begin
    };
    /// Of two objects: it has no flow in common, and only pushes.
    struct Pushing {
        std::int32_t particle, other;
        Four apart;
    };

    /// @param skin  [mm]; 0, the default: each find() searches
    void set_skin(double skin) { skin_ = skin; }
    /// @param reach       of the crown [mm]
    /// @param renumbered  whether particles or ghosts are others than in the call before
    void find(const ParticleView& particles, double reach, bool renumbered = true);

    /// One more than there are particles with pairs.
    const std::vector<Row>& rows() const { return rows_; }
    const std::int32_t* other() const { return other_.data(); }
    /// Vector from the other to the particle [mm]; the fourth is its length.
    const Four* apart() const { return apart_.data(); }
    std::size_t size() const { return rows_.back().begin; }
    const std::vector<Pushing>& pushing() const { return pushing_; }
    /// How often the pairs were searched for.
    std::int64_t searches() const { return searches_; }

 private:
    struct Pair {
        std::int32_t particle, other;
    };

    bool strayed(const ParticleView& particles) const;
    void search(const ParticleView& particles, double reach);
    void measure(const ParticleView& particles, double reach);

    double skin_ = 0, searched_reach_ = 0;  ///< the latter with the skin
    std::int64_t searches_ = 0;
    PairSearch search_;
    std::vector<std::int32_t> found_;
    std::vector<float> searched_at_;  ///< 3 per particle; the search allows for single precision
    /// What was found: of one object row by row, and of two objects.
    std::vector<Row> near_rows_;
    std::vector<std::int32_t> near_;
    std::vector<Pair> near_pushing_;

    std::vector<Row> rows_{{-1, 0}};
    std::vector<std::int32_t> other_;  ///< with room for all that are near
    std::vector<Four> apart_;
    std::vector<Pushing> pushing_;
};

}  // namespace tomodem::plugin
