#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/void_parts.hpp"
#include "core/volume/volume.hpp"

/// The pores of an image, and where a point is with respect to them.
namespace tomodem::relax {

/// Signed distance [mm] to the surface of a set of voxels, negative inside; in a box of voxels around it.
class DistanceField {
 public:
    /// @param inside  of each voxel of the box, x fastest
    /// @param from    first voxel of the box that says something, `to` one behind the last: the others lie outside the
    ///                image, where its surface goes on as it meets the face
    /// @param corner  of the box [mm]
    DistanceField(const std::vector<bool>& inside, VoxelIndex size, const VoxelIndex& from, const VoxelIndex& to,
                  const Vec3& spacing, const Vec3& corner);

    /// Trilinear between the voxels' centres; infinite outside the box.
    double at(const Vec3& point) const;
    /// Volume of the set's voxels [mm^3] up to planes [mm] near faces of the image (-1 the low one along an axis, 1 the
    /// high one, 0 none). Beyond the image the set goes on as it meets the face.
    double volume_up_to(const std::array<int, 3>& face, const Vec3& plane) const;
    /// The box in which at() is finite.
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }

 private:
    VoxelIndex size_;
    Vec3 spacing_, low_, high_;
    std::array<double, 3> first_, last_;  ///< centres of the voxels that say something, in voxels from low_
    std::vector<float> distance_;
};

/// Squared distances [mm^2] of every voxel of a box to the nearest one of a set; infinite if it is empty.
std::vector<float> squared_distances(const std::vector<bool>& set, VoxelIndex size, const Vec3& spacing);

/// A pore that particles can show.
struct ImagePore {
    VoidPart part;
    PoreKind kind = PoreKind::closed;
    double across = 0;                 ///< diameter of the sphere of its volume, in particles [-]
    std::array<int, 3> face{0, 0, 0};  ///< that cuts it, along each axis: -1 the low one, 1 the high one, 0 none
    DistanceField distance;            ///< known within `reach` of the pore
};

struct ImagePores {
    std::vector<ImagePore> pores;
    std::int64_t too_small = 0;   ///< components left out, as too few particles would fit in
    double too_small_volume = 0;  ///< [mm^3]
};

/// @param seed_radius  of the particles [mm]
/// @param min_across   of a pore that is not left out
/// @param reach        how far from a pore its distance is known [mm]
/// @throws InvalidInput if the image has no void, or nothing that is not too small
/// @note   memory: 4 bytes a voxel of the boxes around the pores, 9 while they are made
ImagePores find_pores(const LabelVolume& volume, double seed_radius, double min_across, double reach, int threads);

}  // namespace tomodem::relax
