#pragma once
#include <span>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/surface/alpha_surface.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"

namespace tomodem::shapes {

/// The alpha shape of all particles of a frame, by a probe of one diameter.
/// @throws InvalidInput as alpha_surface
AlphaSurface surface_of_all(std::span<const Vec3> position, double seed_radius);

/// The volume of a particle of an object, with its share of the gaps.
enum class ShareOf {
    all,      ///< each its own: all particles of the object are inside the matter
    inside,   ///< the mean of those that are as deep inside as there are enough
    species,  ///< the object has too few inside: the mean over those of its species
    box,      ///< there are too few of those too: box volume over all particles
};
const char* name_of(ShareOf share);

struct ObjectVolume {
    double volume = 0.0;  ///< [mm^3]
    ShareOf share = ShareOf::box;
};

/// Volume of each object up to where its material ends: half way to the particles beside it, or at the edge of all
/// matter (docs/measures.md, corrected volume). The share of a particle is a quarter of each tetrahedron around it.
/// @param surface    surface_of_all at that frame; empty: nothing is enclosed
/// @param box_share  mm^3 a particle, where nothing better is known
std::vector<ObjectVolume> object_volumes(const AlphaSurface& surface, std::span<const Object> objects,
                                         double box_share);

}  // namespace tomodem::shapes
