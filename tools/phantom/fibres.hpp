#pragma once
#include <cstdint>
#include <vector>

#include "tools/phantom/foam.hpp"

namespace tomodem::phantom {

/// Straight fibres through a box, at random places and in random directions, each longer than the box. draw_foam makes
/// a volume of them, in which fibres that cross are joined.
///
/// @param edges         of the box [mm]
/// @param out_of_plane  0: all lie in x-y planes; 1: every direction is equally likely; between them, the part along z
///                      of a random direction is multiplied by it
std::vector<Strut> fibre_struts(const Vec3& edges, std::int64_t count, double out_of_plane, Random& random);

}  // namespace tomodem::phantom
