#pragma once
#include <functional>
#include <vector>

#include "core/packing/packing_file.hpp"

namespace tomodem::curves {

/// Alpha shape of the particle centres at one frame.
struct FrameVolume {
    double volume = 0.0;  ///< mm^3
    double area = 0.0;    ///< mm^2
    std::size_t components = 0;
};

/// The alpha shape of each frame of a run, frames shared by the threads; the result does not depend on their number.
///
/// @param probe_radius  mm, see alpha_surface
/// @param progress      called with the number of frames done
/// @throws InvalidInput naming the frame that has no alpha shape
std::vector<FrameVolume> volume_series(const RunReader& run, double probe_radius, int threads,
                                       const std::function<void(double)>& progress);

}  // namespace tomodem::curves
