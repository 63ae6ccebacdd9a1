#include "tools/vol2pack/geometric_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "core/base/parallel.hpp"

namespace tomodem::vol2pack {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Vec3 scaled(const VoxelIndex& step, const Vec3& spacing) {
    return Vec3(step[0], step[1], step[2]).cwiseProduct(spacing);
}

/// Directions spread evenly over half a sphere (spiral of the golden angle).
std::vector<Vec3> even_directions(int count) {
    std::vector<Vec3> directions;
    for (int i = 0; i < count; ++i) {
        const double z = (i + 0.5) / count, radius = std::sqrt(1 - z * z);
        const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
        directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return directions;
}

struct LatticeNeedle {
    VoxelIndex step;
    double length;  // mm
    double share;   // of all directions
};

/// Short steps from voxel to voxel that stand for all directions.
std::vector<LatticeNeedle> lattice_needles(const Vec3& spacing) {
    // For each direction the shortest step within this angle of it, or else the nearest step.
    const double good = std::cos(14 * std::numbers::pi / 180);
    constexpr int directions = 250;
    std::map<VoxelIndex, int> chosen;
    for (const Vec3& direction : even_directions(directions)) {
        VoxelIndex best{};
        double best_cosine = 0;
        const double longest = 3 * spacing.maxCoeff();
        for (double length = spacing.minCoeff(); length <= longest && best_cosine < good;
             length += 0.25 * spacing.minCoeff()) {
            VoxelIndex step;
            for (int axis = 0; axis < 3; ++axis)
                step[axis] = static_cast<std::int32_t>(std::lround(length * direction[axis] / spacing[axis]));
            if (step == VoxelIndex{}) continue;
            const Vec3 vector = scaled(step, spacing);
            const double cosine = vector.dot(direction) / vector.norm();
            if (cosine <= best_cosine + 1e-12) continue;
            best = step;
            best_cosine = cosine;
        }
        ++chosen[best];
    }
    std::vector<LatticeNeedle> needles;
    for (const auto& [step, count] : chosen)
        needles.push_back({step, scaled(step, spacing).norm(), static_cast<double>(count) / directions});
    return needles;
}

/// Index of a voxel in a volume that is mirrored at its faces.
std::int32_t mirrored(std::int32_t index, std::int32_t size) {
    const std::int32_t folded = ((index % (2 * size)) + 2 * size) % (2 * size);
    return folded < size ? folded : 2 * size - 1 - folded;
}

/// Where the label changes first on a straight line.
class Ray {
 public:
    Ray(const LabelVolume& volume, const LabelVolume::Sampler& sampler)
        : sampler_(sampler), origin_(volume.origin()), spacing_(volume.spacing()), size_(volume.size()) {}

    bool inside(const Vec3& point) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double at = (point[axis] - origin_[axis]) / spacing_[axis];
            if (!(at >= 0 && at < size_[axis])) return false;
        }
        return true;
    }

    /// The boundary of `label` between a point in it and one that is not.
    Vec3 boundary(std::int32_t label, Vec3 in, Vec3 out) const {
        for (int i = 0; i < 8; ++i) {
            const Vec3 middle = (in + out) / 2;
            (sampler_.nearest(middle) == label ? in : out) = middle;
        }
        return (in + out) / 2;
    }

    /// Inward normal of a label at a point of its boundary; zero where there is none to be seen.
    Vec3 normal(std::int32_t label, const Vec3& point) const {
        // Gaussian of 1.2 voxels, of which the derivative is taken.
        constexpr int reach = 3;
        constexpr double width = 1.2;
        const Vec3 at = (point - origin_).cwiseQuotient(spacing_);
        std::array<std::int32_t, 3> middle;
        for (int axis = 0; axis < 3; ++axis) middle[axis] = static_cast<std::int32_t>(std::floor(at[axis]));
        Vec3 gradient = Vec3::Zero();
        for (int z = -reach; z <= reach; ++z)
            for (int y = -reach; y <= reach; ++y)
                for (int x = -reach; x <= reach; ++x) {
                    // Beyond the volume the labels continue as at its faces.
                    VoxelIndex voxel{middle[0] + x, middle[1] + y, middle[2] + z};
                    Vec3 offset;
                    for (int axis = 0; axis < 3; ++axis) {
                        offset[axis] = voxel[axis] + 0.5 - at[axis];
                        voxel[axis] = std::clamp(voxel[axis], 0, size_[axis] - 1);
                    }
                    if (sampler_.at(voxel) != label) continue;
                    gradient += offset * std::exp(-offset.squaredNorm() / (2 * width * width));
                }
        gradient = gradient.cwiseQuotient(spacing_);
        const double length = gradient.norm();
        return length > 1e-9 * gradient.cwiseProduct(spacing_).cwiseAbs().maxCoeff() && length > 0
                   ? Vec3(gradient / length)
                   : Vec3(Vec3::Zero());
    }

