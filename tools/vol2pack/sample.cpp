#include "tools/vol2pack/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "core/error.hpp"
#include "core/volume_parallel.hpp"

namespace tomodem {
namespace {

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// The brick at the sample's scale: positions in [0, edge) from its corner.
struct ScaledBrick {
    Vec3 edges;
    std::vector<Vec3> position;
};

ScaledBrick scale(const Packing& brick, const SampleOptions& options) {
    if (brick.size() == 0 || !(brick.seed_radius > 0) || !(brick.box.volume() > 0))
        throw InvalidInput("the brick has no particles, no seed radius or no volume; make one with packgen");
    if (!(brick.box.periodic[0] && brick.box.periodic[1] && brick.box.periodic[2]))
        throw InvalidInput(
            "the brick is not periodic along x, y and z, so it cannot be repeated; make one with packgen");
    const double factor = options.seed_radius / brick.seed_radius;
    ScaledBrick scaled{brick.box.edges * factor, {}};
    Vec3 shift = Vec3::Zero();
    if (options.random_seed != 0) {
        std::mt19937_64 random(options.random_seed);
        for (double& component : shift) component = uniform(random);
    }
    scaled.position.reserve(brick.size());
    for (const Vec3& position : brick.position) {
        Vec3 fraction = (position - brick.box.origin).cwiseQuotient(brick.box.edges) + shift;
        if (!fraction.allFinite()) throw InvalidInput("the brick has a position that is not a number");
        for (double& component : fraction) {
            component -= std::floor(component);
            if (component >= 1) component = 0;  // a negative number too small to change 1
        }
        scaled.position.push_back(fraction.cwiseProduct(scaled.edges));
    }
    return scaled;
}

/// Finds labels and objects; one a thread.
class Labeller {
 public:
    Labeller(const LabelVolume& volume, const std::optional<Components>& components, Filter filter, double half)
        : volume_(volume), components_(components), sampler_(volume), filter_(filter), half_(half) {
        if (components) numbers_.emplace(components->number);
    }

    std::int32_t label(const Vec3& point) const {
        return filter_ == Filter::nearest ? sampler_.nearest(point) : sampler_.majority(point, half_);
    }

    /// Component of a particle of this label: the one under it, or where the box filter gave it a label that the voxel
    /// under it does not have, the one with the nearest voxel of that label in the box. 0: none.
    std::int32_t component(const Vec3& point, std::int32_t label) const {
        const std::int32_t under = numbers_->nearest(point);
        if (under > 0 && components_->label[under - 1] == label) return under;
        if (filter_ == Filter::nearest) return 0;
        VoxelIndex first, last;
        const Vec3 at = (point - volume_.origin()).cwiseQuotient(volume_.spacing());
        for (int axis = 0; axis < 3; ++axis) {
            const double half = half_ / volume_.spacing()[axis];
            first[axis] = std::max(0, static_cast<std::int32_t>(std::floor(at[axis] - half)));
            last[axis] = std::min(volume_.size()[axis] - 1, static_cast<std::int32_t>(std::floor(at[axis] + half)));
        }
        std::int32_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::int32_t z = first[2]; z <= last[2]; ++z)
            for (std::int32_t y = first[1]; y <= last[1]; ++y)
                for (std::int32_t x = first[0]; x <= last[0]; ++x) {
                    const std::int32_t number = numbers_->at({x, y, z});
                    if (number == 0 || components_->label[number - 1] != label) continue;
                    const Vec3 centre(x + 0.5, y + 0.5, z + 0.5);
                    const double distance = (centre - at).cwiseProduct(volume_.spacing()).squaredNorm();
                    if (distance < least) {
                        least = distance;
                        nearest = number;
                    }
                }
        return nearest;
    }

 private:
    const LabelVolume& volume_;
    const std::optional<Components>& components_;
    LabelVolume::Sampler sampler_;
    std::optional<LabelVolume::Sampler> numbers_;
    Filter filter_;
    double half_;
};

/// The particles that one piece of one copy of the brick brings.
struct Piece {
    std::vector<Vec3> position;
    std::vector<std::int32_t> species, component;
    std::vector<double> radius;
    std::map<std::int32_t, std::int64_t> labelled;
};

}  // namespace

std::int64_t Sample::lost_components() const {
    return components - static_cast<std::int64_t>(object_particles.size());
}

