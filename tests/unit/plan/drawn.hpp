#pragma once
#include <cmath>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/volume/volume.hpp"

/// Volumes of 10 um voxels drawn by a rule, and scenes for them.
namespace tomodem::plan::drawn {

inline constexpr double voxel = 0.01;  ///< mm

/// @param label  of (x, y, z) [voxels], the centre of a voxel
template <class Label>
LabelVolume volume(std::int32_t size, const Label& label) {
    LabelVolume made({size, size, size}, Vec3::Constant(voxel));
    std::vector<std::int32_t> labels;
    for (std::int32_t k = 0; k < size; ++k) {
        labels.clear();
        for (std::int32_t j = 0; j < size; ++j)
            for (std::int32_t i = 0; i < size; ++i) labels.push_back(label(Vec3(i + 0.5, j + 0.5, k + 0.5)));
        made.set_slice(k, labels);
    }
    return made;
}

/// `inside` in balls of these radii around the corners of a cube in the middle (up to eight), 1 elsewhere.
inline LabelVolume balls(const std::vector<double>& radii, std::int32_t inside, std::int32_t size = 60) {
    return volume(size, [&](const Vec3& at) {
        for (std::size_t k = 0; k < radii.size(); ++k) {
            const Vec3 centre((k & 1) != 0 ? 45 : 15, (k & 2) != 0 ? 45 : 15, (k & 4) != 0 ? 45 : 15);
            if ((at - centre).norm() < radii[k]) return inside;
        }
        return 1;
    });
}

/// Rods of radius 5 voxels along the three axes, 30 apart, and a ball of void in the node in the middle, with a shell
/// around a large one.
inline LabelVolume foam_with_pores(double radius) {
    return volume(90, [=](const Vec3& at) {
        if ((at - Vec3::Constant(45)).norm() < radius) return 0;
        const Vec3 off = at - 30 * ((at.array() / 30).floor() + 0.5).matrix();
        if (radius > 5 && (at - Vec3::Constant(45)).norm() < radius + 3) return 1;
        for (int axis = 0; axis < 3; ++axis)
            if (std::hypot(off[axis], off[(axis + 1) % 3]) < 5) return 1;
        return 0;
    });
}

inline const char* const one_phase = R"([phase.a]
label = 1
law = "bilin"
norton = { K = 50, M = 0.0714 }
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
)";

inline const char* const two_phases = R"([phase.a]
label = 1
law = "bilin"
norton = { K = 50, M = 0.0714 }
[phase.b]
label = 2
law = "bilin"
norton = { K = 100, M = 0.0714 }
objects = true
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
)";

}  // namespace tomodem::plan::drawn
