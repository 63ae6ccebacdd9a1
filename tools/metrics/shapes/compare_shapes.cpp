#include "tools/metrics/shapes/compare_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "core/base/error.hpp"
#include "tools/metrics/shapes/assignment.hpp"

namespace tomodem::shapes {
namespace {

/// Calls visit(offset, count, voxels...) for slabs of volumes of one size.
template <class Visit>
void for_each_slab(const LabelVolume& a, const LabelVolume& b, const Visit& visit) {
    std::vector<std::int32_t> of_a, of_b;
    for (std::int32_t k = 0; k < a.size()[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, a.size()[2] - k);
        a.slices(k, count, of_a);
        b.slices(k, count, of_b);
        visit(of_a, of_b);
    }
}

using PairCounts = std::map<std::pair<std::int32_t, std::int32_t>, std::int64_t>;

/// Voxels of each pair of labels.
PairCounts count_pairs(const LabelVolume& a, const LabelVolume& b) {
    PairCounts counts;
    for_each_slab(a, b, [&](const std::vector<std::int32_t>& of_a, const std::vector<std::int32_t>& of_b) {
        for (std::size_t i = 0; i < of_a.size();) {
            const std::size_t start = i;
            while (++i < of_a.size() && of_a[i] == of_a[start] && of_b[i] == of_b[start]) {
            }
            counts[{of_a[start], of_b[start]}] += static_cast<std::int64_t>(i - start);
        }
    });
    return counts;
}

double ball_radius(double volume) {
    return std::cbrt(0.75 * volume / std::numbers::pi);
}

double closed_porosity(const LabelVolume& volume, Connectivity connectivity) {
    const VoidParts parts = void_parts(volume, connectivity, {.min_voxels = 1});
    return double(parts.closed_voxels) / double(parts.voxels - parts.open_voxels);
}

}  // namespace

std::vector<RunBody> measure_objects(const Packing& packing, const AlphaSurface& surface,
                                     const std::vector<Object>& objects, int axis) {
    const double box_share = packing.box.volume() / double(packing.size());
    const std::vector<ObjectVolume> volumes = object_volumes(surface, objects, box_share);
    std::vector<RunBody> bodies;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const Object& object = objects[i];
        bodies.push_back({object.number, object.species, std::int64_t(object.members.size()), object.at_boundary,
                          shape_of(mean_of(packing.position, object.members), volumes[i].volume,
                                   second_moments(packing.position, object.members), axis)});
    }
    return bodies;
}

std::vector<RunBody> bodies_of_pores(const VoidParts& parts) {
    std::vector<RunBody> bodies;
    for (const ImageBody& pore : parts.closed) bodies.push_back({pore.number, 0, 0, pore.at_boundary, pore.shape});
    return bodies;
}

const char* name_of(MatchedBy matched) {
    switch (matched) {
        case MatchedBy::overlap:
            return "overlap";
        case MatchedBy::centre:
            return "centre";
        case MatchedBy::run_only:
            return "run_only";
        case MatchedBy::image_only:
            break;
    }
    return "image_only";
}

