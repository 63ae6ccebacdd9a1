#include "tools/relax/pores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::relax {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Lower envelope of parabolas: out(q) = min over p of (step (q - p))^2 + in(p).
/// Source: Felzenszwalb & Huttenlocher, Distance transforms of sampled functions, Theory of Computing 8 (2012) 415.
void transform_line(const std::vector<double>& in, double step, std::vector<double>& out, std::vector<int>& place,
                    std::vector<double>& from) {
    const int count = static_cast<int>(in.size());
    const double square = step * step;
    int last = -1;
    for (int q = 0; q < count; ++q) {
        if (std::isinf(in[q])) continue;
        double begin = -std::numeric_limits<double>::infinity();
        for (; last >= 0; --last) {
            const int p = place[last];
            begin = ((in[q] - in[p]) / square + double(q) * q - double(p) * p) / (2.0 * (q - p));
            if (begin > from[last]) break;
            begin = -std::numeric_limits<double>::infinity();
        }
        place[++last] = q;
        from[last] = begin;
    }
    if (last < 0) {
        std::fill(out.begin(), out.end(), std::numeric_limits<double>::infinity());
        return;
    }
    for (int q = 0, k = 0; q < count; ++q) {
        while (k < last && from[k + 1] < q) ++k;
        const double apart = q - place[k];
        out[q] = square * apart * apart + in[place[k]];
    }
}

DistanceField field_around(const LabelVolume& number, const VoidPart& part, double reach) {
    const VoxelIndex image = number.size();
    const Vec3 spacing = number.spacing();
    VoxelIndex first, size;
    for (int c = 0; c < 3; ++c) {
        const auto margin = static_cast<std::int32_t>(std::ceil(reach / spacing[c])) + 2;
        first[c] = part.low[c] - margin;
        size[c] = part.high[c] + margin + 1 - first[c];
    }
    const std::size_t count = std::size_t(size[0]) * size[1] * size[2];
    VoxelIndex from, to;
    for (int c = 0; c < 3; ++c) {
        from[c] = std::max(0, -first[c]);
        to[c] = std::min(size[c], image[c] - first[c]);
    }
    std::vector<bool> inside(count);
    const LabelVolume::Sampler sampler(number);
    std::size_t at = 0;
    for (std::int32_t z = first[2]; z < first[2] + size[2]; ++z)
        for (std::int32_t y = first[1]; y < first[1] + size[1]; ++y)
            for (std::int32_t x = first[0]; x < first[0] + size[0]; ++x, ++at)
                inside[at] = sampler.at({x, y, z}) == part.number;
    const Vec3 corner = number.origin() + spacing.cwiseProduct(Vec3(first[0], first[1], first[2]));
    return DistanceField(inside, size, from, to, spacing, corner);
}

}  // namespace

std::vector<float> squared_distances(const std::vector<bool>& set, VoxelIndex size, const Vec3& spacing) {
    std::vector<float> result(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) result[i] = set[i] ? 0.0f : infinite;
    const std::array<std::size_t, 3> stride{1, std::size_t(size[0]), std::size_t(size[0]) * size[1]};
    for (int axis = 0; axis < 3; ++axis) {
        const auto count = static_cast<std::size_t>(size[axis]);
        std::vector<double> in(count), out(count), from(count);
        std::vector<int> place(count);
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        for (std::int32_t i = 0; i < size[a]; ++i)
            for (std::int32_t j = 0; j < size[b]; ++j) {
                float* const line = result.data() + i * stride[a] + j * stride[b];
                for (std::size_t q = 0; q < count; ++q) in[q] = line[q * stride[axis]];
                transform_line(in, spacing[axis], out, place, from);
                for (std::size_t q = 0; q < count; ++q) line[q * stride[axis]] = static_cast<float>(out[q]);
            }
    }
    return result;
}

DistanceField::DistanceField(const std::vector<bool>& inside, VoxelIndex size, const VoxelIndex& from,
                             const VoxelIndex& to, const Vec3& spacing, const Vec3& corner)
    : size_(size), spacing_(spacing), low_(corner + spacing / 2) {
    high_ = low_ + spacing.cwiseProduct(Vec3(size[0] - 1, size[1] - 1, size[2] - 1));
    for (int c = 0; c < 3; ++c) {
        first_[c] = from[c];
        last_[c] = to[c] - 1;
    }
    std::vector<bool> outside(inside.size());
    for (std::int32_t z = from[2]; z < to[2]; ++z)
        for (std::int32_t y = from[1]; y < to[1]; ++y)
            for (std::int32_t x = from[0]; x < to[0]; ++x) {
                const std::size_t at = (std::size_t(z) * size[1] + y) * size[0] + x;
                outside[at] = !inside[at];
            }
    distance_ = squared_distances(inside, size, spacing);
    const std::vector<float> to_outside = squared_distances(outside, size, spacing);
    // The surface lies half a voxel from the centres on both of its sides.
    const auto half = static_cast<float>(0.5 * std::cbrt(spacing.prod()));
    for (std::size_t i = 0; i < distance_.size(); ++i)
        distance_[i] = distance_[i] > 0 ? std::sqrt(distance_[i]) - half : half - std::sqrt(to_outside[i]);
}

