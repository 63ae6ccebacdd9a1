#include "tools/segment/separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/base/error.hpp"
#include "tools/segment/itk_filters.hpp"

namespace tomodem::segment {
namespace {

/// Calls visit(k, count, labels) for the slabs of a volume.
template <class Visit>
void for_each_slab(const LabelVolume& volume, const Visit& visit) {
    const std::int32_t depth = volume.size()[2];
    std::vector<std::int32_t> labels;
    for (std::int32_t k = 0; k < depth; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, depth - k);
        volume.slices(k, count, labels);
        visit(k, count, labels);
    }
}

/// Calls visit(i, j) for each two voxels that share a face.
template <class Visit>
void for_each_face(const VoxelIndex& size, const Visit& visit) {
    const std::int64_t row = size[0], page = row * size[1];
    for (std::int32_t z = 0; z < size[2]; ++z)
        for (std::int32_t y = 0; y < size[1]; ++y)
            for (std::int32_t x = 0; x < size[0]; ++x) {
                const std::int64_t at = z * page + y * row + x;
                if (x + 1 < size[0]) visit(at, at + 1);
                if (y + 1 < size[1]) visit(at, at + row);
                if (z + 1 < size[2]) visit(at, at + page);
            }
}

/// Joins small parts with their neighbours, the smallest first.
/// @return for each part the one that it belongs to now, itself if it stays, or 0 if it is small and alone
std::vector<std::int32_t> join_small(const Watershed& parts, const std::vector<std::int64_t>& voxels,
                                     const VoxelIndex& size, std::int64_t min_voxels) {
    std::vector<std::int32_t> owner(voxels.size());
    std::iota(owner.begin(), owner.end(), 0);
    std::map<std::int32_t, std::map<std::int32_t, std::int64_t>> faces;  // of each small part with others
    std::set<std::pair<std::int64_t, std::int32_t>> waiting;
    for (std::int32_t part = 1; part <= parts.count; ++part)
        if (voxels[part] < min_voxels) waiting.emplace(voxels[part], part);
    if (waiting.empty()) return owner;
    for_each_face(size, [&](std::int64_t i, std::int64_t j) {
        const std::int32_t a = parts.part[i], b = parts.part[j];
        if (a == b || a == 0 || b == 0) return;
        if (voxels[a] < min_voxels) ++faces[a][b];
        if (voxels[b] < min_voxels) ++faces[b][a];
    });
    std::vector<std::int64_t> now = voxels;
    const auto owner_of = [&](std::int32_t part) {
        while (part != 0 && owner[part] != part) part = owner[part];
        return part;
    };
    while (!waiting.empty()) {
        const auto [count, part] = *waiting.begin();
        waiting.erase(waiting.begin());
        std::map<std::int32_t, std::int64_t> shared;
        for (const auto& [other, number] : faces[part])
            if (const std::int32_t root = owner_of(other); root != part) shared[root] += number;
        const auto most = std::max_element(shared.begin(), shared.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        if (most == shared.end()) {
            owner[part] = 0;
            continue;
        }
        const std::int32_t into = most->first;
        if (now[into] < min_voxels) waiting.erase({now[into], into});
        owner[part] = into;
        now[into] += count;
        if (now[into] < min_voxels) {
            for (const auto& [other, number] : faces[part]) faces[into][other] += number;
            waiting.emplace(now[into], into);
        }
    }
    for (std::int32_t part = 1; part <= parts.count; ++part) owner[part] = owner_of(part);
    return owner;
}

/// The label outside the phase that most faces of each removed part touch.
std::map<std::int32_t, std::int32_t> labels_around(const Watershed& parts, const std::vector<std::int32_t>& owner,
                                                   const LabelVolume& volume) {
    std::map<std::int32_t, std::map<std::int32_t, std::int64_t>> faces;
    const LabelVolume::Sampler sampler(volume);
    const VoxelIndex size = volume.size();
    const std::int64_t row = size[0], page = row * size[1];
    const auto label_at = [&](std::int64_t at) {
        return sampler.at({static_cast<std::int32_t>(at % row), static_cast<std::int32_t>(at % page / row),
                           static_cast<std::int32_t>(at / page)});
    };
    for_each_face(size, [&](std::int64_t i, std::int64_t j) {
        for (const auto& [of, beside] : {std::pair(i, j), std::pair(j, i)})
            if (const std::int32_t part = parts.part[of]; part != 0 && owner[part] == 0 && parts.part[beside] == 0)
                ++faces[part][label_at(beside)];
    });
    std::map<std::int32_t, std::int32_t> around;
    for (const auto& [part, labels] : faces)
        around[part] = std::max_element(labels.begin(), labels.end(), [](const auto& a, const auto& b) {
                           return a.second < b.second;
                       })->first;
    return around;
}

/// Separates one label and writes its objects into `result`.
SeparatedLabel separate(const LabelVolume& volume, std::int32_t label, std::int32_t first, double min_depth,
                        std::int64_t min_voxels, LabelVolume& result, Reporter& reporter) {
    const VoxelIndex size = volume.size();
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    Watershed parts;
    {
        std::vector<std::uint8_t> outside(static_cast<std::size_t>(page) * size[2]);
        for_each_slab(volume, [&](std::int32_t k, std::int32_t, const std::vector<std::int32_t>& labels) {
            std::transform(labels.begin(), labels.end(), outside.begin() + k * page,
                           [label](std::int32_t other) { return static_cast<std::uint8_t>(other != label); });
        });
        parts = watershed(std::move(outside), size, volume.spacing(), min_depth, volume.threads(), reporter);
    }
    std::vector<std::int64_t> voxels(static_cast<std::size_t>(parts.count) + 1);
    for (const std::int32_t part : parts.part) ++voxels[part];
    const auto owner = join_small(parts, voxels, size, min_voxels);
    SeparatedLabel found{.label = label, .first = first};
    for (std::int32_t part = 1; part <= parts.count; ++part) {
        found.joined += owner[part] != part && owner[part] != 0;
        found.removed += owner[part] == 0;
    }
    const auto around =
        found.removed > 0 ? labels_around(parts, owner, volume) : std::map<std::int32_t, std::int32_t>{};

    const Components components =
        connected_components(volume, {label}, Joining::same_label, Connectivity::faces, reporter);
    std::vector<std::int32_t> number_of(owner.size());
    std::vector<std::int64_t> objects_of(components.voxels.size() + 1);
    std::vector<std::int32_t> component;
    for_each_slab(result, [&](std::int32_t k, std::int32_t count, std::vector<std::int32_t>& labels) {
        components.number.slices(k, count, component);
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const std::int32_t part = parts.part[k * page + static_cast<std::int64_t>(i)];
            if (part == 0) continue;
            if (owner[part] == 0) {
                labels[i] = around.contains(part) ? around.at(part) : 0;
                continue;
            }
            std::int32_t& number = number_of[owner[part]];
            if (number == 0) {
                found.voxels.push_back(0);
                number = static_cast<std::int32_t>(found.voxels.size());
                ++objects_of[component[i]];
            }
            ++found.voxels[number - 1];
            labels[i] = first + number - 1;
        }
        result.set_slices(k, count, labels);
    });
    if (found.voxels.empty())
        throw InvalidInput(
            fmt::format("nothing is left of label {}: each of its {} objects has fewer than {} voxels; "
                        "give a smaller --min-voxels",
                        label, parts.count, min_voxels));
    found.components = static_cast<std::int64_t>(components.voxels.size());
    found.components_cut =
        std::count_if(objects_of.begin(), objects_of.end(), [](auto objects) { return objects > 1; });
    return found;
}

}  // namespace

