#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/volume/volume.hpp"

namespace tomodem::segment {

/// What became of one label.
struct SeparatedLabel {
    std::int32_t label = 0;
    std::int32_t first = 0;                 ///< label of its first object; the others follow
    std::vector<std::int64_t> voxels = {};  ///< of each object
    std::int64_t components = 0;            ///< connected components (by faces) that the label had
    std::int64_t components_cut = 0;        ///< of these, those that are more than one object now
    std::int64_t joined = 0;                ///< parts below the smallest size that became part of an object beside them
    std::int64_t removed = 0;               ///< and those without one: they have the label around them

    std::int32_t last() const { return first + static_cast<std::int32_t>(voxels.size()) - 1; }
};

struct Separation {
    LabelVolume volume;  ///< labels that were not separated as they were, and one label for each object
    std::vector<SeparatedLabel> labels;
};

/// Gives each object of some labels a label of its own, from the largest label that is kept, plus 1, on. Objects are
/// numbered in raster order of their first voxels.
///
/// @param labels      sorted; each occurs in the volume
/// @param min_depth   see watershed() [mm]
/// @param min_voxels  smaller parts join the object that they share most faces with
/// @throws InvalidInput if nothing is left of a label
Separation separate_objects(const LabelVolume& volume, const std::vector<std::int32_t>& labels, double min_depth,
                            std::int64_t min_voxels, Reporter& reporter);

/// The objects that share a face with another object.
/// @param first  label of the first object; those above are objects too
std::int64_t touching_objects(const LabelVolume& volume, std::int32_t first);

}  // namespace tomodem::segment
