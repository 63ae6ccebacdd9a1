#pragma once
#include <functional>
#include <vector>

#include "core/volume/volume.hpp"

namespace tomodem::relax {

/// A volume of label 1 with void (0) where `is_void` says so of a voxel's centre.
inline LabelVolume image_of(VoxelIndex size, const Vec3& spacing, const Vec3& origin,
                            const std::function<bool(const Vec3&)>& is_void) {
    LabelVolume image(size, spacing, origin);
    std::vector<std::int32_t> labels(std::size_t(size[0]) * size[1]);
    for (std::int32_t k = 0; k < size[2]; ++k) {
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i)
                labels[std::size_t(j) * size[0] + i] =
                    is_void(origin + spacing.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5))) ? 0 : 1;
        image.set_slice(k, labels);
    }
    return image;
}

}  // namespace tomodem::relax
