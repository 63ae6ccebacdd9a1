#include "core/volume/void_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tomodem {

double VoidPart::diameter() const {
    return std::cbrt(6 * volume / std::numbers::pi);
}

double VoidPart::wall() const {
    return std::min(wall_low.minCoeff(), wall_high.minCoeff());
}

std::vector<VoidPart> void_parts(const Components& void_components) {
    const LabelVolume& number = void_components.number;
    const VoxelIndex size = number.size();
    const Vec3 spacing = number.spacing();
    std::vector<VoidPart> parts(void_components.voxels.size());
    for (VoidPart& part : parts) {
        part.low.fill(std::numeric_limits<std::int32_t>::max());
        part.high.fill(-1);
    }
    std::vector<Vec3> sum(parts.size(), Vec3::Zero());
    std::vector<std::int32_t> slab;
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        number.slices(k, count, slab);
        std::size_t at = 0;
        for (std::int32_t z = k; z < k + count; ++z)
            for (std::int32_t y = 0; y < size[1]; ++y)
                for (std::int32_t x = 0; x < size[0]; ++x, ++at) {
                    if (slab[at] == 0) continue;
                    const std::size_t one = slab[at] - 1;
                    const VoxelIndex voxel{x, y, z};
                    for (int c = 0; c < 3; ++c) {
                        parts[one].low[c] = std::min(parts[one].low[c], voxel[c]);
                        parts[one].high[c] = std::max(parts[one].high[c], voxel[c]);
                        sum[one][c] += voxel[c];
                    }
                }
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
        VoidPart& part = parts[i];
        part.number = static_cast<std::int32_t>(i) + 1;
        part.voxels = void_components.voxels[i];
        part.volume = static_cast<double>(part.voxels) * spacing.prod();
        for (int c = 0; c < 3; ++c) {
            part.wall_low[c] = part.low[c] * spacing[c];
            part.wall_high[c] = (size[c] - 1 - part.high[c]) * spacing[c];
            part.centre[c] = number.origin()[c] + spacing[c] * (sum[i][c] / static_cast<double>(part.voxels) + 0.5);
        }
    }
    return parts;
}

PoreKind kind_of(const VoidPart& part, double seed_radius, double min_across) {
    if (part.diameter() < min_across * 2 * seed_radius) return PoreKind::too_small;
    const double thin = min_wall * 2 * seed_radius;
    PoreKind kind = PoreKind::closed;
    for (int c = 0; c < 3; ++c) {
        if (part.wall_low[c] < thin && part.wall_high[c] < thin) return PoreKind::open;
        if (part.wall_low[c] < thin || part.wall_high[c] < thin) kind = PoreKind::cut;
    }
    return kind;
}

}  // namespace tomodem
