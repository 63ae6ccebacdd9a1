#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/volume/regions.hpp"
#include "core/volume/volume.hpp"
#include "tools/metrics/shapes/ellipsoid.hpp"

/// Shapes of the objects and pores of a label image: the same measures as those of a run.
namespace tomodem::shapes {

/// Sums over the voxels of one number, as integers, so that they do not depend on the order of the voxels.
struct VoxelSums {
    std::int64_t voxels = 0;
    std::array<std::int64_t, 3> sum{};      ///< of i, j, k
    std::array<std::int64_t, 6> squares{};  ///< of ii, jj, kk, ij, ik, jk
    /// Pairs of neighbours of which one is such a voxel and the other is not, for each of `pair_steps`. What lies
    /// beyond a face of the image is no neighbour.
    std::array<std::int64_t, 13> borders{};
    VoxelIndex low{}, high{};  ///< first and last voxel along each axis

    VoxelSums& operator+=(const VoxelSums& other);
};

/// Half of the 26 neighbours of a voxel; the other half is opposite.
inline constexpr std::array<VoxelIndex, 13> pair_steps{
    VoxelIndex{1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0},  {-1, -1, 1}, {0, -1, 1}, {1, -1, 1},
    {-1, 0, 1},          {0, 0, 1},  {1, 0, 1}, {-1, 1, 1}, {0, 1, 1},   {1, 1, 1}};

/// Sums over the voxels of each of some numbers (labels, or components).
/// @param numbers  rising
/// @throws InvalidInput if the image is too large for whole numbers of 64 bits
/// @note   one pass; a slab, and the sums for each thread beside the volume
std::vector<VoxelSums> voxel_sums(const LabelVolume& volume, std::span<const std::int32_t> numbers);

/// Share of the sphere of directions that is nearest to each of the 13 directions.
std::array<double, 13> crofton_weights(const Vec3& spacing);

/// Surface [mm^2] by Crofton's formula: 2 sum over the 13 directions of weight * crossings * area of a line.
/// @see Ohser & Schladitz, 3D Images of Materials Structures (2009), section 5.2; Legland, Kieu & Devaux, Image Anal.
///      Stereol. 26 (2007) 83
double crofton_area(const VoxelSums& sums, const Vec3& spacing, const std::array<double, 13>& weights);

/// Surface of a ball of that volume over the surface.
double sphericity(double volume, double area);

/// Nothing is added for the size of a voxel (spacing^2 / 12), as nothing is for that of a particle: voxels that have
/// their centre in a body are spread over it evenly up to its edge (docs/measures.md).
Shape shape_of(const VoxelSums& sums, const Vec3& spacing, const Vec3& origin, int axis);

/// One object or pore of an image.
struct ImageBody {
    std::int32_t number = 0;  ///< as vol2pack numbers objects (it leaves out those without particles); of pores from 1
    std::int32_t label = 0;   ///< 0: a pore
    std::int64_t voxels = 0;
    bool at_boundary = false;  ///< touches a face of the image
    Shape shape;
    double area = 0.0;        ///< mm^2, without what lies on a face of the image
    double sphericity = 0.0;  ///< not a number without a surface
};

/// The objects of an image.
struct ObjectLabels {
    bool all_components = false;           ///< each connected component of any label but 0 is an object
    std::vector<std::int32_t> components;  ///< else: labels of which each connected component is an object
    std::vector<LabelObjects> labels;      ///< labels that are one object each, and their label in the sample
    Connectivity connectivity = Connectivity::faces;
};

struct ImageObjects {
    LabelVolume region;                          ///< a number of each voxel that is in an object
    std::vector<std::int32_t> number_of_region;  ///< the object's, 0: none or left out; index 0: no object
    std::vector<ImageBody> used;                 ///< by number
    std::int64_t too_small = 0;                  ///< fewer voxels than asked for, or all in one plane
    std::int64_t at_boundary = 0;                ///< left out
};

struct BodyChoice {
    std::int64_t min_voxels = 27;
    bool exclude_boundary = false;
    int axis = 2;  ///< of the load
};

/// @param volume  labels of objects become those of the sample
/// @throws InvalidInput if the image has no such label, or no object is left
ImageObjects image_objects(LabelVolume& volume, const ObjectLabels& labels, const BodyChoice& choice);

struct VoidParts {
    LabelVolume region;                          ///< a number of each voxel of void
    std::vector<std::int32_t> number_of_region;  ///< the closed pore's, 0: none or left out; index 0: no void
    std::vector<ImageBody> closed;               ///< those that touch no face of the image, by number
    std::int64_t too_small = 0;                  ///< closed, with fewer voxels than asked for, or all in one plane
    std::int64_t open = 0;                       ///< parts of the void that touch a face
    std::int64_t closed_voxels = 0;              ///< too small ones included
    std::int64_t open_voxels = 0;
    std::int64_t voxels = 0;  ///< of the image
};

/// The connected components of the void (label 0).
/// @throws InvalidInput if all is void
VoidParts void_parts(const LabelVolume& volume, Connectivity connectivity, const BodyChoice& choice);

}  // namespace tomodem::shapes
