#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace tomodem::packgen {

/// Three coordinates padded to one vector register.
struct alignas(32) Row {
    double x = 0.0, y = 0.0, z = 0.0, unused = 0.0;
};

/// Neighbours of consecutive particles; four entries a block, filled up with the particle itself.
struct NeighbourBlocks {
    const std::int32_t* entries;       ///< all blocks, one particle after the other
    const std::uint32_t* first_block;  ///< [count + 1]
    const std::uint8_t* at_boundary;   ///< [count] 1: a neighbour may be a periodic image
};

/// What the step control needs to know of one chunk.
struct ForceSums {
    double force_velocity = 0.0;  ///< sum of F . u
    double force_squared = 0.0;
    double velocity_squared = 0.0;
    double load = 0.0;  ///< sum over particles and their contacts of |f|: twice that over the contacts
};

/// Contact forces F_i = sum_j max(0, 1 - h_ij / d) e_ji (unit k d) on particles first ... first + count - 1.
///
/// Positions are fractions of the box edge. Every particle gathers the force of all its neighbours in the order of
/// the list, in four partial sums, so a result depends neither on threads nor on the instruction set: the AVX2 and
/// the baseline version do the same IEEE operations in the same order (no fused multiply-add).
///
/// @param diameter  d over the edge of the box
/// @param velocity  only for the sums
ForceSums contact_forces(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                         const NeighbourBlocks& neighbours, double diameter);

/// Which version contact_forces runs; a test compares both.
enum class InstructionSet { best, baseline };
void use_instruction_set(InstructionSet choice);

}  // namespace tomodem::packgen
