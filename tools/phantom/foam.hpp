#pragma once
#include <vector>

#include "core/volume/volume.hpp"
#include "tools/phantom/spheres.hpp"

namespace tomodem::phantom {

struct Strut {
    Vec3 from, to;
};

/// Edges of the Voronoi cells of the points of a body-centred cubic lattice (Kelvin's tetrakaidecahedra), each moved by
/// up to `irregularity` times half the distance to its neighbours.
///
/// @param edges  of the box to fill [mm]; cells around it are made as well, so that its faces cut through the foam
/// @param cell   edge of the cube that holds two cells [mm]
std::vector<Strut> foam_struts(const Vec3& edges, double cell, double irregularity, Random& random,
                               Reporter& reporter = silent_reporter());

struct Foam {
    LabelVolume volume;         ///< 1 in the struts, 0 elsewhere; the solid is one component (faces)
    double strut_radius = 0.0;  ///< mm
    std::int64_t solid_voxels = 0;
    std::int64_t removed_voxels = 0;  ///< of bits of struts that the faces had cut off
};

/// Round struts of one radius, solved so that the solid takes `relative_density` of the voxels (within 1e-4).
/// @throws InvalidInput if the struts would be too thin for the voxels to hold together
/// @note   4 bytes a voxel for the distances beside the volume
Foam draw_foam(const std::vector<Strut>& struts, VoxelIndex size, double voxel_size, double relative_density,
               int threads, Reporter& reporter = silent_reporter());

}  // namespace tomodem::phantom
