#include "tools/metrics/shapes/image_shapes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::shapes {
namespace {

/// Where a number is in a sorted list.
class Places {
 public:
    explicit Places(std::span<const std::int32_t> numbers) : numbers_(numbers) {
        if (numbers.empty() || numbers.front() < 0) return;
        const auto last = static_cast<std::size_t>(numbers.back());
        if (last > std::max<std::size_t>(65535, 16 * numbers.size())) return;  // few and far between
        place_.assign(last + 1, -1);
        for (std::size_t i = 0; i < numbers.size(); ++i) place_[numbers[i]] = static_cast<std::int32_t>(i);
    }
    /// -1: not in the list
    std::int32_t of(std::int32_t number) const {
        if (!place_.empty())
            return number >= 0 && static_cast<std::size_t>(number) < place_.size() ? place_[number] : -1;
        const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
        const bool there = found != numbers_.end() && *found == number;
        return there ? static_cast<std::int32_t>(found - numbers_.begin()) : -1;
    }

 private:
    std::span<const std::int32_t> numbers_;
    std::vector<std::int32_t> place_;  // of each number, where that does not take much
};

/// Voxels x0 .. x1 - 1 of a row that have one number; the runs of a row cover it.
struct Run {
    std::int32_t x0, x1, number, place;
};

void collect_runs(const std::int32_t* row, std::int32_t width, const Places& places, std::vector<Run>& runs) {
    runs.clear();
    for (std::int32_t x = 0; x < width;) {
        const std::int32_t x0 = x, number = row[x];
        while (++x < width && row[x] == number) {
        }
        runs.push_back({x0, x, number, places.of(number)});
    }
}

void add_runs(const std::vector<Run>& runs, std::int64_t y, std::int64_t z, std::vector<VoxelSums>& sums) {
    const auto squares_to = [](std::int64_t m) { return m * (m + 1) * (2 * m + 1) / 6; };
    for (const Run& run : runs) {
        if (run.place < 0) continue;
        const std::int64_t n = run.x1 - run.x0, first = run.x0, last = run.x1 - 1;
        const std::int64_t s = n * (first + last) / 2;
        const std::int64_t s2 = squares_to(last) - (first > 0 ? squares_to(first - 1) : 0);
        VoxelSums of_run;
        of_run.voxels = n;
        of_run.sum = {s, n * y, n * z};
        of_run.squares = {s2, n * y * y, n * z * z, s * y, s * z, n * y * z};
        of_run.low = {run.x0, static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
        of_run.high = {run.x1 - 1, of_run.low[1], of_run.low[2]};
        sums[run.place] += of_run;
    }
}

/// Counts where row a at x differs from row b at x + dx.
void add_borders(const std::vector<Run>& a, const std::vector<Run>& b, std::int32_t dx, std::size_t step,
                 std::vector<VoxelSums>& sums) {
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        const Run &of_a = a[i], &of_b = b[j];
        const std::int32_t both = std::min(of_a.x1, of_b.x1 - dx) - std::max(of_a.x0, of_b.x0 - dx);
        if (both > 0 && of_a.number != of_b.number) {
            if (of_a.place >= 0) sums[of_a.place].borders[step] += both;
            if (of_b.place >= 0) sums[of_b.place].borders[step] += both;
        }
        if (of_a.x1 < of_b.x1 - dx)
            ++i;
        else
            ++j;
    }
}

ImageBody body_of(const VoxelSums& sums, std::int32_t number, std::int32_t label, const LabelVolume& volume,
                  const std::array<double, 13>& weights, int axis) {
    const Vec3 spacing = volume.spacing();
    ImageBody body{number, label, sums.voxels, false, shape_of(sums, spacing, volume.origin(), axis), 0.0, 0.0};
    for (int c = 0; c < 3; ++c) body.at_boundary |= sums.low[c] == 0 || sums.high[c] == volume.size()[c] - 1;
    body.area = crofton_area(sums, spacing, weights);
    body.sphericity = sphericity(body.shape.volume, body.area);
    return body;
}

/// All voxels in one plane, which may lie askew.
bool flat(const ImageBody& body) {
    return body.shape.ellipsoid.semi_axis[2] <= 1e-6 * body.shape.ellipsoid.semi_axis[0];
}

}  // namespace

VoxelSums& VoxelSums::operator+=(const VoxelSums& other) {
    if (other.voxels > 0)
        for (int c = 0; c < 3; ++c) {
            low[c] = voxels == 0 ? other.low[c] : std::min(low[c], other.low[c]);
            high[c] = voxels == 0 ? other.high[c] : std::max(high[c], other.high[c]);
        }
    voxels += other.voxels;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other.sum[i];
    for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += other.squares[i];
    for (std::size_t i = 0; i < borders.size(); ++i) borders[i] += other.borders[i];
    return *this;
}

