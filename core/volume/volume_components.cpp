#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/base/error.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {
namespace {

/// Voxels x0 .. x1 - 1 of one row, of one label; runs are numbered in raster order.
struct Run {
    std::int32_t x0, x1, label;
};

class UnionFind {
 public:
    std::uint32_t add() {
        if (parent_.size() > std::numeric_limits<std::uint32_t>::max() - 1)
            throw InvalidInput("more than 4e9 runs of voxels: the image is noise or too large, crop or filter it");
        parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
        return parent_.back();
    }
    std::uint32_t root(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// The smaller root wins: a root is the first run of its component in raster order.
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        if (a < b)
            parent_[b] = a;
        else
            parent_[a] = b;
    }
    std::size_t size() const { return parent_.size(); }

 private:
    std::vector<std::uint32_t> parent_;
};

/// The runs of one slice and where those of each row start.
struct SliceRuns {
    std::vector<Run> runs;
    std::vector<std::uint32_t> row_start;
    std::uint32_t first_number = 0;

    void collect(const std::int32_t* voxels, const VoxelIndex& size, const std::vector<std::int32_t>& wanted) {
        runs.clear();
        row_start.clear();
        for (std::int32_t y = 0; y < size[1]; ++y, voxels += size[0]) {
            row_start.push_back(static_cast<std::uint32_t>(runs.size()));
            for (std::int32_t x = 0; x < size[0];) {
                const std::int32_t label = voxels[x];
                const std::int32_t x0 = x;
                while (++x < size[0] && voxels[x] == label) {
                }
                if (std::binary_search(wanted.begin(), wanted.end(), label)) runs.push_back({x0, x, label});
            }
        }
        row_start.push_back(static_cast<std::uint32_t>(runs.size()));
    }
};

/// Joins the runs of row ya of a with those of row yb of b that overlap them along x, or with `reach` 1 touch.
void join_rows(const SliceRuns& a, std::int32_t ya, const SliceRuns& b, std::int32_t yb, std::int32_t reach,
               Joining joining, UnionFind& sets) {
    std::uint32_t i = a.row_start[ya], j = b.row_start[yb];
    const std::uint32_t i_end = a.row_start[ya + 1], j_end = b.row_start[yb + 1];
    const auto try_join = [&](std::uint32_t of_a, std::uint32_t of_b) {
        const Run &left = a.runs[of_a], &right = b.runs[of_b];
        if (left.x0 < right.x1 + reach && right.x0 < left.x1 + reach &&
            (joining == Joining::any_label || left.label == right.label))
            sets.join(a.first_number + of_a, b.first_number + of_b);
    };
    while (i < i_end && j < j_end) {
        try_join(i, j);
        if (a.runs[i].x1 < b.runs[j].x1) {
            ++i;
        } else {
            // Both end here: the run that is left behind may touch the other row's next one.
            if (reach > 0 && a.runs[i].x1 == b.runs[j].x1 && i + 1 < i_end) try_join(i + 1, j);
            ++j;
        }
    }
}

/// Calls visit(k, voxels) for each slice.
template <class Visit>
void for_each_slice(const LabelVolume& volume, const Visit& visit) {
    const VoxelIndex size = volume.size();
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::int32_t> labels;
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        volume.slices(k, count, labels);
        for (std::int32_t i = 0; i < count; ++i) visit(k + i, labels.data() + i * page);
    }
}

}  // namespace