    /// Length within the label along `direction` from a point of its boundary; `cap` where the volume ends before it.
    /// 0: the line does not enter the label.
    double thickness(std::int32_t label, const Vec3& point, const Vec3& direction, double cap) const {
        const double voxel = 1 / direction.cwiseAbs().cwiseQuotient(spacing_).maxCoeff();
        const double step = voxel / 8;
        double entry = 0;
        while (entry < voxel && sampler_.nearest(point + entry * direction) != label) entry += step;
        if (entry >= voxel) return 0;
        for (double at = entry;; at += step) {
            const Vec3 here = point + at * direction;
            if (at - entry >= cap || !inside(here)) return cap;
            if (sampler_.nearest(here) != label) return at - entry;
        }
    }

 private:
    const LabelVolume::Sampler& sampler_;
    Vec3 origin_, spacing_;
    VoxelIndex size_;
};

/// Calls visit(tile, needle, from, to), the last two places, for the needles that start in each tile, tiles on all
/// threads.
template <class Visit>
void for_each_tile(const Tiling& tiling, const std::vector<Tiling::Needle>& needles, int threads, const Visit& visit) {
    parallel_for(tiling.tiles(), threads, [&](std::int64_t tile) {
        const std::int64_t here = tile * tiling.in_brick();
        for (std::size_t i = 0; i < needles.size();) {
            const auto& offset = needles[i].offset;
            const std::int64_t there = tiling.neighbour(tile, offset) * tiling.in_brick();
            for (; i < needles.size() && needles[i].offset == offset; ++i)
                if (there >= 0) visit(tile, i, here + needles[i].from, there + needles[i].to);
        }
    });
}

}  // namespace

double ImageGeometry::Label::thinnest() const {
    return thickness.empty() ? infinite : thickness[thickness.size() / 20];
}

