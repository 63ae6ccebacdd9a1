#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/volume/volume.hpp"

namespace tomodem::phantom {

struct Sphere {
    Vec3 centre;
    double radius = 0.0;
    double volume() const;
};

/// One inclusion or pore: a sphere, or several that overlap.
struct Grain {
    std::vector<Sphere> spheres;
};

/// Volume of the union of the spheres of a grain; exact for one sphere, else by summing columns (within 1e-4).
double grain_volume(const Grain& grain);

/// Volume-weighted centre of the spheres, exact for one sphere or equal ones in a symmetric cluster.
Vec3 grain_centre(const Grain& grain);

/// Random numbers that are the same with every standard library.
class Random {
 public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double uniform(double low, double high);
    double normal();  ///< mean 0, standard deviation 1
    Vec3 direction();

 private:
    std::mt19937_64 engine_;
};

/// Moves grains (as rigid bodies) to places in the box of these edges [mm] where they do not come closer than `gap` to
/// each other nor to the faces.
///
/// Larger grains are placed first, each at a random place with enough room. Where none is found in many trials, all are
/// placed anyhow and pushed apart until they fit.
///
/// @return the grains in the order given, placed
/// @throws InvalidInput if a grain is larger than the box, or if they cannot be pushed apart
std::vector<Grain> place_without_overlap(std::vector<Grain> grains, const Vec3& edges, double gap, Random& random,
                                         Reporter& reporter = silent_reporter());

/// Gives `label` to the voxels whose centre lies in a grain. `background` elsewhere.
/// @return the volume, and the number of voxels of each grain
struct Raster {
    LabelVolume volume;
    std::vector<std::int64_t> voxels;
};
Raster rasterise(const std::vector<Grain>& grains, VoxelIndex size, double voxel_size, std::int32_t label,
                 std::int32_t background, int threads = 1, Reporter& reporter = silent_reporter());

/// Gives each voxel whose centre lies in a sphere the number of its grain, from 1; 0 elsewhere. Where spheres overlap,
/// the plane through the circle in which their surfaces meet is the border.
/// @param grains  of one sphere each
Raster rasterise_numbers(const std::vector<Grain>& grains, VoxelIndex size, double voxel_size,
                         Reporter& reporter = silent_reporter());

}  // namespace tomodem::phantom
