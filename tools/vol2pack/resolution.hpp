#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "tools/vol2pack/sample.hpp"

namespace tomodem::vol2pack {

/// One resolution that was tried.
struct ResolutionStep {
    double pixels_per_seed = 0.0;
    double particles = 0.0;  ///< that fill the image, about, void included
    double error = 0.0;      ///< largest relative error of the volume of a label, over all placements
};

struct ResolutionOptions {
    double max_error = 0.0;  ///< as ResolutionStep::error
    double pixel = 0.0;      ///< edge of a voxel along x [mm]
    LabelFilter filter{};
    std::uint64_t random_seed = 0;
    std::int64_t max_particles = 50'000'000;
    int threads = 1;
};

/// The coarsest resolution at which every label keeps its volume within `max_error`, and the coarser ones that did not;
/// the last is the one chosen.
///
/// Radii of 2^(k/3) voxels are tried from coarse (about 64 particles in the image) to fine (1 voxel): twice the
/// particles a step. So that none is chosen by luck, the error is the largest over four placements of the brick, the
/// one of `random_seed` first: the sample that is made then keeps the error.
///
/// @throws InvalidInput if 1 voxel or `max_particles` is reached before
/// @note   costs about eight times the look-ups of the sample itself
std::vector<ResolutionStep> choose_resolution(const LabelVolume& volume, const Packing& brick,
                                              const ResolutionOptions& options, Reporter& reporter = silent_reporter());

/// What was chosen and why, for the user.
void report_resolution(const std::vector<ResolutionStep>& steps, double max_error, Reporter& reporter);

}  // namespace tomodem::vol2pack
