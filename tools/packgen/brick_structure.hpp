#pragma once
#include "core/packing/structure.hpp"

namespace tomodem::packgen {

/// How random a brick is.
struct BrickStructure {
    ContactStatistics contacts;
    RadialDistribution distribution;  ///< of the centres, up to 5 d where the box allows
    double bond_cutoff = 0.0;         ///< of q6: first minimum of g(r); 1.4 d in a box too short for that [mm]
    double fcc = 0.0, hcp = 0.0, bcc = 0.0, icosahedral = 0.0;  ///< shares of the particles
    double mean_q6 = 0.0, global_q6 = 0.0;
    double solid_like = 0.0;  ///< share of the particles with at least solid_like_connections
    double crystalline() const { return fcc + hcp + bcc; }
};

/// Bonds whose ends' q6m have a normalised product above this are solid-like, and particles with that many of them: the
/// values for nuclei of hard spheres in Filion et al., J. Chem. Phys. 133 (2010) 244115.
inline constexpr double solid_like_product = 0.7;
inline constexpr int solid_like_connections = 7;

/// @param packing  has walls along the axes that are not periodic; particles at a wall lack neighbours, so they count
/// as
///                 not crystalline, and g(r) is that of the region that centres can reach
BrickStructure structure_of(const Packing& packing, int threads = 1);

}  // namespace tomodem::packgen
