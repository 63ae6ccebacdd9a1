#include "tools/plan/objects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/error.hpp"

namespace tomodem::plan {
namespace {

/// Connected parts of a label that is an object, on average; noise has more.
constexpr double parts_of_a_label = 20;
/// More objects than any image has.
constexpr std::int32_t last_separated = 99'999'999;

std::vector<LabelObjects> ranges_without(const std::map<std::int32_t, std::int64_t>& histogram, std::int32_t phase,
                                         const std::vector<std::int32_t>& others) {
    std::vector<LabelObjects> ranges;
    bool continues = false;
    for (const auto& [label, voxels] : histogram) {
        if (label == 0) continue;
        const bool is_object = std::find(others.begin(), others.end(), label) == others.end();
        if (is_object && continues) ranges.back().last = label;
        if (is_object && !continues) ranges.push_back({label, label, phase});
        continues = is_object;
    }
    return ranges;
}

}  // namespace

bool looks_labelled(const LabelVolume& volume) {
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : volume.histogram())
        if (label != 0) labels.push_back(label);
    const Components parts = connected_components(volume, labels, Joining::same_label);
    return static_cast<double>(parts.voxels.size()) < parts_of_a_label * static_cast<double>(labels.size());
}

std::int32_t phase_of_objects(const Scene& scene) {
    std::vector<std::string> marked;
    std::int32_t label = scene.phases.front().label;
    for (const Phase& phase : scene.phases)
        if (phase.objects) {
            marked.push_back(phase.name);
            label = phase.label;
        }
    if (marked.size() > 1)
        throw InvalidInput(
            fmt::format("scene '{}' marks the objects of {} phases ({}): --objects watershed and labels "
                        "tell those of one apart; leave objects = true at one, or use --objects components",
                        scene.path.string(), marked.size(), fmt::join(marked, ", ")));
    if (marked.empty() && scene.phases.size() > 1)
        throw InvalidInput(
            fmt::format("scene '{}' marks no phase with objects = true, which --objects watershed and "
                        "labels need",
                        scene.path.string()));
    return label;
}

LabelledObjects take_labels(LabelVolume& volume, std::int32_t phase, const std::vector<std::int32_t>& others) {
    LabelledObjects objects{phase, ranges_without(volume.histogram(), phase, others), {}};
    if (objects.ranges.empty())
        throw InvalidInput(
            "--objects labels: the image has no label that is not another phase's; --objects components makes an "
            "object of each connected part");
    objects.voxels =
        distinguish_regions(volume, {}, objects.ranges, Connectivity::faces, Regions::Of::objects)->components.voxels;
    return objects;
}

std::string vol2pack_options(ObjectsBy by, const std::vector<std::int32_t>& labels,
                             const std::vector<LabelObjects>& ranges) {
    if (by == ObjectsBy::components)
        return labels.empty() ? std::string{} : fmt::format("--objects {}", fmt::join(labels, ","));
    std::vector<std::string> texts;
    texts.reserve(ranges.size());
    for (const LabelObjects& range : ranges)
        texts.push_back(fmt::format("{}:{}={}", range.first, range.last, range.species));
    return fmt::format("--label-objects {}", fmt::join(texts, ","));
}

LabelObjects separated_range(const std::vector<std::int32_t>& labels, std::int32_t phase) {
    std::int32_t kept = 0;
    for (const std::int32_t label : labels)
        if (label != phase) kept = std::max(kept, label);
    return {kept + 1, last_separated, phase};
}

}  // namespace tomodem::plan