Components connected_components(const LabelVolume& volume, const std::vector<std::int32_t>& labels, Joining joining,
                                Connectivity connectivity, Reporter& reporter) {
    // Rows one step away share faces, and edges where x differs too; rows two steps away share edges, and corners.
    const std::int32_t reach_near = connectivity == Connectivity::faces ? 0 : 1;
    const std::int32_t reach_far = connectivity == Connectivity::corners ? 1 : 0;
    std::vector<std::int32_t> wanted = labels;
    std::sort(wanted.begin(), wanted.end());
    const VoxelIndex size = volume.size();
    const auto progress = reporter.progress("components", 2.0 * size[2]);

    UnionFind sets;
    SliceRuns current, previous;
    for_each_slice(volume, [&](std::int32_t k, const std::int32_t* voxels) {
        std::swap(current, previous);
        current.first_number = static_cast<std::uint32_t>(sets.size());
        current.collect(voxels, size, wanted);
        for (std::int32_t y = 0; y < size[1]; ++y) {
            for (std::uint32_t i = current.row_start[y]; i < current.row_start[y + 1]; ++i) {
                const std::uint32_t number = sets.add();
                if (joining == Joining::any_label && i > current.row_start[y] &&
                    current.runs[i - 1].x1 == current.runs[i].x0)
                    sets.join(number - 1, number);
            }
            if (y > 0) join_rows(current, y, current, y - 1, reach_near, joining, sets);
            if (k == 0) continue;
            join_rows(current, y, previous, y, reach_near, joining, sets);
            if (connectivity == Connectivity::faces) continue;
            if (y > 0) join_rows(current, y, previous, y - 1, reach_far, joining, sets);
            if (y + 1 < size[1]) join_rows(current, y, previous, y + 1, reach_far, joining, sets);
        }
        progress->update(k + 1);
    });

    // The second pass meets the same runs in the same order; a root is met before the other runs of its component.
    Components result{LabelVolume(size, volume.spacing(), volume.origin()), {}, {}};
    result.number.use_threads(volume.threads());
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::int32_t> number_of_run(sets.size());
    std::vector<std::int32_t> numbers;
    std::uint32_t run = 0;
    for_each_slice(volume, [&](std::int32_t k, const std::int32_t* voxels) {
        const std::int32_t in_slab = k % LabelVolume::slab;
        if (in_slab == 0) numbers.assign(page * std::min(LabelVolume::slab, size[2] - k), 0);
        current.collect(voxels, size, wanted);
        for (std::int32_t y = 0; y < size[1]; ++y)
            for (std::uint32_t i = current.row_start[y]; i < current.row_start[y + 1]; ++i, ++run) {
                const std::uint32_t root = sets.root(run);
                if (root == run) {
                    if (result.voxels.size() == std::numeric_limits<std::int32_t>::max())
                        throw InvalidInput("more than 2e9 connected components: the image is noise, filter it first");
                    result.voxels.push_back(0);
                    result.label.push_back(current.runs[i].label);
                    number_of_run[run] = static_cast<std::int32_t>(result.voxels.size());
                }
                const std::int32_t number = number_of_run[root];
                result.voxels[number - 1] += current.runs[i].x1 - current.runs[i].x0;
                const auto row = numbers.begin() + in_slab * page + std::int64_t{y} * size[0];
                std::fill(row + current.runs[i].x0, row + current.runs[i].x1, number);
            }
        if (in_slab == LabelVolume::slab - 1 || k == size[2] - 1)
            result.number.set_slices(k - in_slab, in_slab + 1, numbers);
        progress->update(size[2] + k + 1);
    });
    return result;
}

std::int64_t remove_small_components(LabelVolume& volume, const std::vector<std::int32_t>& labels,
                                     std::int64_t min_voxels, Connectivity by, Reporter& reporter) {
    const Components components = connected_components(volume, labels, Joining::same_label, by, reporter);
    const VoxelIndex size = volume.size();
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::map<std::int32_t, std::map<std::int32_t, std::int64_t>> neighbours;  // of each small component
    for (std::size_t i = 0; i < components.voxels.size(); ++i)
        if (components.voxels[i] < min_voxels) neighbours[static_cast<std::int32_t>(i + 1)];
    if (neighbours.empty()) return 0;
    const auto small = [&](std::int32_t number) { return number > 0 && components.voxels[number - 1] < min_voxels; };

    std::vector<std::int32_t> voxels, numbers;
    const auto for_each_slab = [&](std::int32_t halo, const auto& visit) {
        for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
            const std::int32_t from = std::max(0, k - halo);
            const std::int32_t to = std::min(size[2], k + LabelVolume::slab + halo);
            volume.slices(from, to - from, voxels);
            components.number.slices(from, to - from, numbers);
            visit(k, std::min(LabelVolume::slab, size[2] - k), k - from, to - from);
        }
    };
    for_each_slab(1, [&](std::int32_t, std::int32_t count, std::int32_t start, std::int32_t held) {
        for (std::int32_t z = start; z < start + count; ++z)
            for (std::int32_t y = 0; y < size[1]; ++y)
                for (std::int32_t x = 0; x < size[0]; ++x) {
                    const std::int64_t at = z * page + std::int64_t{y} * size[0] + x;
                    if (!small(numbers[at])) continue;
                    auto& counts = neighbours[numbers[at]];
                    const auto look = [&](bool inside, std::int64_t step) {
                        if (inside && numbers[at + step] != numbers[at]) ++counts[voxels[at + step]];
                    };
                    look(x > 0, -1);
                    look(x + 1 < size[0], 1);
                    look(y > 0, -size[0]);
                    look(y + 1 < size[1], size[0]);
                    look(z > 0, -page);
                    look(z + 1 < held, page);
                }
    });
    std::map<std::int32_t, std::int32_t> replacement;
    for (const auto& [number, counts] : neighbours) {
        if (counts.empty()) continue;
        const auto most_frequent = std::max_element(counts.begin(), counts.end(),
                                                    [](const auto& a, const auto& b) { return a.second < b.second; });
        replacement[number] = most_frequent->first;
    }
    for_each_slab(0, [&](std::int32_t k, std::int32_t count, std::int32_t, std::int32_t) {
        bool changed = false;
        for (std::size_t i = 0; i < voxels.size(); ++i)
            if (small(numbers[i]) && replacement.contains(numbers[i])) {
                voxels[i] = replacement[numbers[i]];
                changed = true;
            }
        if (changed) volume.set_slices(k, count, voxels);
    });
    return static_cast<std::int64_t>(replacement.size());
}

}  // namespace tomodem
