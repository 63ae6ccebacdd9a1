#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/volume/regions.hpp"
#include "core/volume/volume.hpp"
#include "tools/vol2pack/tiling.hpp"

namespace tomodem::vol2pack {

/// How a particle finds its label in the image.
enum class Filter {
    nearest,    ///< the voxel that contains its centre
    box,        ///< the label that fills most of a box around its centre
    level_set,  ///< the side of a smooth interface that its centre is on
};

struct LabelFilter {
    Filter kind = Filter::nearest;
    double box_size = 1.0;   ///< edge of the box of Filter::box [diameters of a seed]
    double smoothing = 0.8;  ///< width of Filter::level_set [voxels]
};

/// What the image has at each place of a tiling.
struct Places {
    static constexpr std::int32_t outside = INT32_MIN;  ///< label of a place that is not in or near the image
    /// Of the margin of the tiling, -1 - the label of the mirror image at the faces; in the image never negative.
    std::vector<std::int32_t> label;
    static std::int32_t label_of_image(std::int32_t label) { return label < 0 ? -1 - label : label; }
    std::vector<std::int32_t>
        region;  ///< from 1; 0: none of that label near. Empty where regions are not distinguished

    /// How many places in the image have each label.
    std::map<std::int32_t, std::int64_t> count() const;
};

/// Looks every place of the tiling up in the image.
/// @param regions  of the image, or nullptr
/// @throws InvalidInput if the image has a negative label
Places label_places(const LabelVolume& volume, const Tiling& tiling, const Regions* regions, const LabelFilter& filter,
                    int threads, Reporter& reporter = silent_reporter());

struct Sample {
    Packing packing;
    Places places;
    std::int64_t candidates = 0;                    ///< particles of the tiled brick in the image, void included
    std::map<std::int32_t, std::int64_t> labelled;  ///< how many of them have each label, void (0) included
    std::vector<std::int32_t> object_number;        ///< of each object, increasing
    std::vector<std::int64_t> object_particles;     ///< of each object
    std::int64_t components = 0;                    ///< regions of the image that should be objects
    std::int64_t lost_components() const;           ///< too small or thin: no particle fell into them
};

/// Fills the image with the tiled brick and keeps the particles outside the void (thesis, section 6.3; method: from an
/// image to a sample).
///
/// Particles whose centre lies in the box of the volume take part, in the order of their places. Objects that are
/// connected components are numbered in raster order of their first voxel, without those that got no particle; objects
/// that are labels of the image keep those labels as their numbers, and the components follow the largest of them.
///
/// @throws InvalidInput if nothing would come out
/// @note   the result does not depend on the number of threads
Sample sample_volume(const LabelVolume& volume, const Tiling& tiling, const Regions* regions, const LabelFilter& filter,
                     int threads, Reporter& reporter = silent_reporter());

}  // namespace tomodem::vol2pack
