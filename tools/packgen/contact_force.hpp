#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tomodem::packgen {

/// Three coordinates and what fills a vector register: with a position, the radius over the mean diameter d.
struct alignas(32) Row {
    double x = 0.0, y = 0.0, z = 0.0, radius = 0.0;
};

/// The box, in the unit of the positions: its shortest edge.
struct Region {
    std::array<double, 3> edges{1.0, 1.0, 1.0};
    std::array<bool, 3> periodic{true, true, true};  ///< otherwise flat walls
    bool equal_radii = true;                         ///< all d / 2, whatever the rows say

    double volume() const { return edges[0] * edges[1] * edges[2]; }
    bool has_walls() const { return !(periodic[0] && periodic[1] && periodic[2]); }
    /// The difference of two coordinates along an axis, of the nearest images.
    double nearest(int axis, double difference) const {
        return periodic[axis] ? difference - edges[axis] * std::nearbyint(difference / edges[axis]) : difference;
    }
};

/// Neighbours of consecutive particles; four entries a block, filled up with the particle itself.
struct NeighbourBlocks {
    const std::int32_t* entries;       ///< all blocks, one particle after the other
    const std::uint32_t* first_block;  ///< [count + 1]
    const std::uint8_t* at_boundary;   ///< [count] 1: a neighbour may be a periodic image
};

/// Sums over the particles of a chunk, for the control of the time step.
struct ForceSums {
    double force_velocity = 0.0;  ///< sum of F . u
    double force_squared = 0.0;
    double velocity_squared = 0.0;
    double load = 0.0;  ///< sum over particles and their contacts of |f|: twice that over those between particles
};

/// Contact forces F_i = sum_j max(0, r_i + r_j - h_ij) e_ji (unit k d, lengths over d) on particles first ... first +
/// count - 1; a wall pushes with r_i less its distance from the centre. Every particle gathers the force of all its
/// neighbours in the order of the list, in four partial sums, so a result depends neither on threads nor on the
/// instruction set: the AVX2 and the baseline version do the same IEEE operations in the same order (no fused
/// multiply-add).
///
/// @param diameter  d over the shortest edge of the box
/// @param velocity  only for the sums
ForceSums contact_forces(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                         const NeighbourBlocks& neighbours, double diameter, const Region& region = {});

/// Which version contact_forces runs; a test compares both.
enum class InstructionSet { best, baseline };
void use_instruction_set(InstructionSet choice);

}  // namespace tomodem::packgen
