#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"

/// How much of the space that a structure takes up its solid fills. No lid and no envelope is needed, so all of it
/// changes steadily as the structure deforms (docs/measures.md, "Relative density").
namespace tomodem {

struct Filling {
    double particle = 0.0;  ///< mm^3 of a particle with its share of the gaps, mean; 0: too few lie together to tell
    double solid = 0.0;     ///< mm^3, of all particles; 0: not known
    double hull = 0.0;      ///< mm^3 of the convex hull, up to where the material ends
};

/// The share of a particle is measured where particles lie close together: in the Delaunay tetrahedra whose
/// circumradius is at most 1.6 seed radii, the volume over the part of the particles in it (the solid angles of their
/// corners). Unlike a mean over the particles deep inside, it holds for struts of two or three particles.
/// @param centres      [mm]; in one plane, or fewer than four: all is 0
/// @param seed_radius  [mm]
/// @note  O(N log N), some 5 us a particle
Filling filling_of(std::span<const Vec3> centres, double seed_radius);

/// Which particles hang together in groups of at least `smallest_group`, over distances of up to two diameters. The
/// others have come loose; a single one far away would stretch the convex hull over nothing.
/// @return  indices, increasing; all where no group is that large
std::vector<std::int32_t> without_loose(std::span<const Vec3> centres, double seed_radius, int threads = 1);
inline constexpr std::int64_t smallest_group = 20;

/// The centres of these particles.
std::vector<Vec3> centres_of(std::span<const Vec3> centres, std::span<const std::int32_t> which);

/// An open structure, as of fibres or struts, fills less than half of its convex hull.
bool is_open(const Filling& filling);

}  // namespace tomodem