double DistanceField::at(const Vec3& point) const {
    std::int32_t cell[3];
    double part[3];
    for (int c = 0; c < 3; ++c) {
        const double place = (point[c] - low_[c]) / spacing_[c];
        if (!(place >= 0 && place <= size_[c] - 1)) return std::numeric_limits<double>::infinity();
        const double clamped = std::clamp(place, first_[c], last_[c]);
        cell[c] = std::min(static_cast<std::int32_t>(clamped), size_[c] - 2);
        part[c] = clamped - cell[c];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        const double weight = (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2]);
        if (weight > 0)
            sum += weight * distance_[(std::size_t(cell[2] + z) * size_[1] + (cell[1] + y)) * size_[0] + cell[0] + x];
    }
    return sum;
}

double DistanceField::volume_up_to(const std::array<int, 3>& face, const Vec3& plane) const {
    std::array<std::vector<double>, 3> share;  // of each layer of voxels along each axis
    for (int c = 0; c < 3; ++c) {
        share[c].assign(size_[c], 1);
        if (face[c] == 0) continue;
        const auto outermost = static_cast<std::int32_t>(std::lround(face[c] < 0 ? first_[c] : last_[c]));
        for (std::int32_t i = 0; i < size_[c]; ++i) {
            const double inner_side = low_[c] + (i - 0.5 * face[c]) * spacing_[c];
            const double layers = face[c] * (plane[c] - inner_side) / spacing_[c];
            share[c][i] = std::max(0.0, i == outermost ? layers : std::min(layers, 1.0));
        }
    }
    double voxels = 0;
    std::size_t at = 0;
    for (std::int32_t z = 0; z < size_[2]; ++z)
        for (std::int32_t y = 0; y < size_[1]; ++y)
            for (std::int32_t x = 0; x < size_[0]; ++x, ++at)
                if (distance_[at] < 0) voxels += share[0][x] * share[1][y] * share[2][z];
    return voxels * spacing_.prod();
}

ImagePores find_pores(const LabelVolume& volume, double seed_radius, double min_across, double reach, int threads) {
    const Components components = connected_components(volume, {0});
    if (components.voxels.empty())
        throw InvalidInput("the volume has no pore: no voxel has label 0 (void); --relabel 2=0 makes label 2 void");
    ImagePores found;
    std::vector<VoidPart> kept;
    double largest = 0;
    for (const VoidPart& part : void_parts(components)) {
        largest = std::max(largest, part.diameter() / (2 * seed_radius));
        if (kind_of(part, seed_radius, min_across) != PoreKind::too_small) {
            kept.push_back(part);
        } else {
            ++found.too_small;
            found.too_small_volume += part.volume;
        }
    }
    if (kept.empty())
        throw InvalidInput(fmt::format(
            "the pores of the volume are too small for these particles: the largest of {} is {:.2g} particles "
            "across, {:g} are needed; make the sample of finer particles (--pixels-per-seed), and look at "
            "--voxel-size",
            components.voxels.size(), largest, min_across));
    std::vector<std::unique_ptr<ImagePore>> pores(kept.size());
    parallel_for(static_cast<std::int64_t>(kept.size()), threads, [&](std::int64_t k) {
        const VoidPart& part = kept[k];
        pores[k] = std::make_unique<ImagePore>(ImagePore{part,
                                                         kind_of(part, seed_radius, min_across),
                                                         part.diameter() / (2 * seed_radius),
                                                         {0, 0, 0},
                                                         field_around(components.number, part, reach)});
        if (pores[k]->kind != PoreKind::cut) return;
        const double thin = min_wall * 2 * seed_radius;
        for (int c = 0; c < 3; ++c) pores[k]->face[c] = part.wall_low[c] < thin ? -1 : part.wall_high[c] < thin ? 1 : 0;
    });
    for (auto& pore : pores) found.pores.push_back(std::move(*pore));
    return found;
}

}  // namespace tomodem::relax
