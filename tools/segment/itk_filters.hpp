#pragma once
#include <cstdint>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/volume/grey_volume.hpp"

/// Filters of the library ITK; its headers are in itk_filters.cpp alone. Voxels are in one piece, x fastest.
namespace tomodem::segment {

/// The median of the box of 2 radius + 1 voxels along each axis; beyond a face the voxels of the face are repeated.
std::vector<float> median(const GreyVolume& grey, int radius, int threads, Reporter& reporter);

/// Anisotropic diffusion (Perona & Malik, IEEE Trans. PAMI 12 (1990) 629) in steps of 1/16 voxel^2: it smooths where
/// the grey values are flat and stops at edges.
/// @param edge  gradients beyond this multiple of the mean gradient of the image count as edges
std::vector<float> diffusion(const GreyVolume& grey, int steps, double edge, int threads, Reporter& reporter);

/// The mean of the box of 2 radius + 1 voxels along each axis; what lies beyond a face does not count.
std::vector<float> local_mean(const GreyVolume& grey, int radius, int threads, Reporter& reporter);

/// Parts of a phase, from 1 on.
struct Watershed {
    std::vector<std::int32_t> part;  ///< of each voxel; 0 outside
    std::int32_t count = 0;
};

/// Cuts a phase where it is narrow: a watershed without lines on its distance map (Beucher & Meyer, in: Mathematical
/// Morphology in Image Processing, 1993, 433), flooded from the h-maxima of that map. Neighbours share a face, so that
/// each part is connected and lies in one connected component.
///
/// @param outside    of each voxel: 0 in the phase, 1 elsewhere; faces of the image are no boundary of the phase
/// @param spacing    edges of a voxel [mm]; the distance is that to the nearest centre of a voxel outside
/// @param min_depth  h [mm], above 0: two maxima belong to two parts only if on every way from the lower one to a
/// higher
///                   one the distance falls by more than this
/// @note   32 bytes a voxel, the input included; 0.4 us a voxel
Watershed watershed(std::vector<std::uint8_t> outside, const VoxelIndex& size, const Vec3& spacing, double min_depth,
                    int threads, Reporter& reporter);

}  // namespace tomodem::segment
