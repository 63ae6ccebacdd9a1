#include "tools/plan/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/base/error.hpp"
#include "tools/vol2pack/geometric_error.hpp"

namespace tomodem::plan {
namespace {

constexpr std::int64_t min_voxels = 27;
/// Of a phase in one part: more is one body, or many that touch.
constexpr double most_of_a_phase = 0.9;
/// Diameter of the sphere of a part's volume over its thickness; of a cube 1.24. More is no compact body.
constexpr double compact = 2;
/// Void at the faces, share of the image: more is a foam.
constexpr double foam_void = 0.3;

double equivalent_diameter(double volume) {
    return std::cbrt(6 * volume / std::numbers::pi);
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
                fmt::format("scene '{}' has no phase with label {}, which the image has; add one, rename the label "
                            "with --relabel, or give --objects labels if each label is one object",
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

ImageFeatures find_features(const LabelVolume& volume, const Scene& scene, int threads, ObjectsBy by,
                            const LabelledObjects* labelled) {
    const std::map<std::int32_t, std::int64_t> histogram = volume.histogram();
    check_labels(histogram, scene);
    ImageFeatures found;
    found.extent = volume.extent();
    found.origin = volume.origin();
    found.voxel = volume.spacing()[0];
    const double voxel_volume = volume.spacing().prod();
    const double cap = found.extent.minCoeff();
    std::int32_t matrix = 0;
    for (const auto& [label, voxels] : histogram) {
        if (label == 0) continue;
        found.labels.push_back(label);
        found.solid_volume += static_cast<double>(voxels) * voxel_volume;
        if (matrix == 0 || voxels > histogram.at(matrix)) matrix = label;
    }

    const auto add_thickness = [&](Feature::Kind kind, const std::string& name, std::vector<double>& thickness) {
        if (thickness.empty()) return;
        found.features.push_back({kind, name,
                                  kind == Feature::Kind::objects ? 0 : static_cast<std::int64_t>(thickness.size()),
                                  thickness[thickness.size() / 2], thickness[thickness.size() / 20]});
    };
    const auto add = [&](Feature::Kind kind, const std::string& name, const std::vector<double>& diameters) {
        if (diameters.empty()) return;
        found.features.push_back({kind, name, static_cast<std::int64_t>(diameters.size()), median_by_volume(diameters),
                                  *std::min_element(diameters.begin(), diameters.end())});
    };
    std::optional<vol2pack::ImageGeometry> geometry;
    const auto thickness_of = [&](std::int32_t label) -> std::vector<double>& {
        if (!geometry) geometry = vol2pack::measure_image(volume, cap, threads);
        return geometry->label[label].thickness;
    };
    const bool marked =
        std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.objects; });
    for (const Phase& phase : scene.phases) {
        const bool of_labels = labelled != nullptr && phase.label == labelled->phase;
        if (!of_labels && (marked ? !phase.objects : phase.label == matrix)) continue;
        if (by == ObjectsBy::watershed) {
            add_thickness(Feature::Kind::objects, phase.name, thickness_of(phase.label));
            continue;
        }
        const std::vector<std::int64_t> sizes =
            of_labels ? labelled->voxels : connected_components(volume, {phase.label}).voxels;
        std::vector<double> diameters;
        for (const std::int64_t voxels : sizes)
            if (voxels >= min_voxels)
                diameters.push_back(equivalent_diameter(static_cast<double>(voxels) * voxel_volume));
        if (diameters.empty()) continue;
        add(Feature::Kind::objects, phase.name, diameters);
        Feature& objects = found.features.back();
        const std::int64_t largest = *std::max_element(sizes.begin(), sizes.end());
        objects.largest_share = static_cast<double>(largest) / static_cast<double>(histogram.at(phase.label));
        if (of_labels || objects.largest_share < most_of_a_phase) continue;
        const std::vector<double>& thickness = thickness_of(phase.label);
        if (thickness.empty() || equivalent_diameter(static_cast<double>(largest) * voxel_volume) <
                                     compact * thickness[thickness.size() / 2])
            continue;
        objects.tangled = true;
        objects.median = thickness[thickness.size() / 2];
        objects.smallest = thickness[thickness.size() / 20];
    }
    if (!histogram.contains(0)) return found;

    std::vector<double> diameters, cut;
    double open_volume = 0;
    for (const VoidPart& part : void_parts(connected_components(volume, {0}))) {
        found.void_volume += part.volume;
        if (part.wall() == 0) open_volume += part.volume;
        if (part.voxels < min_voxels) continue;
        found.voids.push_back(part);
        // It passes through if it meets two opposite faces.
        const bool through = ((part.wall_low + part.wall_high).array() == 0).any();
        if (!through) (part.wall() > 0 ? diameters : cut).push_back(part.diameter());
    }
    add(Feature::Kind::pores, "void", diameters.empty() ? cut : diameters);
    if (open_volume > foam_void * found.extent.prod()) {
        auto solid = vol2pack::measure_image(solid_of(volume), cap, threads);
        add_thickness(Feature::Kind::struts, "solid", solid.label[1].thickness);
    }
    return found;
}

}  // namespace tomodem::plan
