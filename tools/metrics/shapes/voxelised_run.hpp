#pragma once
#include <cstdint>
#include <functional>

#include "core/mesh/mesh.hpp"
#include "core/packing/packing.hpp"
#include "core/surface/alpha_surface.hpp"
#include "core/volume/volume.hpp"

/// A frame of a run as a label image: what a tomograph would see of it.
namespace tomodem::shapes {

/// The voxels of an image.
struct Grid {
    VoxelIndex size{};
    Vec3 spacing = Vec3::Ones(), origin = Vec3::Zero();  ///< mm; of the corner of the first voxel
};

struct VoxelisedRun {
    LabelVolume species;  ///< of the nearest particle, 0: void
    LabelVolume object;   ///< of the same particle, 0: of no object
    double matter = 0.0;  ///< volume of all matter, on the grid or not [mm^3]
};

/// A voxel is matter where its centre lies within the alpha shape of all particles (a probe of one diameter) moved to
/// where the material ends; it then has the labels of the nearest particle.
///
/// @param packing  its positions are those of the frame
/// @param surface  surface_of_all of them
VoxelisedRun voxelise(const Packing& packing, const AlphaSurface& surface, const Grid& grid, int threads);

/// Calls row(j, k, i0, i1) for the voxels i0 .. i1 - 1 of each row whose centres lie in a closed surface, which may
/// cross itself: a point is inside where the surface goes around it more often outward than inward.
///
/// Slices are shared by the threads; the calls for one slice come from one of them.
using RowVisit = std::function<void(std::int32_t, std::int32_t, std::int32_t, std::int32_t)>;
void for_each_row_inside(const TriangleMesh& mesh, const Grid& grid, int threads, const RowVisit& row);

}  // namespace tomodem::shapes
