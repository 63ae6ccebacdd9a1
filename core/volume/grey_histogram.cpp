#include "core/volume/grey_histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem {
namespace {

constexpr std::int32_t slices_of_a_slab = 8;

/// Calls visit(slice, values of type T, count) for each slice, on several threads.
template <class Visit>
void for_each_slice(GreySlabs& slabs, int threads, Reporter& reporter, const char* label, const Visit& visit) {
    const VoxelIndex size = slabs.size();
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::byte> voxels;
    const auto progress = reporter.progress(label, size[2]);
    for (std::int32_t k = 0; k < size[2]; k += slices_of_a_slab) {
        const std::int32_t count = std::min(slices_of_a_slab, size[2] - k);
        slabs.read(k, count, voxels);
        with_type(slabs.type(), [&](auto value) {
            const auto* values = reinterpret_cast<const decltype(value)*>(voxels.data());
            parallel_for(count, threads, [&](std::int64_t i) { visit(k + i, values + i * page, page); });
        });
        progress->update(k + count);
    }
}

/// Sums of counts and of counts times bin number up to each bin.
struct Sums {
    std::vector<double> weight{0.0}, moment{0.0};

    explicit Sums(const std::vector<std::int64_t>& counts) {
        for (std::size_t i = 0; i < counts.size(); ++i) {
            weight.push_back(weight.back() + static_cast<double>(counts[i]));
            moment.push_back(moment.back() + static_cast<double>(counts[i]) * static_cast<double>(i));
        }
    }
    /// Weight times squared mean of the bins from .. to - 1: what the variance between classes is a sum of.
    double between(std::size_t from, std::size_t to) const {
        const double w = weight[to] - weight[from], m = moment[to] - moment[from];
        return w > 0 ? m * m / w : 0.0;
    }
};

}  // namespace

GreySlabs::GreySlabs(VolumeSource& source, const std::array<VoxelIndex, 2>& region, const VoxelIndex& bin, int threads)
    : source_(source), region_(region), bin_(bin), binned_(bin != VoxelIndex{1, 1, 1}), threads_(threads) {
    for (int axis = 0; axis < 3; ++axis) size_[axis] = region[1][axis] / bin[axis];
}

void GreySlabs::read(std::int32_t k, std::int32_t count, std::vector<std::byte>& voxels) {
    const Window window{region_[0][0], region_[0][1], std::int64_t{size_[0]} * bin_[0],
                        std::int64_t{size_[1]} * bin_[1]};
    const std::size_t page = static_cast<std::size_t>(size_[0]) * size_[1];
    voxels.resize(page * count * bytes_of(type()));
    if (!binned_) {
        source_.read(region_[0][2] + k, count, window, voxels.data());
        return;
    }
    const std::size_t stored_page = static_cast<std::size_t>(window.width * window.height);
    block_.resize(stored_page * bytes_of(source_.header().type));
    auto* const means = reinterpret_cast<double*>(voxels.data());
    std::fill(means, means + page * count, 0.0);
    const double voxels_of_a_block = double(bin_[0]) * bin_[1] * bin_[2];
    for (std::int32_t i = 0; i < count * bin_[2]; ++i) {
        source_.read(region_[0][2] + k * bin_[2] + i, 1, window, block_.data());
        double* const sums = means + i / bin_[2] * page;
        with_type(source_.header().type, [&](auto value) {
            const auto* values = reinterpret_cast<const decltype(value)*>(block_.data());
            parallel_for(size_[1], threads_, [&](std::int64_t row) {
                for (std::int32_t y = 0; y < bin_[1]; ++y) {
                    const auto* line = values + (row * bin_[1] + y) * window.width;
                    for (std::int64_t x = 0; x < window.width; ++x)
                        sums[row * size_[0] + x / bin_[0]] += static_cast<double>(line[x]);
                }
            });
        });
        if (i % bin_[2] == bin_[2] - 1)
            for (std::size_t at = 0; at < page; ++at) sums[at] /= voxels_of_a_block;
    }
}