Sample sample_volume(const LabelVolume& volume, const Packing& brick, const SampleOptions& options) {
    if (!(options.seed_radius > 0)) throw InvalidInput("the seed radius of a sample must be more than 0");
    const ScaledBrick scaled = scale(brick, options);
    const Vec3 extent = volume.extent();
    const double expected = brick.size() * (extent.prod() / scaled.edges.prod());
    if (expected > static_cast<double>(options.max_particles))
        throw InvalidInput(
            fmt::format("the image would be filled with about {:.3g} particles, more than the {} allowed; "
                        "use more pixels per seed, or allow more",
                        expected, options.max_particles));

    std::optional<Components> components;
    if (!options.object_labels.empty())
        components = connected_components(volume, options.object_labels, Joining::same_label);

    std::array<std::int64_t, 3> tiles;
    for (int axis = 0; axis < 3; ++axis)
        tiles[axis] = std::max<std::int64_t>(1, std::llround(std::ceil(extent[axis] / scaled.edges[axis])));
    constexpr std::int64_t piece_size = 1 << 15;
    const auto in_brick = static_cast<std::int64_t>(scaled.position.size());
    const std::int64_t pieces_per_tile = (in_brick + piece_size - 1) / piece_size;
    std::vector<Piece> pieces(tiles[0] * tiles[1] * tiles[2] * pieces_per_tile);
    const double half = (options.box_size > 0 ? options.box_size : 2 * options.seed_radius) / 2;
    parallel_for(static_cast<std::int64_t>(pieces.size()), options.threads, [&](std::int64_t number) {
        const Labeller labeller(volume, components, options.filter, half);
        Piece& piece = pieces[number];
        const std::int64_t tile = number / pieces_per_tile, first = number % pieces_per_tile * piece_size;
        const Vec3 index(static_cast<double>(tile % tiles[0]), static_cast<double>(tile / tiles[0] % tiles[1]),
                         static_cast<double>(tile / tiles[0] / tiles[1]));
        const Vec3 corner = index.cwiseProduct(scaled.edges);
        for (std::int64_t i = first; i < std::min(first + piece_size, in_brick); ++i) {
            const Vec3 inside = corner + scaled.position[i];
            if (!(inside.array() < extent.array()).all()) continue;
            const Vec3 position = volume.origin() + inside;
            const std::int32_t label = labeller.label(position);
            ++piece.labelled[label];
            if (label == 0) continue;
            piece.position.push_back(position);
            piece.species.push_back(label);
            if (!brick.radius.empty())
                piece.radius.push_back(brick.radius[i] * (options.seed_radius / brick.seed_radius));
            if (components)
                piece.component.push_back(
                    std::binary_search(options.object_labels.begin(), options.object_labels.end(), label)
                        ? labeller.component(position, label)
                        : 0);
        }
    });

    Sample sample;
    Packing& packing = sample.packing;
    packing.box = {volume.origin(), extent, {false, false, false}};
    packing.seed_radius = options.seed_radius;
    std::size_t total = 0;
    for (const Piece& piece : pieces) total += piece.position.size();
    packing.position.reserve(total);
    packing.species.reserve(total);
    if (components) packing.object.reserve(total);
    for (Piece& piece : pieces) {
        packing.position.insert(packing.position.end(), piece.position.begin(), piece.position.end());
        packing.species.insert(packing.species.end(), piece.species.begin(), piece.species.end());
        packing.radius.insert(packing.radius.end(), piece.radius.begin(), piece.radius.end());
        packing.object.insert(packing.object.end(), piece.component.begin(), piece.component.end());
        for (const auto& [label, particles] : piece.labelled) {
            sample.labelled[label] += particles;
            sample.candidates += particles;
        }
        piece = {};
    }
    if (packing.position.empty())
        throw InvalidInput(fmt::format("no particle is left: {}",
                                       sample.candidates == 0
                                           ? "the image is smaller than a particle; use fewer pixels per seed"
                                           : "all of them lie in void (label 0); check the labels or the threshold"));
    packing.id.resize(total);
    for (std::size_t i = 0; i < total; ++i) packing.id[i] = static_cast<std::int64_t>(i + 1);

    if (components) {
        sample.components = static_cast<std::int64_t>(components->voxels.size());
        std::vector<std::int64_t> particles(components->voxels.size() + 1, 0);
        for (const std::int32_t component : packing.object) ++particles[component];
        std::vector<std::int32_t> object(particles.size(), 0);
        for (std::size_t component = 1; component < particles.size(); ++component)
            if (particles[component] > 0) {
                sample.object_particles.push_back(particles[component]);
                object[component] = static_cast<std::int32_t>(sample.object_particles.size());
            }
        for (std::int32_t& number : packing.object) number = object[number];
    }
    return sample;
}

}  // namespace tomodem