std::vector<VoxelSums> voxel_sums(const LabelVolume& volume, std::span<const std::int32_t> numbers) {
    const VoxelIndex size = volume.size();
    const double longest = std::max({size[0], size[1], size[2]});
    if (longest * longest * size[0] * size[1] * size[2] > 9e18)
        throw InvalidInput(fmt::format("an image of {} x {} x {} voxels is too large to be summed: crop or bin it",
                                       size[0], size[1], size[2]));
    // Each thread has a share of the rows and sums of its own, as long as those take less than a GiB.
    const auto all = static_cast<std::int64_t>(std::max<std::size_t>(1, numbers.size()) * sizeof(VoxelSums));
    const std::int64_t shares = std::clamp<std::int64_t>((std::int64_t{1} << 30) / all, 1, volume.threads());
    const Places places(numbers);
    std::vector<std::vector<VoxelSums>> sums(shares, std::vector<VoxelSums>(numbers.size()));
    const std::int64_t width = size[0], page = width * size[1];
    const std::int32_t height = size[1];
    std::vector<std::int32_t> labels;
    // Of the slice before a slab, and of its own slices after that.
    std::vector<std::vector<Run>> rows(std::size_t(height) * (LabelVolume::slab + 1));
    const auto row = [&](std::int32_t slice, std::int32_t y) -> std::vector<Run>& {
        return rows[std::size_t(slice) * height + y];
    };
    const auto share_rows = [&](const auto& work) {
        parallel_for(shares, static_cast<int>(shares), [&](std::int64_t of) {
            const auto from = static_cast<std::int32_t>(height * of / shares);
            const auto to = static_cast<std::int32_t>(height * (of + 1) / shares);
            for (std::int32_t y = from; y < to; ++y) work(y, sums[of]);
        });
    };
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        volume.slices(k, count, labels);
        share_rows([&](std::int32_t y, std::vector<VoxelSums>& own) {
            for (std::int32_t i = 0; i < count; ++i) {
                collect_runs(labels.data() + i * page + y * width, size[0], places, row(i + 1, y));
                add_runs(row(i + 1, y), y, k + i, own);
            }
        });
        share_rows([&](std::int32_t y, std::vector<VoxelSums>& own) {
            for (std::int32_t i = 0; i < count; ++i)
                for (std::size_t step = 0; step < pair_steps.size(); ++step) {
                    const auto& [dx, dy, dz] = pair_steps[step];
                    if (y + dy < 0 || y + dy >= height || k + i < dz) continue;
                    add_borders(row(i + 1 - dz, y), row(i + 1, y + dy), dx, step, own);
                }
        });
        for (std::int32_t y = 0; y < height; ++y) std::swap(row(0, y), row(count, y));
    }
    for (std::size_t of = 1; of < sums.size(); ++of)
        for (std::size_t i = 0; i < numbers.size(); ++i) sums[0][i] += sums[of][i];
    return std::move(sums[0]);
}

std::array<double, 13> crofton_weights(const Vec3& spacing) {
    std::array<Vec3, 13> direction;
    for (std::size_t k = 0; k < direction.size(); ++k)
        direction[k] = spacing.cwiseProduct(Vec3(pair_steps[k][0], pair_steps[k][1], pair_steps[k][2])).normalized();
    std::array<double, 13> weights{};
    constexpr int points = 200'000;  // on a spiral, evenly spread
    for (int i = 0; i < points; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / points, turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        const Vec3 place(r * std::cos(turn), r * std::sin(turn), z);
        std::size_t nearest = 0;
        double best = -1.0;
        for (std::size_t k = 0; k < direction.size(); ++k)
            if (const double dot = std::abs(direction[k].dot(place)); dot > best) {
                best = dot;
                nearest = k;
            }
        weights[nearest] += 1.0 / points;
    }
    return weights;
}

double crofton_area(const VoxelSums& sums, const Vec3& spacing, const std::array<double, 13>& weights) {
    double area = 0.0;
    for (std::size_t k = 0; k < pair_steps.size(); ++k) {
        const double step = spacing.cwiseProduct(Vec3(pair_steps[k][0], pair_steps[k][1], pair_steps[k][2])).norm();
        area += 2.0 * weights[k] * double(sums.borders[k]) * spacing.prod() / step;
    }
    return area;
}

double sphericity(double volume, double area) {
    return std::cbrt(std::numbers::pi * 36.0 * volume * volume) / area;
}

Shape shape_of(const VoxelSums& sums, const Vec3& spacing, const Vec3& origin, int axis) {
    const double n = double(sums.voxels);
    Vec3 mean;
    for (int c = 0; c < 3; ++c) mean[c] = double(sums.sum[c]) / n;
    Mat3 moments;
    constexpr int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            moments(a, b) = (double(sums.squares[place[a][b]]) / n - mean[a] * mean[b]) * spacing[a] * spacing[b];
        }
    return shape_of(origin + spacing.cwiseProduct(mean + Vec3::Constant(0.5)), n * spacing.prod(), moments, axis);
}