Separation separate_objects(const LabelVolume& volume, const std::vector<std::int32_t>& labels, double min_depth,
                            std::int64_t min_voxels, Reporter& reporter) {
    std::int32_t first = 1;
    for (const auto& [label, voxels] : volume.histogram())
        if (!std::binary_search(labels.begin(), labels.end(), label)) first = std::max(first, label + 1);
    Separation separation{LabelVolume(volume.size(), volume.spacing(), volume.origin()), {}};
    separation.volume.use_threads(volume.threads());
    for_each_slab(volume, [&](std::int32_t k, std::int32_t count, const std::vector<std::int32_t>& slab) {
        separation.volume.set_slices(k, count, slab);
    });
    for (const std::int32_t label : labels) {
        separation.labels.push_back(separate(volume, label, first, min_depth, min_voxels, separation.volume, reporter));
        first = separation.labels.back().last() + 1;
    }
    return separation;
}

std::int64_t touching_objects(const LabelVolume& volume, std::int32_t first) {
    const VoxelIndex size = volume.size();
    const std::int64_t row = size[0], page = row * size[1];
    std::set<std::int32_t> touching;
    const auto look = [&](std::int32_t a, std::int32_t b) {
        if (a != b && a >= first && b >= first) touching.insert({a, b});
    };
    std::vector<std::int32_t> below;
    for_each_slab(volume, [&](std::int32_t, std::int32_t count, const std::vector<std::int32_t>& labels) {
        for_each_face({size[0], size[1], count}, [&](std::int64_t i, std::int64_t j) { look(labels[i], labels[j]); });
        for (std::size_t i = 0; i < below.size(); ++i) look(below[i], labels[i]);
        below.assign(labels.end() - page, labels.end());
    });
    return static_cast<std::int64_t>(touching.size());
}

}  // namespace tomodem::segment
