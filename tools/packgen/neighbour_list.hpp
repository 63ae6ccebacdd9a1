#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/packgen/contact_force.hpp"
#include "tools/packgen/thread_team.hpp"

namespace tomodem::packgen {

/// Full neighbour lists in a periodic unit cube, in chunks of consecutive particles that are built independently.
///
/// The order of the neighbours depends on the positions only. Time O(N) when the cutoff is short against the box.
class NeighbourList {
 public:
    static constexpr std::size_t chunk_size = 128;

    /// Wraps the positions into [0, 1), sorts the particles by cell (rows that travel with them too), and lists for
    /// each particle all others whose nearest image is closer than the cutoff.
    ///
    /// @param travellers  an array of the same length that is sorted along
    /// @param cutoff      fraction of the box edge, at most 1/2
    void build(std::vector<Row>& position, std::vector<Row>& travellers, double cutoff, ThreadTeam& team);

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
    void sort_by_cell(std::vector<Row>& position, std::vector<Row>& travellers, ThreadTeam& team);
    void fill(Chunk& chunk, std::size_t first, std::size_t count, const std::vector<Row>& position) const;
    std::size_t near_cells(const std::vector<Row>& position, std::size_t i, std::vector<std::int32_t>& found) const;
    std::size_t near_all(const std::vector<Row>& position, std::size_t i, std::vector<std::int32_t>& found) const;

    double cutoff_ = 0.0;
    int cells_ = 0;  // along an edge; fewer than 3: no cells, all pairs
    std::vector<std::int32_t> cell_of_, order_;
    std::vector<std::int32_t> cell_start_;
    std::vector<Row> sorted_;
    std::vector<Chunk> chunks_;
};

}  // namespace tomodem::packgen