ImageGeometry measure_image(const LabelVolume& volume, double cap, int threads) {
    const VoxelIndex size = volume.size();
    const Vec3 spacing = volume.spacing();
    const auto needles = lattice_needles(spacing);
    ImageGeometry geometry;
    for (const auto& [label, voxels] : volume.histogram()) geometry.label[label];

    // As many of each step as make every crossing stand for the same area.
    double density = 0;
    for (const auto& needle : needles) density += needle.share / needle.length;
    const double voxels = double(size[0]) * size[1] * size[2];
    const double wanted = std::clamp(30 * voxels, 2e4, 2e6);
    constexpr std::int64_t pieces = 64;
    struct Piece {
        std::map<std::int32_t, double> crossings;
        std::map<std::int32_t, std::vector<double>> thickness;
    };
    std::vector<Piece> piece(pieces);
    parallel_for(pieces, threads, [&](std::int64_t number) {
        const LabelVolume::Sampler sampler(volume);
        const Ray ray(volume, sampler);
        Piece& mine = piece[number];
        double before = 0, share = 0;
        for (const auto& needle : needles) {
            share += needle.share;
            const auto first = static_cast<std::int64_t>(wanted * before);
            before += needle.share / needle.length / density;
            const auto end = static_cast<std::int64_t>(wanted * before);
            const double weight =
                wanted * (needle.share / needle.length / density) / double(std::max<std::int64_t>(1, end - first));
            const std::int64_t mine_first = first + (end - first) * number / pieces;
            const std::int64_t mine_end = first + (end - first) * (number + 1) / pieces;
            for (std::int64_t i = mine_first; i < mine_end; ++i) {
                // Places spread evenly: multiples of irrational numbers (Roberts' R3 sequence).
                constexpr std::array<double, 3> irrational{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
                VoxelIndex from, to;
                for (int axis = 0; axis < 3; ++axis) {
                    const double at = double(i + 1) * irrational[axis];
                    from[axis] = static_cast<std::int32_t>((at - std::floor(at)) * size[axis]);
                    to[axis] = mirrored(from[axis] + needle.step[axis], size[axis]);
                }
                const std::int32_t a = sampler.at(from), b = sampler.at(to);
                if (a == b) continue;
                for (const bool start : {true, false}) {
                    const std::int32_t label = start ? a : b;
                    mine.crossings[label] += weight;
                    auto& thickness = mine.thickness[label];
                    if (static_cast<double>(thickness.size()) >= share * 4096 / pieces) continue;  // some of each step
                    const auto centre = [&](const VoxelIndex& voxel) -> Vec3 {
                        return volume.origin() +
                               (Vec3(voxel[0], voxel[1], voxel[2]) + Vec3::Constant(0.5)).cwiseProduct(spacing);
                    };
                    const Vec3 place = ray.boundary(label, centre(start ? from : to), centre(start ? to : from));
                    const Vec3 inwards = ray.normal(label, place);
                    if (inwards == Vec3::Zero()) continue;
                    const double length = ray.thickness(label, place, inwards, cap);
                    if (length > 0) thickness.push_back(length);
                }
            }
        }
    });
    for (Piece& mine : piece) {
        for (const auto& [label, crossings] : mine.crossings)
            geometry.label[label].surface += 2 * volume.extent().prod() * density * crossings / wanted;
        for (const auto& [label, thickness] : mine.thickness) {
            auto& all = geometry.label[label].thickness;
            all.insert(all.end(), thickness.begin(), thickness.end());
        }
    }
    for (auto& [number, label] : geometry.label) std::sort(label.thickness.begin(), label.thickness.end());
    return geometry;
}

std::map<std::int32_t, double> particle_surfaces(const Tiling& tiling, const Places& places,
                                                 const std::vector<Tiling::Needle>& needles, int threads) {
    // Needles with one end beyond a face belong half to the box.
    struct Counts {
        double length = 0;
        std::map<std::int32_t, std::int64_t> half_crossings;
    };
    std::vector<Counts> of_tile(tiling.tiles());
    std::vector<double> lengths;
    for (const auto& needle : needles) lengths.push_back(needle.along.norm());
    for_each_tile(tiling, needles, threads, [&](std::int64_t tile, std::size_t i, std::int64_t from, std::int64_t to) {
        const std::int32_t a = places.label[from], b = places.label[to];
        const int halves = (a >= 0) + (b >= 0);
        if (halves == 0 || a == Places::outside || b == Places::outside) return;
        Counts& mine = of_tile[tile];
        mine.length += halves * lengths[i] / 2;
        const std::int32_t label_a = Places::label_of_image(a), label_b = Places::label_of_image(b);
        if (label_a == label_b) return;
        mine.half_crossings[label_a] += halves;
        mine.half_crossings[label_b] += halves;
    });
    double length = 0;
    std::map<std::int32_t, double> surfaces;
    for (const auto& [label, count] : places.count()) surfaces[label] = 0;
    for (const Counts& counts : of_tile) {
        length += counts.length;
        for (const auto& [label, crossings] : counts.half_crossings) surfaces[label] += double(crossings) / 2;
    }
    for (auto& [label, surface] : surfaces)
        if (length > 0) surface *= 2 * tiling.box().edges.prod() / length;
    return surfaces;
}

std::map<std::int32_t, ComponentLoss> component_losses(const Tiling& tiling, const Places& places,
                                                       const std::vector<Tiling::Needle>& needles,
                                                       const Regions& regions) {
    const auto& label = regions.components.label;
    const auto& voxels = regions.components.voxels;
    std::vector<bool> held(label.size(), false);
    for (const std::int32_t region : places.region)
        if (region > 0) held[region - 1] = true;
    std::vector<std::int32_t> parent(label.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    std::map<std::int32_t, ComponentLoss> losses;
    for (std::size_t i = 0; i < label.size(); ++i) {
        ComponentLoss& loss = losses[label[i]];
        ++loss.components;
        if (held[i]) continue;
        ++loss.lost;
        loss.largest_lost = std::max(loss.largest_lost, voxels[i]);
    }
    for_each_tile(tiling, needles, 1, [&](std::int64_t, std::size_t, std::int64_t from, std::int64_t to) {
        const std::int32_t a = places.region[from], b = places.region[to];
        if (a == b || a == 0 || b == 0 || label[a - 1] != label[b - 1]) return;
        const std::int32_t one = root(a - 1), other = root(b - 1);
        if (one == other) return;
        parent[std::max(one, other)] = std::min(one, other);
        ++losses[label[a - 1]].merged;
    });
    return losses;
}

double GeometricError::volume_error() const {
    double largest = 0;
    for (const Label& label : labels) largest = std::max(largest, std::abs(label.volume_error()));
    return largest;
}

nlohmann::ordered_json GeometricError::json() const {
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    const auto number = [](double value) -> nlohmann::ordered_json {
        return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    for (const Label& label : labels) {
        nlohmann::ordered_json row{{"label", label.label},
                                   {"image_fraction", label.image_fraction},
                                   {"sample_fraction", label.sample_fraction},
                                   {"volume_error", number(label.volume_error())},
                                   {"image_surface_mm2", label.image_surface},
                                   {"sample_surface_mm2", label.sample_surface},
                                   {"surface_error", number(label.surface_error())},
                                   {"thinnest_feature_particles", number(label.thinnest)}};
        if (components_counted) {
            row["components"] = label.components.components;
            row["components_lost"] = label.components.lost;
            row["components_merged"] = label.components.merged;
            row["largest_component_lost_voxels"] = label.components.largest_lost;
        }
        table.push_back(row);
    }
    return table;
}

GeometricError geometric_error(const LabelVolume& volume, const Tiling& tiling, const Places& places,
                               const Regions* regions, int threads) {
    // Twenty particles across are thick.
    const double diameter = 2 * tiling.seed_radius();
    const ImageGeometry image = measure_image(volume, 20 * diameter, threads);
    const auto needles = tiling.needles();
    const auto surfaces = particle_surfaces(tiling, places, needles, threads);
    std::map<std::int32_t, ComponentLoss> losses;
    GeometricError error;
    if (regions) {
        losses = component_losses(tiling, places, needles, *regions);
        error.components_counted = true;
    }
    const auto voxels = volume.histogram();
    const auto particles = places.count();
    const double all_voxels = double(volume.size()[0]) * volume.size()[1] * volume.size()[2];
    double all_particles = 0;
    for (const auto& [label, count] : particles) all_particles += static_cast<double>(count);
    for (const auto& [label, count] : voxels) {
        GeometricError::Label row;
        row.label = label;
        row.image_fraction = static_cast<double>(count) / all_voxels;
        if (const auto found = particles.find(label); found != particles.end())
            row.sample_fraction = static_cast<double>(found->second) / all_particles;
        row.image_surface = image.label.at(label).surface;
        if (const auto found = surfaces.find(label); found != surfaces.end()) row.sample_surface = found->second;
        row.thinnest = image.label.at(label).thinnest() / diameter;
        if (regions) row.components = losses[label];
        error.labels.push_back(row);
    }
    return error;
}

double largest_volume_error(const std::map<std::int32_t, std::int64_t>& voxels,
                            const std::map<std::int32_t, std::int64_t>& particles) {
    double all_voxels = 0, all_particles = 0, largest = 0;
    for (const auto& [label, count] : voxels) all_voxels += static_cast<double>(count);
    for (const auto& [label, count] : particles) all_particles += static_cast<double>(count);
    if (all_particles == 0) return infinite;
    for (const auto& [label, count] : voxels) {
        const auto found = particles.find(label);
        const double held = found == particles.end() ? 0 : static_cast<double>(found->second);
        largest = std::max(largest, std::abs(held / all_particles / (static_cast<double>(count) / all_voxels) - 1));
    }
    return largest;
}

void report_geometric_error(const GeometricError& error, Reporter& reporter) {
    for (const auto& label : error.labels) {
        const std::string key = label.label == 0 ? "void" : fmt::format("label_{}", label.label);
        reporter.report("volume_error_" + key, 100 * label.volume_error(), "%");
        if (label.image_surface > 0) {
            reporter.report("image_surface_" + key, label.image_surface, "mm^2");
            reporter.report("sample_surface_" + key, label.sample_surface, "mm^2");
            reporter.report("surface_error_" + key, 100 * label.surface_error(), "%");
        }
        if (std::isfinite(label.thinnest)) reporter.report("thinnest_feature_" + key, label.thinnest, "particles");
        constexpr double holds_its_shape = 2.5;
        if (label.label != 0 && label.thinnest < holds_its_shape)
            reporter.warn(
                fmt::format("label {} has parts {:.2g} particles thick, which will not keep their shape (2 to 3 are "
                            "needed); use fewer --pixels-per-seed",
                            label.label, label.thinnest));
        if (!error.components_counted) continue;
        reporter.report("components_" + key, label.components.components);
        reporter.report("components_lost_" + key, label.components.lost);
        reporter.report("components_merged_" + key, label.components.merged);
    }
    reporter.report("volume_error", 100 * error.volume_error(), "%");
    reporter.report_json("geometric_error", error.json());
}

}  // namespace tomodem::vol2pack
