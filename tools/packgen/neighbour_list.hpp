#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/packgen/contact_force.hpp"
#include "tools/packgen/thread_team.hpp"

namespace tomodem::packgen {

/// Full neighbour lists in a box, in chunks of consecutive particles that are built independently.
///
/// The order of the neighbours depends on the positions only. Time O(N) when the cutoff is short against the box.
class NeighbourList {
 public:
    static constexpr std::size_t chunk_size = 128;

    /// Wraps the positions into the box along its periodic axes, sorts the particles by cell, and lists for each
    /// particle all others whose nearest image is closer than the cutoff and, where radii differ, closer than (r_i +
    /// r_j) diameter + skin.
    ///
    /// @param attached  rows of the same particles, sorted in the same order
    /// @param cutoff    at most half of the shortest periodic edge
    void build(std::vector<Row>& position, std::vector<Row>& attached, double cutoff, ThreadTeam& team,
               const Region& region = {}, double diameter = 0.0, double skin = 0.0);

    double cutoff() const { return cutoff_; }
    std::size_t chunk_count() const { return chunks_.size(); }
    /// The particles of a chunk start at chunk * chunk_size.
    std::size_t chunk_length(std::size_t chunk) const { return chunks_[chunk].at_boundary.size(); }
    NeighbourBlocks chunk(std::size_t chunk) const;

 private:
    struct Chunk {
        std::vector<std::int32_t> entries;
        std::vector<std::uint32_t> first_block;
        std::vector<std::uint8_t> at_boundary;
    };
    void sort_by_cell(std::vector<Row>& position, std::vector<Row>& attached, ThreadTeam& team);
    void fill(Chunk& chunk, std::size_t first, std::size_t count, const std::vector<Row>& position) const;
    template <bool one_cell, bool equal_radii>
    std::size_t near(const std::vector<Row>& position, std::size_t i, std::vector<std::int32_t>& found) const;
    /// Whether a periodic edge has one cell, so that every pair needs its nearest image.
    bool one_cell() const;

    double cutoff_ = 0.0, diameter_ = 0.0, skin_ = 0.0;
    Region region_;
    std::array<int, 3> cells_{};  // along each edge; one along a periodic edge too short for three
    std::vector<std::int32_t> cell_of_, order_;
    std::vector<std::int32_t> cell_start_;
    std::vector<Row> sorted_;
    std::vector<Chunk> chunks_;
};

}  // namespace tomodem::packgen
