#pragma once
#include <cstdint>
#include <functional>

#include "core/packing.hpp"

namespace tomodem::packgen {

/// Densities that compact() accepts: below, particles hardly meet; above, contacts leave the range of a linear law.
inline constexpr double lowest_density = 0.1;
inline constexpr double highest_density = 0.85;

/// The packing wanted, and how it is made.
struct Compaction {
    std::int64_t particles = 0;
    double density = 0.0;      ///< D = N pi d^3 / (6 V), d = 2 r_s
    double seed_radius = 0.5;  ///< r_s [mm]
    std::int64_t random_seed = 1;
    int threads = 1;  ///< the result does not depend on it
    /// Prescribed rate of the true strain of an edge, unit sqrt(k / m).
    double rate = 2e-3;
    /// At rest when the net forces (root mean square) are this small against the mean load, or negligible (1e-6 k d).
    double max_residual = 1e-3;
    std::int64_t max_steps = 500'000;           ///< of the relaxation
    std::function<void(double)> progress = {};  ///< called with the fraction done, on the calling thread
};

/// A periodic cubic packing at rest.
struct CompactedPacking {
    Packing packing;
    std::int64_t steps = 0;  ///< force evaluations
    double residual = 0.0;   ///< net force on a particle, root mean square, unit k d
    double load = 0.0;       ///< mean over the particles of the sum of |f| over their contacts, unit k d
};

/// Random dense packing of equal spheres: random points, isotropic compaction under linear repulsion
/// f = k (d - h), h < d, at constant strain rate with viscous drag, then relaxation at the final density.
///
/// The box is [0, L]^3 with L = (N pi d^3 / (6 D))^(1/3), periodic; species 1; ids 1 ... N follow the Morton curve,
/// so particles with close ids are neighbours. The same Compaction gives the same bits on any number of threads and
/// any x86-64 processor.
///
/// @throws InvalidInput if the density is out of range, the box is shorter than three crown radii (r_c = 1.5 r_s), or
///                      the packing does not come to rest in max_steps
/// @note   time O(N), about 350 bytes a particle
/// @see    thesis section 9.3; the relaxation is FIRE: Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201
CompactedPacking compact(const Compaction& wanted);

/// What the contacts (h < d) of a periodic packing look like.
struct ContactStatistics {
    std::int64_t contacts = 0;
    double mean_coordination = 0.0;  ///< contacts of a particle
    double max_overlap = 0.0;        ///< 1 - h / d
    double mean_overlap = 0.0;       ///< over the contacts; 0 without any
};

/// @param packing  fully periodic cubic box of at least 2 d
ContactStatistics contact_statistics(const Packing& packing);

}  // namespace tomodem::packgen
