#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/volume/volume.hpp"

/// What in an image must be resolved by particles.
namespace tomodem::plan {

/// Sizes of the objects, the closed pores or the struts of an image.
struct Feature {
    enum class Kind { objects, pores, struts };
    Kind kind = Kind::objects;
    std::string of;          ///< name of the phase; "void" for pores
    std::int64_t count = 0;  ///< places measured, of struts
    /// Half of the volume is in larger ones (struts: half of the surface has thicker ones behind it) [mm].
    double median = 0;
    double smallest = 0;  ///< of struts: a twentieth of the surface has thinner ones behind it [mm]
};

struct ImageFeatures {
    std::vector<Feature> features;
    double solid_volume = 0;                            ///< of the labels that the scene names [mm^3]
    Vec3 extent = Vec3::Zero(), origin = Vec3::Zero();  ///< mm
    double voxel = 0;                                   ///< edge along x [mm]
    std::vector<std::int32_t> labels;                   ///< of the solid
    std::vector<double> pore_gaps;  ///< of each closed pore: its distance from the nearest face of the image [mm]
};

/// Objects are the connected components (by faces) of the phases that the scene marks `objects = true`, or without any
/// of all phases but the one with the most voxels; of at least 27 voxels, their size is the diameter of the sphere of
/// the same volume. So is that of pores, which are components of void that reach no face of the image. Struts are
/// measured where void that does reach a face is over 30 % of the image: at places spread evenly over the solid's
/// surface, the length of the normal that runs inwards to the next surface (the diameter of a rod).
///
/// @throws InvalidInput if the image has a label that the scene does not name, or the scene one that it does not have
ImageFeatures find_features(const LabelVolume& volume, const Scene& scene, int threads);

/// Half of the sum of the third powers is in larger ones.
double median_by_volume(std::vector<double> diameters);

}  // namespace tomodem::plan
