#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/volume/void_parts.hpp"
#include "core/volume/volume.hpp"
#include "tools/plan/objects.hpp"

/// What in an image must be resolved by particles.
namespace tomodem::plan {

/// Sizes of the objects, the closed pores or the struts of an image.
struct Feature {
    enum class Kind { objects, pores, struts };
    Kind kind = Kind::objects;
    std::string of;          ///< name of the phase; "void" for pores
    std::int64_t count = 0;  ///< places measured, of struts; 0: objects that are still to be separated
    /// Half of the volume is in larger ones (struts, objects that are tangled or still to be separated: half of the
    /// surface has thicker ones behind it) [mm].
    double median = 0;
    double smallest = 0;  ///< of struts: a twentieth of the surface has thinner ones behind it [mm]
    /// Of objects by components: one part holds over 90 % of the phase, and is no compact body.
    bool tangled = false;
    double largest_share = 0;  ///< of the phase's volume in its largest object
};

struct ImageFeatures {
    std::vector<Feature> features;
    double solid_volume = 0;                            ///< of the labels that the scene names [mm^3]
    Vec3 extent = Vec3::Zero(), origin = Vec3::Zero();  ///< mm
    double voxel = 0;                                   ///< edge along x [mm]
    std::vector<std::int32_t> labels;                   ///< of the solid, as the sample will have them
    std::vector<VoidPart> voids;                        ///< of 27 voxels at least
    double void_volume = 0;                             ///< all of it [mm^3]
};

/// Objects are the connected components (by faces) of the phases that the scene marks `objects = true`, or without any
/// of all phases but the one with the most voxels; of at least 27 voxels, their size is the diameter of the sphere of
/// the same volume. Objects that have a label each are those labels; of objects that are still to be separated, or
/// whose largest component holds over 90 % of their phase and is no compact body, the thickness of their phase is
/// measured, as of struts. Pores are components of void that reach no face of the image
/// or, if there is none, no two opposite ones. Struts are measured where void
/// that does reach a face is over 30 % of the image: at places spread evenly over the solid's surface, the length of
/// the normal that runs inwards to the next surface (the diameter of a rod).
///
/// @param volume    as the sample will have it: with a label for each phase
/// @param labelled  the objects that had labels of their own; nullptr: none
/// @throws InvalidInput if the image has a label that the scene does not name, or the scene one that it does not have
ImageFeatures find_features(const LabelVolume& volume, const Scene& scene, int threads,
                            ObjectsBy by = ObjectsBy::components, const LabelledObjects* labelled = nullptr);

/// Half of the sum of the third powers is in larger ones.
double median_by_volume(std::vector<double> diameters);

}  // namespace tomodem::plan
