#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "core/packing/packing.hpp"

namespace tomodem::packgen {

/// Densities that compact() accepts: below, particles hardly meet; above, contacts leave the range of a linear law.
inline constexpr double lowest_density = 0.1;
inline constexpr double highest_density = 0.85;
/// Standard deviation of the radii over their mean.
inline constexpr double highest_dispersion = 0.2;
/// Longest over shortest edge of the box.
inline constexpr double highest_aspect = 100.0;

/// The packing wanted, and how it is made.
struct Compaction {
    std::int64_t particles = 0;
    double density = 0.0;      ///< D: volume of the spheres, each by itself, over that of the box
    double seed_radius = 0.5;  ///< r_s, the mean radius [mm]
    double dispersion = 0.0;   ///< standard deviation of the radii over their mean; normal, cut at three of them
    std::array<double, 3> aspect{1.0, 1.0, 1.0};     ///< edges of the box in proportion
    std::array<bool, 3> periodic{true, true, true};  ///< otherwise flat walls that the spheres touch
    std::int64_t random_seed = 1;
    int threads = 1;  ///< the result does not depend on it
    /// Prescribed rate of the true strain of an edge, unit sqrt(k / m).
    double rate = 2e-3;
    /// At rest when the net forces (root mean square) are this small against the mean load, or negligible (1e-6 k d).
    double max_residual = 1e-3;
    std::int64_t max_steps = 500'000;           ///< of the relaxation
    std::function<void(double)> progress = {};  ///< called with the fraction done, on the calling thread
};

/// A packing at rest.
struct CompactedPacking {
    Packing packing;
    std::int64_t steps = 0;  ///< force evaluations
    double residual = 0.0;   ///< net force on a particle, root mean square, unit k d
    double load = 0.0;       ///< mean over the particles of the sum of |f| over their contacts, unit k d
};

/// Random dense packing of spheres: random points, isotropic compaction under linear repulsion
/// f = k (r_i + r_j - h), h < r_i + r_j, at constant strain rate with viscous drag, then relaxation at the final
/// density.
///
/// The box starts at the origin; its volume is that of the spheres over D. A wall pushes with k times the depth that a
/// sphere has in it. Drawn radii are normal deviates cut at three standard deviations, then shifted and stretched to
/// have exactly the mean and the standard deviation asked for. Species 1; ids 1 ... N follow the Morton curve, so
/// particles with close ids are neighbours. The same Compaction gives the same bits on any number of threads and any
/// x86-64 processor.
///
/// @throws InvalidInput if the density is out of range, an edge is shorter than three crown radii (r_c = 1.5 r)
///                      of the largest sphere, or the packing does not come to rest in max_steps
/// @note   time O(N), about 350 bytes a particle
/// @see    thesis section 9.3; the relaxation is FIRE: Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201
CompactedPacking compact(const Compaction& wanted);

}  // namespace tomodem::packgen
