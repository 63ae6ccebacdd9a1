#pragma once
#include <span>
#include <vector>

#include "core/packing.hpp"
#include "tools/metrics/object_shapes.hpp"

namespace tomodem {

/// The volume that a particle of an object stands for.
enum class ShareOf {
    own,     ///< mean over the particles inside that object: its corrected volume, as mesh_recon gives it
    others,  ///< mean over those inside the other objects: the object has too few inside
    box,     ///< box volume over all particles: no object has enough
};
const char* name_of(ShareOf share);

struct ObjectVolume {
    double volume = 0.0;  ///< its particles times that share [mm^3]
    ShareOf share = ShareOf::box;
};

/// Volume of each object up to where its material ends, at one frame.
/// @param position   of all particles
/// @param box_share  mm^3 a particle, where nothing better is known
/// @note  one Delaunay triangulation an object, about 7 us a particle
std::vector<ObjectVolume> object_volumes(std::span<const Vec3> position, std::span<const Object> objects,
                                         double seed_radius, double box_share);

}  // namespace tomodem
