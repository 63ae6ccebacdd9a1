#include "tools/vol2pack/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::vol2pack {
namespace {

/// Finds labels and regions; one a thread.
class Labeller {
 public:
    Labeller(const LabelVolume& volume, const Components* components, const LabelFilter& filter, double seed_radius)
        : volume_(volume), components_(components), sampler_(volume), filter_(filter) {
        if (components) numbers_.emplace(components->number);
        if (filter.kind == Filter::box) reach_.setConstant(filter.box_size * seed_radius);
        if (filter.kind == Filter::level_set) reach_ = std::ceil(3.5 * filter.smoothing) * volume.spacing();
    }

    std::int32_t label(const Vec3& point) const {
        if (filter_.kind == Filter::nearest) return sampler_.nearest(point);
        return filter_.kind == Filter::box ? sampler_.majority(point, reach_[0])
                                           : sampler_.level_set(point, filter_.smoothing);
    }

    /// Region of a particle of this label: the one under it, or where a filter gave it a label that the voxel under it
    /// does not have, the one with the nearest voxel of that label that the filter looked at. 0: none.
    std::int32_t region(const Vec3& point, std::int32_t label) const {
        const std::int32_t under = numbers_->nearest(point);
        if (under > 0 && components_->label[under - 1] == label) return under;
        if (filter_.kind == Filter::nearest) return 0;
        VoxelIndex first, last;
        const Vec3 at = (point - volume_.origin()).cwiseQuotient(volume_.spacing());
        for (int axis = 0; axis < 3; ++axis) {
            const double half = reach_[axis] / volume_.spacing()[axis];
            first[axis] = std::max(0, static_cast<std::int32_t>(std::floor(at[axis] - half)));
            last[axis] = std::min(volume_.size()[axis] - 1, static_cast<std::int32_t>(std::floor(at[axis] + half)));
        }
        std::int32_t nearest = 0;
        double smallest = std::numeric_limits<double>::infinity();
        for (std::int32_t z = first[2]; z <= last[2]; ++z)
            for (std::int32_t y = first[1]; y <= last[1]; ++y)
                for (std::int32_t x = first[0]; x <= last[0]; ++x) {
                    const std::int32_t number = numbers_->at({x, y, z});
                    if (number == 0 || components_->label[number - 1] != label) continue;
                    const Vec3 centre(x + 0.5, y + 0.5, z + 0.5);
                    const double distance = (centre - at).cwiseProduct(volume_.spacing()).squaredNorm();
                    if (distance < smallest) {
                        smallest = distance;
                        nearest = number;
                    }
                }
        return nearest;
    }

 private:
    const LabelVolume& volume_;
    const Components* components_;
    LabelVolume::Sampler sampler_;
    std::optional<LabelVolume::Sampler> numbers_;
    LabelFilter filter_;
    Vec3 reach_ = Vec3::Zero();
};

/// Places that one thread looks at in one go.
constexpr std::int64_t piece_size = 1 << 14;

/// Calls visit(piece, first, end) for all places, piece by piece.
template <class Visit>
void for_each_piece(const Tiling& tiling, int threads, const Visit& visit) {
    parallel_for((tiling.places() + piece_size - 1) / piece_size, threads, [&](std::int64_t piece) {
        visit(piece, piece * piece_size, std::min((piece + 1) * piece_size, tiling.places()));
    });
}

/// Numbers the objects and counts their particles; `packing.object` holds regions before and objects after.
void number_objects(Sample& sample, const Regions& regions) {
    const std::size_t count = regions.is_object.size();
    std::vector<std::int64_t> particles(count + 1, 0);
    for (const std::int32_t region : sample.packing.object) ++particles[region];
    const std::int32_t largest =
        regions.image_label.empty() ? 0 : *std::max_element(regions.image_label.begin(), regions.image_label.end());
    std::vector<std::int32_t> number(count + 1, 0);
    std::map<std::int32_t, std::int64_t> objects;
    std::int32_t next = largest;
    for (std::size_t region = 1; region <= count; ++region) {
        if (!regions.is_object[region - 1]) continue;
        ++sample.components;
        if (particles[region] == 0) continue;
        const std::int32_t label = regions.image_label[region - 1];
        number[region] = label > 0 ? label : ++next;
        objects[number[region]] = particles[region];
    }
    for (const auto& [object, of_object] : objects) {
        sample.object_number.push_back(object);
        sample.object_particles.push_back(of_object);
    }
    for (std::int32_t& region : sample.packing.object) region = number[region];
}

}  // namespace