Comparison compare(const LabelVolume& run, const Side<RunBody>& run_side, const LabelVolume& image,
                   const Side<ImageBody>& image_side, Connectivity connectivity) {
    Comparison result;
    const VoxelIndex size = image.size();
    result.voxels = std::int64_t{size[0]} * size[1] * size[2];
    for (const auto& [labels, voxels] : count_pairs(image, run)) {
        result.phase[labels.first].image += voxels;
        result.phase[labels.second].run += voxels;
        if (labels.first != labels.second) continue;
        result.phase[labels.first].both += voxels;
        result.equal += voxels;
    }
    result.image_porosity = closed_porosity(image, connectivity);
    result.run_porosity = closed_porosity(run, connectivity);

    const auto& bodies = run_side.bodies;
    const auto& objects = image_side.bodies;
    std::map<std::int32_t, std::size_t> run_place, image_place;
    for (std::size_t i = 0; i < bodies.size(); ++i) run_place[bodies[i].number] = i;
    for (std::size_t i = 0; i < objects.size(); ++i) image_place[objects[i].number] = i;
    std::vector<std::int64_t> run_voxels(bodies.size(), 0);
    PairCounts shared;
    const auto number = [](const auto& side, std::int32_t region) {
        return side.number_of_region.empty() ? region : side.number_of_region[region];
    };
    for (const auto& [regions, voxels] : count_pairs(image_side.region, run_side.region)) {
        const std::int32_t of_image = number(image_side, regions.first), of_run = number(run_side, regions.second);
        const auto body = run_place.find(of_run);
        if (body == run_place.end()) continue;
        run_voxels[body->second] += voxels;
        if (of_image > 0) shared[{of_run, of_image}] += voxels;
    }
    const auto match_of = [&](std::int32_t number_run, std::int32_t number_image, MatchedBy by) {
        Match match{by, &bodies[run_place.at(number_run)], &objects[image_place.at(number_image)]};
        const auto found = shared.find({number_run, number_image});
        const double both = found == shared.end() ? 0.0 : double(found->second);
        const double sum = double(run_voxels[run_place.at(number_run)] + match.image->voxels);
        match.dice = 2.0 * both / sum;
        match.iou = both / (sum - both);
        return match;
    };
    std::vector<Candidate> candidates;
    for (const auto& [numbers, voxels] : shared)
        candidates.push_back(
            {numbers.first, numbers.second, match_of(numbers.first, numbers.second, MatchedBy::overlap).dice});
    std::set<std::int32_t> done_run, done_image;
    const auto take = [&](MatchedBy by) {
        for (const auto& [number_run, number_image] : best_pairs(candidates)) {
            result.matches.push_back(match_of(number_run, number_image, by));
            done_run.insert(number_run);
            done_image.insert(number_image);
        }
        candidates.clear();
    };
    take(MatchedBy::overlap);
    for (const RunBody& of_run : bodies)
        for (const ImageBody& of_image : objects) {
            if (done_run.contains(of_run.number) || done_image.contains(of_image.number)) continue;
            const double reach = 2.0 * (ball_radius(of_run.shape.volume) + ball_radius(of_image.shape.volume));
            const double distance = (of_run.shape.centre - of_image.shape.centre).norm();
            if (distance < reach) candidates.push_back({of_run.number, of_image.number, 1.0 - distance / reach});
        }
    take(MatchedBy::centre);
    for (const RunBody& of_run : bodies)
        if (!done_run.contains(of_run.number)) result.matches.push_back({MatchedBy::run_only, &of_run, nullptr});
    std::sort(result.matches.begin(), result.matches.end(),
              [](const Match& a, const Match& b) { return a.run->number < b.run->number; });
    for (const ImageBody& of_image : objects)
        if (!done_image.contains(of_image.number))
            result.matches.push_back({MatchedBy::image_only, nullptr, &of_image});
    return result;
}

Vec3 centre_of_matter(const LabelVolume& image) {
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : image.histogram())
        if (label != 0) labels.push_back(label);
    if (labels.empty()) throw InvalidInput("all of the image is void (label 0): there is nothing to compare");
    Vec3 sum = Vec3::Zero();
    double voxels = 0.0;
    for (const VoxelSums& of_label : voxel_sums(image, labels)) {
        for (int c = 0; c < 3; ++c) sum[c] += double(of_label.sum[c]);
        voxels += double(of_label.voxels);
    }
    return image.origin() + image.spacing().cwiseProduct(sum / voxels + Vec3::Constant(0.5));
}

void require_same_place(const LabelVolume& image, const Packing& packing) {
    Vec3 low = packing.position.front(), high = low;
    for (const Vec3& p : packing.position) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    low -= Vec3::Constant(packing.seed_radius);
    high += Vec3::Constant(packing.seed_radius);
    const Vec3 image_low = image.origin(), image_high = image_low + image.extent();
    const auto text = [](const Vec3& v) { return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", v.x(), v.y(), v.z()); };
    const double ratio = image.extent().prod() / (high - low).prod();
    if (ratio > 4.0 || ratio < 0.25)
        throw InvalidInput(fmt::format(
            "the image is {} and the run at that frame {}: they are not of the same sample; check --voxel-size, --roi "
            "and --bin",
            text(image.extent()), text(high - low)));
    const Vec3 common = (image_high.cwiseMin(high) - image_low.cwiseMax(low)).cwiseMax(0.0);
    if (common.prod() < 0.5 * std::min(image.extent().prod(), (high - low).prod()))
        throw InvalidInput(fmt::format(
            "the image begins at {:.4g}, {:.4g}, {:.4g} mm and the run at {:.4g}, {:.4g}, {:.4g} mm: they hardly "
            "overlap; give --align centre, or --origin",
            image_low.x(), image_low.y(), image_low.z(), low.x(), low.y(), low.z()));
}

}  // namespace tomodem::shapes