ImageObjects image_objects(LabelVolume& volume, const ObjectLabels& wanted, const BodyChoice& choice) {
    const auto histogram = volume.histogram();
    if (histogram.size() == 1 && histogram.begin()->first == 0)
        throw InvalidInput("the image has no objects: all of it is void (label 0)");
    std::vector<std::int32_t> labels = wanted.components;
    if (wanted.all_components) {
        labels.clear();
        for (const auto& [label, voxels] : histogram)
            if (label != 0) labels.push_back(label);
    }
    for (const std::int32_t label : labels)
        if (!histogram.contains(label)) {
            std::vector<std::int32_t> there;
            for (const auto& [known, voxels] : histogram)
                if (there.size() < 16) there.push_back(known);
            throw InvalidInput(fmt::format("--objects {}: the image has no such label; it has {}{}", label,
                                           fmt::join(there, ", "), histogram.size() > 16 ? " ..." : ""));
        }
    std::optional<Regions> regions =
        distinguish_regions(volume, labels, wanted.labels, wanted.connectivity, Regions::Of::objects);
    if (!regions) throw InvalidInput("no label of the image was given as that of objects");

    // As vol2pack: labels that are objects keep their number, components are counted from the largest of those.
    Components& components = regions->components;
    std::vector<std::int32_t> region, number;
    ImageObjects result{LabelVolume({1, 1, 1}, volume.spacing()), {}, {}, 0, 0};
    std::int32_t next = *std::max_element(regions->image_label.begin(), regions->image_label.end());
    for (std::size_t r = 0; r < components.voxels.size(); ++r) {
        const std::int32_t label = regions->image_label[r];
        const std::int32_t own = label > 0 ? label : ++next;
        if (components.voxels[r] < choice.min_voxels) {
            ++result.too_small;
            continue;
        }
        region.push_back(static_cast<std::int32_t>(r + 1));
        number.push_back(own);
    }
    const std::vector<VoxelSums> sums = voxel_sums(components.number, region);
    const auto weights = crofton_weights(volume.spacing());
    result.number_of_region.assign(components.voxels.size() + 1, 0);
    for (std::size_t k = 0; k < region.size(); ++k) {
        const std::int32_t r = region[k];
        ImageBody body = body_of(sums[k], number[k], components.label[r - 1], volume, weights, choice.axis);
        if (flat(body)) {
            ++result.too_small;
            continue;
        }
        if (choice.exclude_boundary && body.at_boundary) {
            ++result.at_boundary;
            continue;
        }
        result.number_of_region[r] = body.number;
        result.used.push_back(std::move(body));
    }
    std::sort(result.used.begin(), result.used.end(),
              [](const ImageBody& a, const ImageBody& b) { return a.number < b.number; });
    result.region = std::move(components.number);
    if (result.used.empty())
        throw InvalidInput(
            fmt::format("none of the {} objects can be measured: {} have fewer than --min-voxels {} or lie in one "
                        "plane, {} touch a face of the image",
                        components.voxels.size(), result.too_small, choice.min_voxels, result.at_boundary));
    return result;
}

VoidParts void_parts(const LabelVolume& volume, Connectivity connectivity, const BodyChoice& choice) {
    const VoxelIndex size = volume.size();
    VoidParts result{LabelVolume({1, 1, 1}, volume.spacing()), {}, {}};
    result.voxels = std::int64_t{size[0]} * size[1] * size[2];
    Components parts = connected_components(volume, {0}, Joining::same_label, connectivity);
    std::vector<std::int32_t> numbers;
    for (std::size_t i = 0; i < parts.voxels.size(); ++i) numbers.push_back(static_cast<std::int32_t>(i + 1));
    const std::vector<VoxelSums> sums = voxel_sums(parts.number, numbers);
    if (sums.size() == 1 && sums[0].voxels == result.voxels)
        throw InvalidInput("the image has no pores: all of it is void (label 0)");
    const auto weights = crofton_weights(volume.spacing());
    result.number_of_region.assign(sums.size() + 1, 0);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        ImageBody body = body_of(sums[i], 0, 0, volume, weights, choice.axis);
        if (body.at_boundary) {
            ++result.open;
            result.open_voxels += body.voxels;
            continue;
        }
        result.closed_voxels += body.voxels;
        if (body.voxels < choice.min_voxels || flat(body)) {
            ++result.too_small;
            continue;
        }
        body.number = static_cast<std::int32_t>(result.closed.size() + 1);
        result.number_of_region[i + 1] = body.number;
        result.closed.push_back(std::move(body));
    }
    result.region = std::move(parts.number);
    return result;
}

}  // namespace tomodem::shapes
