#pragma once
#include <vector>

#include "core/volume/volume.hpp"
#include "tools/phantom/spheres.hpp"

namespace tomodem::phantom {

/// What a scanner makes of a label volume.
struct Scanner {
    std::vector<double> grey;  ///< of label 0, 1, ...: 0 to 255
    double noise = 0.0;        ///< standard deviation of a normal distribution, in grey values
    double shading = 0.0;      ///< share by which the brightness falls from the first to the last voxel along x
};

/// Grey values, whole numbers from 0 to 255, each voxel with a noise of its own.
/// @throws InvalidInput if a label of the volume has no grey value
LabelVolume scan(const LabelVolume& labels, const Scanner& scanner, Random& random);

}  // namespace tomodem::phantom
