#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "tools/vol2pack/sample.hpp"

namespace tomodem::vol2pack {

/// One label in the image and in the sample. Void is a phase as well: the particles that were removed.
struct Phase {
    std::int32_t label = 0;
    std::string name;              ///< empty where the user gave none
    std::int64_t voxels = 0;       ///< of the image as read
    std::int64_t voxels_used = 0;  ///< of the image without its small components
    std::int64_t particles = 0;
    double image_fraction = 0.0;
    double sample_fraction = 0.0;  ///< of all particles that the image could hold, void included
    /// Percentage points by which the sample has more of the phase than the image as read.
    double difference() const { return 100 * (sample_fraction - image_fraction); }
};

/// @throws InvalidInput if a label is negative, if names are given and one of the image's labels has none (or the
///         other way round), if 0 is named as anything but void, or if a label of objects is not in the image
void check_labels(const std::map<std::int32_t, std::int64_t>& image, const std::map<std::int32_t, std::string>& names,
                  const std::vector<std::int32_t>& object_labels);

/// @param image  voxels of each label as read
/// @param used   voxels of each label that the sample was made from
std::vector<Phase> compare_phases(const std::map<std::int32_t, std::int64_t>& image,
                                  const std::map<std::int32_t, std::int64_t>& used, const Sample& sample,
                                  const std::map<std::int32_t, std::string>& names);

/// @throws InvalidInput naming the first phase of the image that has no particles
void check_phases(const std::vector<Phase>& phases);

void report_phases(const std::vector<Phase>& phases, Reporter& reporter);
void report_objects(const Sample& sample, Reporter& reporter);

}  // namespace tomodem::vol2pack
