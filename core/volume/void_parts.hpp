#pragma once
#include <cstdint>
#include <vector>

#include "core/volume/volume.hpp"

/// The pores of an image, and which of them particles can show.
namespace tomodem {

/// A connected component (by faces) of the void of an image.
struct VoidPart {
    std::int32_t number = 0;  ///< from 1, in raster order of the first voxels
    std::int64_t voxels = 0;
    double volume = 0;                                       ///< mm^3
    Vec3 centre = Vec3::Zero();                              ///< mm
    VoxelIndex low{}, high{};                                ///< first and last voxel along each axis
    Vec3 wall_low = Vec3::Zero(), wall_high = Vec3::Zero();  ///< between it and the image's faces [mm]; 0: it meets one

    double diameter() const;  ///< of the sphere of its volume [mm]
    double wall() const;      ///< the thinnest [mm]
};

std::vector<VoidPart> void_parts(const Components& void_components);

/// What becomes of a part of the void in a sample of particles.
enum class PoreKind {
    closed,     ///< at least two particles from every face of the image
    cut,        ///< it meets a face of the image, or comes within two particles of one: a wall so thin opens
    open,       ///< so with two opposite faces: void that passes through the image
    too_small,  ///< fewer particles across than asked for
};

/// Wall between a pore and a face of the image that holds when a sample relaxes [particles].
inline constexpr double min_wall = 2;
/// Particles across the smallest pore that is carved.
inline constexpr double min_pore = 4;

/// @param seed_radius  of the particles [mm]
/// @param min_across   diameter of the smallest pore that is not too small [particles]
PoreKind kind_of(const VoidPart& part, double seed_radius, double min_across = min_pore);

}  // namespace tomodem