std::int64_t GreyHistogram::voxels() const {
    return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

GreyHistogram count_grey_values(GreySlabs& slabs, int threads, Reporter& reporter) {
    const VoxelIndex size = slabs.size();
    GreyHistogram histogram;
    const bool few = bytes_of(slabs.type()) <= 2;
    if (few) {
        with_type(slabs.type(), [&](auto value) {
            using Value = decltype(value);
            if constexpr (sizeof(Value) <= 2) {
                histogram.low = std::numeric_limits<Value>::min();
                histogram.counts.resize(std::size_t{1} << 8 * sizeof(Value));
            }
        });
    } else {
        struct Extent {
            double low = std::numeric_limits<double>::infinity(), high = -low;
            bool whole = true;
        };
        std::vector<Extent> extents(size[2]);
        for_each_slice(slabs, threads, reporter, "grey range",
                       [&](std::int64_t k, const auto* values, std::int64_t count) {
                           Extent& extent = extents[k];
                           for (std::int64_t i = 0; i < count; ++i) {
                               const auto value = static_cast<double>(values[i]);
                               if (!std::isfinite(value)) continue;
                               extent.low = std::min(extent.low, value);
                               extent.high = std::max(extent.high, value);
                               extent.whole = extent.whole && value == std::floor(value);
                           }
                       });
        Extent all;
        for (const Extent& extent : extents)
            all = {std::min(all.low, extent.low), std::max(all.high, extent.high), all.whole && extent.whole};
        if (!(all.low <= all.high)) throw InvalidInput("the volume has no grey value that is a number");
        constexpr std::size_t bins = 4096;
        constexpr double most_whole = 65536;
        histogram.low = all.low;
        histogram.whole = all.whole && all.high - all.low < most_whole;
        if (histogram.whole) {
            histogram.counts.resize(static_cast<std::size_t>(all.high - all.low) + 1);
        } else {
            histogram.width = all.high > all.low ? (all.high - all.low) / bins : 1.0;
            histogram.counts.resize(bins);
        }
    }
    struct Counted {
        std::vector<std::int64_t> counts;
        std::int64_t not_a_number = 0;
    };
    // One set of counts for each slice of a slab: sums of whole numbers, the same in any order.
    std::vector<Counted> counted(slices_of_a_slab, {std::vector<std::int64_t>(histogram.counts.size()), 0});
    for_each_slice(slabs, threads, reporter, "histogram", [&](std::int64_t k, const auto* values, std::int64_t count) {
        Counted& slice = counted[k % slices_of_a_slab];
        const auto last = static_cast<double>(slice.counts.size() - 1);
        for (std::int64_t i = 0; i < count; ++i) {
            if (few) {
                ++slice.counts[static_cast<std::size_t>(static_cast<double>(values[i]) - histogram.low)];
                continue;
            }
            const auto value = static_cast<double>(values[i]);
            if (!std::isfinite(value))
                ++slice.not_a_number;
            else
                ++slice.counts[static_cast<std::size_t>(std::min(last, (value - histogram.low) / histogram.width))];
        }
    });
    for (const Counted& slice : counted) {
        histogram.not_a_number += slice.not_a_number;
        for (std::size_t i = 0; i < slice.counts.size(); ++i) histogram.counts[i] += slice.counts[i];
    }
    return histogram;
}

std::vector<double> otsu_thresholds(const GreyHistogram& histogram, int levels) {
    // Empty bins at both ends cut nothing; 2 levels try every pair of what is left, in at most 4096 steps.
    const auto& all = histogram.counts;
    std::size_t first = 0, end = all.size();
    while (first < end && all[first] == 0) ++first;
    while (end > first && all[end - 1] == 0) --end;
    constexpr std::size_t max_bins = 4096;
    const std::size_t step = (end - first + max_bins - 1) / max_bins;
    std::vector<std::int64_t> counts;
    for (std::size_t i = first; i < end; i += step)
        counts.push_back(std::accumulate(all.begin() + static_cast<std::ptrdiff_t>(i),
                                         all.begin() + static_cast<std::ptrdiff_t>(std::min(i + step, end)),
                                         std::int64_t{0}));
    const auto occupied = std::count_if(counts.begin(), counts.end(), [](std::int64_t count) { return count > 0; });
    if (occupied <= levels)
        throw InvalidInput(fmt::format("Otsu's method needs more than {} grey value{}, the image has {}", levels,
                                       levels == 1 ? "" : "s", occupied));
    const Sums sums(counts);
    const std::size_t bins = counts.size();
    double best = -1;
    std::vector<std::size_t> cuts;
    // A cut at c: bins below c belong to the lower class.
    for (std::size_t c = 1; c < bins; ++c) {
        if (levels == 1) {
            if (const double now = sums.between(0, c) + sums.between(c, bins); now > best) best = now, cuts = {c};
            continue;
        }
        const double lowest = sums.between(0, c);
        for (std::size_t d = c + 1; d < bins; ++d)
            if (const double now = lowest + sums.between(c, d) + sums.between(d, bins); now > best)
                best = now, cuts = {c, d};
    }
    std::vector<double> thresholds;
    for (const std::size_t cut : cuts) thresholds.push_back(histogram.upper(std::min(first + cut * step, end) - 1));
    return thresholds;
}

}  // namespace tomodem
