#include "tools/plan/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "tools/vol2pack/geometric_error.hpp"

namespace tomodem::plan {
namespace {

constexpr std::int64_t min_voxels = 27;
/// Void at the faces, share of the image: more is a foam.
constexpr double foam_void = 0.3;

double equivalent_diameter(double volume) {
    return std::cbrt(6 * volume / std::numbers::pi);
}

/// For each component, its distance from the nearest face of the image; 0: it reaches one [mm].
std::vector<double> gaps_to_faces(const Components& components, const Vec3& spacing) {
    std::vector<double> gap(components.voxels.size() + 1, std::numeric_limits<double>::max());
    const VoxelIndex size = components.number.size();
    const auto to_ends = [&](std::int32_t at, int axis) { return std::min(at, size[axis] - 1 - at) * spacing[axis]; };
    std::vector<std::int32_t> slice;
    for (std::int32_t k = 0; k < size[2]; ++k) {
        components.number.slice(k, slice);
        for (std::int32_t j = 0; j < size[1]; ++j) {
            const double across = std::min(to_ends(k, 2), to_ends(j, 1));
            for (std::int32_t i = 0; i < size[0]; ++i) {
                double& nearest = gap[slice[static_cast<std::size_t>(j) * size[0] + i]];
                nearest = std::min({nearest, across, to_ends(i, 0)});
            }
        }
    }
    return gap;
}

/// Every solid label becomes 1.
LabelVolume solid_of(const LabelVolume& volume) {
    LabelVolume solid(volume.size(), volume.spacing(), volume.origin());
    std::vector<std::int32_t> labels;
    for (std::int32_t k = 0; k < volume.size()[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, volume.size()[2] - k);
        volume.slices(k, count, labels);
        for (std::int32_t& label : labels) label = label != 0;
        solid.set_slices(k, count, labels);
    }
    return solid;
}

void check_labels(const std::map<std::int32_t, std::int64_t>& histogram, const Scene& scene) {
    for (const auto& [label, voxels] : histogram)
        if (label != 0 && std::none_of(scene.phases.begin(), scene.phases.end(),
                                       [label = label](const Phase& phase) { return phase.label == label; }))
            throw InvalidInput(
                fmt::format("scene '{}' has no phase with label {}, which the image has; add one, or rename the label "
                            "with --relabel",
                            scene.path.string(), label));
    for (const Phase& phase : scene.phases)
        if (!histogram.contains(phase.label))
            throw InvalidInput(fmt::format("scene '{}' line {}: [phase.{}] has label {}, which the image does not have",
                                           scene.path.string(), phase.line, phase.name, phase.label));
}

}  // namespace

double median_by_volume(std::vector<double> diameters) {
    std::sort(diameters.begin(), diameters.end());
    const auto volume = [](double sum, double diameter) { return sum + std::pow(diameter, 3); };
    const double half = std::accumulate(diameters.begin(), diameters.end(), 0.0, volume) / 2;
    double sum = 0;
    for (const double diameter : diameters)
        if (sum = volume(sum, diameter); sum >= half) return diameter;
    return diameters.empty() ? 0 : diameters.back();
}

ImageFeatures find_features(const LabelVolume& volume, const Scene& scene, int threads) {
    const std::map<std::int32_t, std::int64_t> histogram = volume.histogram();
    check_labels(histogram, scene);
    ImageFeatures found;
    found.extent = volume.extent();
    found.origin = volume.origin();
    found.voxel = volume.spacing()[0];
    const double voxel_volume = volume.spacing().prod();
    std::int32_t matrix = 0;
    for (const auto& [label, voxels] : histogram) {
        if (label == 0) continue;
        found.labels.push_back(label);
        found.solid_volume += static_cast<double>(voxels) * voxel_volume;
        if (matrix == 0 || voxels > histogram.at(matrix)) matrix = label;
    }

    const auto add = [&](Feature::Kind kind, const std::string& name, const std::vector<double>& diameters) {
        if (diameters.empty()) return;
        found.features.push_back({kind, name, static_cast<std::int64_t>(diameters.size()), median_by_volume(diameters),
                                  *std::min_element(diameters.begin(), diameters.end())});
    };
    const bool marked =
        std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.objects; });
    for (const Phase& phase : scene.phases) {
        if (marked ? !phase.objects : phase.label == matrix) continue;
        std::vector<double> diameters;
        for (const std::int64_t voxels : connected_components(volume, {phase.label}).voxels)
            if (voxels >= min_voxels)
                diameters.push_back(equivalent_diameter(static_cast<double>(voxels) * voxel_volume));
        add(Feature::Kind::objects, phase.name, diameters);
    }
    if (!histogram.contains(0)) return found;

    const Components voids = connected_components(volume, {0});
    const std::vector<double> gap = gaps_to_faces(voids, volume.spacing());
    std::vector<double> diameters;
    std::int64_t open_voxels = 0;
    for (std::size_t k = 0; k < voids.voxels.size(); ++k) {
        if (gap[k + 1] == 0) {
            open_voxels += voids.voxels[k];
        } else if (voids.voxels[k] >= min_voxels) {
            diameters.push_back(equivalent_diameter(static_cast<double>(voids.voxels[k]) * voxel_volume));
            found.pore_gaps.push_back(gap[k + 1]);
        }
    }
    add(Feature::Kind::pores, "void", diameters);
    if (static_cast<double>(open_voxels) * voxel_volume > foam_void * found.extent.prod()) {
        auto geometry = vol2pack::measure_image(solid_of(volume), found.extent.minCoeff(), threads);
        std::vector<double>& thickness = geometry.label[1].thickness;
        if (!thickness.empty())
            found.features.push_back({Feature::Kind::struts, "solid", static_cast<std::int64_t>(thickness.size()),
                                      thickness[thickness.size() / 2], thickness[thickness.size() / 20]});
    }
    return found;
}

}  // namespace tomodem::plan
