#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/law/bilin.hpp"

namespace tomodem::plugin {

/// What the vector kernel reads of a process' particles; ghosts follow the local ones. Arrays are not owned.
struct ParticleView {
    const double* position;  ///< 3 per particle
    const double* velocity;  ///< 3 per particle
    const int* type;         ///< from 1
    int local_count;
    int count;  ///< with ghosts
};

/// Half neighbour list of the solver: pairs within crown and skin.
struct NeighbourView {
    int row_count;
    const int* rows;
    const int* lengths;  ///< by particle
    const int* const* neighbours;
    int index_mask;
};

/// BILIN on four pairs at once (AVX2), without branches, on a list of its own.
///
/// The solver's list (crown + skin) is pruned to crown + a smaller inner skin; the pruned list is used until a particle
/// has moved half of that. Positions and velocities are copied to one cache line a particle. Pairs are in blocks of one
/// particle with four neighbours of one class (pair of types), filled up with the particle itself, at distance zero.
class VectorPairs {
 public:
    /// Whether this machine can run the kernel.
    static bool supported();

    /// @param laws        type_count^2 pair constants, row by row
    /// @param inner_skin  in the lengths of the positions
    void set_laws(std::vector<law::Bilin> laws, int type_count, double inner_skin);

    /// Adds the forces of all pairs to those of the local particles.
    /// @param rebuilt  the solver's list is new, or the particles were renumbered
    /// @param forces   3 per local particle
    void add_forces(const ParticleView& particles, const NeighbourView& list, bool rebuilt, double* forces);

    std::int64_t prunings() const { return prunings_; }

 private:
    struct alignas(64) Row {
        double position[4];  // the fourth stays 0: it takes part in the sums
        double velocity[4];
    };
    struct alignas(32) Force {
        double component[4];
    };
    struct Block {
        std::int32_t particle;
        std::int32_t law;
        std::int32_t neighbour[4];
    };
    struct PairConstants {
        double seed_distance, crown_squared, repulsive_stiffness, attractive_stiffness;
    };

    double copy_particles(const ParticleView& particles);
    void prune(const ParticleView& particles, const NeighbourView& list);
    template <bool one_law>
    void compute();

    std::vector<PairConstants> constants_;
    std::vector<double> reach_squared_;
    int type_count_ = 0;
    double inner_skin_ = 0;
    std::vector<Row> rows_;
    std::vector<Force> forces_;
    std::vector<double> pruned_at_;
    std::vector<Block> blocks_;
    std::size_t block_count_ = 0;  // blocks_ has a tail of empty ones, so that prefetching needs no test
    std::vector<std::int32_t> scratch_;
    std::int64_t prunings_ = 0;
};

}  // namespace tomodem::plugin
