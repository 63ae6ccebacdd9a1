#include "tools/phantom/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace tomodem::phantom {

LabelVolume scan(const LabelVolume& labels, const Scanner& scanner, Random& random) {
    for (const auto& [label, voxels] : labels.histogram())
        if (label < 0 || static_cast<std::size_t>(label) >= scanner.grey.size())
            throw InvalidInput(
                fmt::format("label {} of the volume has no grey value: --grey gives {}, one for each label from 0",
                            label, scanner.grey.size()));
    const VoxelIndex size = labels.size();
    LabelVolume image(size, labels.spacing(), labels.origin());
    std::vector<std::int32_t> slice;
    for (std::int32_t k = 0; k < size[2]; ++k) {
        labels.slice(k, slice);
        for (std::size_t i = 0; i < slice.size(); ++i) {
            const double along = static_cast<double>(i % size[0]) / std::max(1, size[0] - 1);
            const double grey =
                scanner.grey[slice[i]] * (1 - scanner.shading * along) + scanner.noise * random.normal();
            slice[i] = static_cast<std::int32_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
        }
        image.set_slice(k, slice);
    }
    return image;
}

}  // namespace tomodem::phantom
