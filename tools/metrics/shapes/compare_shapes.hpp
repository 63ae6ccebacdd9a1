#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/packing/packing_file.hpp"
#include "tools/metrics/shapes/image_shapes.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"
#include "tools/metrics/shapes/object_volumes.hpp"

/// A frame of a run beside the tomography of the same strain.
namespace tomodem::shapes {

/// One object of a run, measured as by object_shapes; or one of its pores, measured as by image_shapes in the voxels of
/// the run.
struct RunBody {
    std::int32_t number = 0, species = 0;
    std::int64_t particles = 0;
    bool at_boundary = false;
    Shape shape;
};
/// @param packing  its positions are those of the frame
/// @param surface  surface_of_all of them
std::vector<RunBody> measure_objects(const Packing& packing, const AlphaSurface& surface,
                                     const std::vector<Object>& objects, int axis);

std::vector<RunBody> bodies_of_pores(const VoidParts& parts);

enum class MatchedBy { overlap, centre, run_only, image_only };
const char* name_of(MatchedBy matched);

/// An object of the run and the object of the image that it is, or an object without a partner.
struct Match {
    MatchedBy by = MatchedBy::overlap;
    const RunBody* run = nullptr;      ///< none for image_only
    const ImageBody* image = nullptr;  ///< none for run_only
    double dice = 0.0;                 ///< 2 |A and B| / (|A| + |B|) of their voxels
    double iou = 0.0;                  ///< |A and B| / |A or B|
};

/// A label in both images.
struct PhaseOverlap {
    std::int64_t run = 0, image = 0, both = 0;  ///< voxels
    double dice() const { return run + image > 0 ? 2.0 * double(both) / double(run + image) : 0.0; }
    double iou() const { return run + image > both ? double(both) / double(run + image - both) : 0.0; }
};

struct Comparison {
    std::vector<Match> matches;                  ///< by number of the run's object, then those of the image alone
    std::map<std::int32_t, PhaseOverlap> phase;  ///< of each label, 0: void
    std::int64_t voxels = 0;                     ///< of the image
    std::int64_t equal = 0;                      ///< voxels of the same label
    double run_porosity = 0.0;                   ///< closed pores over matter and closed pores, on the same voxels
    double image_porosity = 0.0;
};

/// The bodies of one side, and their voxels.
template <class Body>
struct Side {
    const LabelVolume& region;
    std::span<const std::int32_t> number_of_region;  ///< number of the body, 0: none; empty: the regions are numbers
    std::span<const Body> bodies;                    ///< outlives the comparison
};

/// Pairs of objects: first those that share voxels, so that the sum of dice() is largest, then of the rest those whose
/// centres are nearer than twice the sum of the radii of balls of their volumes, so that the sum of the nearness (1:
/// same place, 0: that far) is largest.
///
/// @param run    labels of the run, on the voxels of the image
/// @param image  labels
Comparison compare(const LabelVolume& run, const Side<RunBody>& run_side, const LabelVolume& image,
                   const Side<ImageBody>& image_side, Connectivity connectivity);

/// Centre of what is not void [mm].
Vec3 centre_of_matter(const LabelVolume& image);
/// @throws InvalidInput if the volumes of the image and of the box around the particles differ by more than a factor of
///         four, or the two overlap by less than half of the smaller one
void require_same_place(const LabelVolume& image, const Packing& packing);

}  // namespace tomodem::shapes
