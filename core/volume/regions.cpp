#include "core/volume/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/error.hpp"

namespace tomodem {

namespace {

/// The range that holds a label. @param objects  sorted
const LabelObjects* range_of(std::int32_t label, const std::vector<LabelObjects>& objects) {
    const auto after = std::upper_bound(objects.begin(), objects.end(), label,
                                        [](std::int32_t value, const auto& range) { return value < range.first; });
    return after != objects.begin() && label <= std::prev(after)->last ? &*std::prev(after) : nullptr;
}

}  // namespace

Histogram species_histogram(const LabelVolume& volume, const std::vector<LabelObjects>& objects) {
    Histogram species;
    for (const auto& [label, voxels] : volume.histogram()) {
        const LabelObjects* const range = range_of(label, objects);
        species[range ? range->species : label] += voxels;
    }
    return species;
}

Regions component_regions(const LabelVolume& volume, const std::vector<std::int32_t>& labels,
                          const std::vector<std::int32_t>& object_labels, Connectivity connectivity,
                          Reporter& reporter) {
    Regions regions{connected_components(volume, labels, Joining::same_label, connectivity, reporter), {}, {}};
    for (const std::int32_t label : regions.components.label)
        regions.is_object.push_back(std::find(object_labels.begin(), object_labels.end(), label) !=
                                    object_labels.end());
    regions.image_label.assign(regions.is_object.size(), 0);
    return regions;
}

void take_label_objects(LabelVolume& volume, Regions& regions, const std::vector<LabelObjects>& objects,
                        Reporter& reporter) {
    Components& components = regions.components;
    std::map<std::int32_t, std::int32_t> region_of;
    for (const auto& [label, voxels] : volume.histogram())
        if (const LabelObjects* range = range_of(label, objects)) {
            components.voxels.push_back(voxels);
            components.label.push_back(range->species);
            regions.image_label.push_back(label);
            regions.is_object.push_back(true);
            region_of[label] = static_cast<std::int32_t>(components.voxels.size());
        }
    for (const LabelObjects& range : objects)
        if (const auto found = region_of.lower_bound(range.first);
            found == region_of.end() || found->first > range.last)
            throw InvalidInput(
                fmt::format("the image has no label from {} to {} to make objects of", range.first, range.last));
    const std::int32_t depth = volume.size()[2];
    std::vector<std::int32_t> labels, numbers;
    const auto progress = reporter.progress("label objects", depth);
    for (std::int32_t k = 0; k < depth; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, depth - k);
        volume.slices(k, count, labels);
        components.number.slices(k, count, numbers);
        std::int32_t last = 0, region = 0, species = 0;  // 0 is no label of an object
        for (std::size_t i = 0; i < labels.size(); ++i) {
            if (labels[i] != last) {
                last = labels[i];
                const LabelObjects* const range = range_of(last, objects);
                region = range ? region_of[last] : 0;
                species = range ? range->species : 0;
            }
            if (region == 0) continue;
            labels[i] = species;
            numbers[i] = region;
        }
        volume.set_slices(k, count, labels);
        components.number.set_slices(k, count, numbers);
        progress->update(k + count);
    }
}

std::optional<Regions> distinguish_regions(LabelVolume& volume, const std::vector<std::int32_t>& object_labels,
                                           const std::vector<LabelObjects>& objects, Connectivity connectivity,
                                           Regions::Of of, Reporter& reporter) {
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : volume.histogram())
        if (!range_of(label, objects) &&
            (of == Regions::Of::everything ||
             std::find(object_labels.begin(), object_labels.end(), label) != object_labels.end()))
            labels.push_back(label);
    if (labels.empty() && objects.empty()) return std::nullopt;
    Regions regions = component_regions(volume, labels, object_labels, connectivity, reporter);
    if (!objects.empty()) take_label_objects(volume, regions, objects, reporter);
    return regions;
}

}  // namespace tomodem
