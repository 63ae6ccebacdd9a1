#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "core/packing.hpp"
#include "core/volume.hpp"

namespace tomodem {

/// How a particle finds its label in the image.
enum class Filter {
    nearest,  ///< the voxel that contains its centre
    box,      ///< the label that fills most of a box around its centre
};

struct SampleOptions {
    double seed_radius = 0.0;  ///< r_s in the sample [mm]
    Filter filter = Filter::nearest;
    double box_size = 0.0;                    ///< edge of the box of Filter::box [mm]; 0: the diameter of a seed
    std::vector<std::int32_t> object_labels;  ///< each connected component of one of these is an object of its own
    std::uint64_t random_seed = 0;            ///< shifts the brick periodically by a random vector; 0: no shift
    std::int64_t max_particles = 50'000'000;  ///< guard against a wrong scale
    int threads = 1;
};

struct Sample {
    Packing packing;
    std::int64_t candidates = 0;                    ///< particles of the tiled brick in the image, void included
    std::map<std::int32_t, std::int64_t> labelled;  ///< how many of them have each label, void (0) included
    std::vector<std::int64_t> object_particles;     ///< of each object (index 0: object 1)
    std::int64_t components = 0;                    ///< of the image, of the labels with objects
    std::int64_t lost_components() const;           ///< too small or thin: no particle fell into them
};

/// Fills the image with the periodic brick, repeated as far as the image goes, and keeps the particles outside the void
/// (thesis, section 6.3; method: from an image to a sample).
///
/// The brick is scaled to the seed radius. Its corner lies at the origin of the volume, unless it is shifted. Particles
/// whose centre lies in the box of the volume take part. They are numbered tile by tile (x fastest), within a tile in
/// the order of the brick. Objects are numbered in raster order of the first voxel of their component, without those
/// that got no particle; touching components of different labels are different objects.
///
/// @throws InvalidInput if the brick is not periodic or empty, or if nothing or too much would come out
/// @note   the result does not depend on the number of threads
Sample sample_volume(const LabelVolume& volume, const Packing& brick, const SampleOptions& options);

}  // namespace tomodem