std::map<std::int32_t, std::int64_t> Places::count() const {
    std::map<std::int32_t, std::int64_t> counts;
    for (std::size_t i = 0; i < label.size();) {
        const std::size_t start = i;
        while (i < label.size() && label[i] == label[start]) ++i;
        if (label[start] >= 0) counts[label[start]] += static_cast<std::int64_t>(i - start);
    }
    return counts;
}

std::int64_t Sample::lost_components() const {
    return components - static_cast<std::int64_t>(object_particles.size());
}

Places label_places(const LabelVolume& volume, const Tiling& tiling, const Regions* regions, const LabelFilter& filter,
                    int threads, Reporter& reporter) {
    const auto labels = volume.histogram();
    if (!labels.empty() && labels.begin()->first < 0)
        throw InvalidInput(fmt::format("the image has the negative label {}", labels.begin()->first));
    Places places;
    places.label.assign(tiling.places(), Places::outside);
    if (regions) places.region.assign(tiling.places(), 0);
    const auto progress = reporter.progress("labels of particles", static_cast<double>(tiling.places()));
    std::mutex one_at_a_time;
    std::int64_t done = 0;
    for_each_piece(tiling, threads, [&](std::int64_t, std::int64_t first, std::int64_t end) {
        const Labeller labeller(volume, regions ? &regions->components : nullptr, filter, tiling.seed_radius());
        for (std::int64_t place = first; place < end; ++place) {
            const Vec3 inside = tiling.from_corner(place);
            if (!tiling.in_margin(inside)) continue;
            const bool in_box = tiling.in_box(inside);
            const Vec3 position = volume.origin() + (in_box ? inside : tiling.mirrored(inside));
            const std::int32_t label = labeller.label(position);
            places.label[place] = in_box ? label : -1 - label;
            if (regions && in_box) places.region[place] = labeller.region(position, places.label[place]);
        }
        const std::scoped_lock lock(one_at_a_time);
        progress->update(static_cast<double>(done += end - first));
    });
    return places;
}

Sample sample_volume(const LabelVolume& volume, const Tiling& tiling, const Regions* regions, const LabelFilter& filter,
                     int threads, Reporter& reporter) {
    Sample sample;
    sample.places = label_places(volume, tiling, regions, filter, threads, reporter);
    const Places& places = sample.places;
    sample.labelled = places.count();
    for (const auto& [label, particles] : sample.labelled) sample.candidates += particles;

    const auto kept = [&](std::int64_t place) { return places.label[place] > 0; };
    std::vector<std::int64_t> start((tiling.places() + piece_size - 1) / piece_size + 1, 0);
    for_each_piece(tiling, threads, [&](std::int64_t piece, std::int64_t first, std::int64_t end) {
        for (std::int64_t place = first; place < end; ++place) start[piece + 1] += kept(place);
    });
    std::partial_sum(start.begin(), start.end(), start.begin());
    const std::int64_t total = start.back();
    if (total == 0)
        throw InvalidInput(fmt::format("no particle is left: {}",
                                       sample.candidates == 0
                                           ? "the image is smaller than a particle; use fewer pixels per seed"
                                           : "all of them lie in void (label 0); check the labels or the threshold"));
    Packing& packing = sample.packing;
    packing.box = tiling.box();
    packing.seed_radius = tiling.seed_radius();
    packing.brick_density = tiling.density();
    packing.position.resize(total);
    packing.species.resize(total);
    packing.id.resize(total);
    if (tiling.has_radii()) packing.radius.resize(total);
    const bool objects =
        regions && std::find(regions->is_object.begin(), regions->is_object.end(), true) != regions->is_object.end();
    if (objects) packing.object.resize(total);
    for_each_piece(tiling, threads, [&](std::int64_t piece, std::int64_t first, std::int64_t end) {
        std::int64_t at = start[piece];
        for (std::int64_t place = first; place < end; ++place) {
            if (!kept(place)) continue;
            packing.position[at] = volume.origin() + tiling.from_corner(place);
            packing.species[at] = places.label[place];
            packing.id[at] = at + 1;
            if (tiling.has_radii()) packing.radius[at] = tiling.radius(place);
            if (objects) packing.object[at] = places.region[place];
            ++at;
        }
    });
    if (objects) number_objects(sample, *regions);
    return sample;
}

}  // namespace tomodem::vol2pack
