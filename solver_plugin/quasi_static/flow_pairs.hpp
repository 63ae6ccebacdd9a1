#pragma once
#include <cstdint>
#include <vector>

#include "solver_plugin/pairs/pair_search.hpp"
#include "solver_plugin/pairs/particle_view.hpp"
#include "solver_plugin/quasi_static/four.hpp"

namespace tomodem::plugin {

/// The pairs of particles in each other's crown at one moment, each once; those with a ghost from the particle of this
/// process. Row by row: the pairs of one particle follow one another.
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

    /// @param reach  of the crown [mm]
    void find(const ParticleView& particles, double reach);

    /// One more than there are particles with pairs.
    const std::vector<Row>& rows() const { return rows_; }
    const std::int32_t* other() const { return other_.data(); }
    /// Vector from the other to the particle [mm]; the fourth is its length.
    const Four* apart() const { return apart_.data(); }
    std::size_t size() const { return other_.size(); }
    const std::vector<Pushing>& pushing() const { return pushing_; }

 private:
    PairSearch search_;
    std::vector<std::int32_t> found_;
    std::vector<Row> rows_;
    std::vector<std::int32_t> other_;
    std::vector<Four> apart_;
    std::vector<Pushing> pushing_;
};

}  // namespace tomodem::plugin
