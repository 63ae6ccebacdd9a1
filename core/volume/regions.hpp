#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/volume/volume.hpp"

namespace tomodem {

/// Labels first .. last of the image are objects of their own, and of one phase in the sample.
struct LabelObjects {
    std::int32_t first = 0, last = 0, species = 0;
};

using Histogram = std::map<std::int32_t, std::int64_t>;

/// Voxels of each label that the sample will have.
Histogram species_histogram(const LabelVolume& volume, const std::vector<LabelObjects>& objects);

/// The parts of an image that are distinguished: connected components, or labels that are objects.
struct Regions {
    enum class Of { objects, everything };
    Components components;                  ///< `label` is that of the sample
    std::vector<std::int32_t> image_label;  ///< of each region that is a label of the image, else 0
    std::vector<bool> is_object;            ///< of each region
};

/// Connected components of `labels`; those of `object_labels` are objects.
Regions component_regions(const LabelVolume& volume, const std::vector<std::int32_t>& labels,
                          const std::vector<std::int32_t>& object_labels, Connectivity connectivity,
                          Reporter& reporter = silent_reporter());

/// Takes labels of the image as objects: they get a region each (in order of the labels), and their voxels the label of
/// their phase.
/// @param regions  of the other labels; numbered first
/// @throws InvalidInput if a range has none of the image's labels
void take_label_objects(LabelVolume& volume, Regions& regions, const std::vector<LabelObjects>& objects,
                        Reporter& reporter = silent_reporter());

/// Both in one: the components of `object_labels`, or of everything, and the labels of the image that are objects.
/// @return nothing where no regions are asked for
std::optional<Regions> distinguish_regions(LabelVolume& volume, const std::vector<std::int32_t>& object_labels,
                                           const std::vector<LabelObjects>& objects, Connectivity connectivity,
                                           Regions::Of of, Reporter& reporter = silent_reporter());

}  // namespace tomodem
