#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/volume/regions.hpp"
#include "core/volume/volume.hpp"

/// The three ways in which the objects of an image are told apart.
namespace tomodem::plan {

enum class ObjectsBy {
    components,  ///< each connected part of a label is one
    watershed,   ///< touching ones are still to be separated (`separate_objects`)
    labels,      ///< the image has a label for each
};

/// Objects that have labels of their own in the image.
struct LabelledObjects {
    std::int32_t phase = 0;            ///< their label in the sample
    std::vector<LabelObjects> ranges;  ///< of the image's labels
    std::vector<std::int64_t> voxels;  ///< of each
};

/// An image of more values than phases have labels: do they look like a label for each object? So they do if they have
/// few connected parts each; noise in a grey image has many.
bool looks_labelled(const LabelVolume& volume);

/// More values than these are a grey image, or objects with a label each; as for volume_info.
inline constexpr std::size_t most_phases = 16;

/// The one phase whose objects a watershed or the image's labels make: the one that the scene marks `objects = true`,
/// or its only phase.
/// @throws InvalidInput if the scene marks none of several, or more than one
std::int32_t phase_of_objects(const Scene& scene);

/// Every label of the image that is neither void nor another phase's is an object of `phase`, and becomes that label.
/// @param others  labels of the other phases
/// @throws InvalidInput if there is none
LabelledObjects take_labels(LabelVolume& volume, std::int32_t phase, const std::vector<std::int32_t>& others);

/// What vol2pack is told.
/// @param labels   whose components are objects
/// @param ranges   of labels that are
std::string vol2pack_options(ObjectsBy by, const std::vector<std::int32_t>& labels,
                             const std::vector<LabelObjects>& ranges);

/// The labels that `separate_objects` gives: those above the largest that it keeps.
/// @param labels  of the solid in the image
LabelObjects separated_range(const std::vector<std::int32_t>& labels, std::int32_t phase);

}  // namespace tomodem::plan
