// OpenVDB costs over 30 s a translation unit: its headers are here and in formats/vdb.cpp, and in no header.
#include "core/volume/volume.hpp"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tree/ValueAccessor.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem {
namespace {

using Tree = openvdb::Int32Tree;
using Leaf = Tree::LeafNodeType;
/// Of the same shape, for blocks whose labels fit into a byte.
using NarrowTree = openvdb::tree::Tree4<std::uint8_t, 5, 4, 3>::Type;
using NarrowLeaf = NarrowTree::LeafNodeType;
constexpr std::int32_t edge = Leaf::DIM;
constexpr std::int32_t voxels_of_a_block = edge * edge * edge;
static_assert(edge == LabelVolume::slab);

/// In a leaf z runs fastest, then y, then x.
constexpr std::int32_t leaf_offset(std::int32_t x, std::int32_t y, std::int32_t z) {
    return (x * edge + y) * edge + z;
}

/// The labels of a block: of one byte, of four, or one for all.
struct Block {
    const std::uint8_t* narrow = nullptr;
    const std::int32_t* wide = nullptr;
    std::int32_t constant = 0;

    bool is_constant() const { return !narrow && !wide; }
    std::int32_t operator[](std::int32_t at) const { return narrow ? narrow[at] : wide ? wide[at] : constant; }
};

/// A block is in `narrow`, or else a block or a constant in `wide`.
struct Trees {
    Tree wide{0};
    NarrowTree narrow{0};
};

/// Repeated look-ups; one a thread.
class Lookup {
 public:
    explicit Lookup(const Trees& trees) : narrow_(trees.narrow), wide_(trees.wide) {}

    Block block(const openvdb::Coord& in_it) const {
        if (const NarrowLeaf* leaf = narrow_.probeConstLeaf(in_it)) return {.narrow = leaf->buffer().data()};
        if (const Leaf* leaf = wide_.probeConstLeaf(in_it)) return {.wide = leaf->buffer().data()};
        return {.constant = wide_.getValue(in_it)};
    }
    std::int32_t label(const openvdb::Coord& voxel) const {
        return block(voxel)[leaf_offset(voxel.x() % edge, voxel.y() % edge, voxel.z() % edge)];
    }

 private:
    openvdb::tree::ValueAccessor<const NarrowTree> narrow_;
    openvdb::tree::ValueAccessor<const Tree> wide_;
};

/// The part of a block of 8 x 8 x 8 voxels that lies in the volume and between two slices.
struct BlockPart {
    openvdb::Coord origin;
    std::array<std::int32_t, 2> x, y, z;  // first and end, within the block
    bool fills_all_slices;                // of those of the block that the volume has
};

BlockPart block_part(const VoxelIndex& size, std::int32_t x0, std::int32_t y0, std::int32_t z0, std::int32_t k,
                     std::int32_t count) {
    BlockPart part;
    part.origin = {x0, y0, z0};
    part.x = {0, std::min(edge, size[0] - x0)};
    part.y = {0, std::min(edge, size[1] - y0)};
    part.z = {std::max(k - z0, 0), std::min(edge, k + count - z0)};
    part.fills_all_slices = part.z[0] == 0 && z0 + part.z[1] == std::min(z0 + edge, size[2]);
    return part;
}

std::int32_t blocks(std::int32_t voxels) {
    return (voxels + edge - 1) / edge;
}

}  // namespace

struct LabelVolume::State {
    VoxelIndex size;
    Vec3 spacing, origin;
    int threads = 1;
    Trees trees;

    void check_slices(std::int32_t k, std::int32_t count) const {
        if (k < 0 || count < 1 || k > size[2] - count)
            throw std::out_of_range(fmt::format("slices {} to {} of {}", k, k + count - 1, size[2]));
    }
};

LabelVolume::LabelVolume(VoxelIndex size, Vec3 spacing, Vec3 origin) : state_(std::make_unique<State>()) {
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] < 1)
            throw InvalidInput(fmt::format("a volume of {} x {} x {} voxels: each edge must be at least 1", size[0],
                                           size[1], size[2]));
        if (!(spacing[axis] > 0) || !std::isfinite(spacing[axis]))
            throw InvalidInput(fmt::format("voxel size {:g} mm: it must be more than 0", spacing[axis]));
        if (!std::isfinite(origin[axis])) throw InvalidInput("the origin of a volume must be finite");
    }
    state_->size = size;
    state_->spacing = spacing;
    state_->origin = origin;
}

LabelVolume::~LabelVolume() = default;
LabelVolume::LabelVolume(LabelVolume&&) noexcept = default;
LabelVolume& LabelVolume::operator=(LabelVolume&&) noexcept = default;

VoxelIndex LabelVolume::size() const {
    return state_->size;
}
Vec3 LabelVolume::spacing() const {
    return state_->spacing;
}
Vec3 LabelVolume::origin() const {
    return state_->origin;
}
Vec3 LabelVolume::extent() const {
    return state_->spacing.cwiseProduct(Vec3(state_->size[0], state_->size[1], state_->size[2]));
}

void LabelVolume::use_threads(int threads) {
    state_->threads = threads;
}

int LabelVolume::threads() const {
    return state_->threads;
}

void LabelVolume::set_slice(std::int32_t k, const std::vector<std::int32_t>& labels) {
    set_slices(k, 1, labels);
}

void LabelVolume::slice(std::int32_t k, std::vector<std::int32_t>& labels) const {
    slices(k, 1, labels);
}

void LabelVolume::set_slices(std::int32_t k, std::int32_t count, std::span<const std::int32_t> labels) {
    State& state = *state_;
    state.check_slices(k, count);
    const std::int64_t row = state.size[0], page = row * state.size[1];
    if (static_cast<std::int64_t>(labels.size()) != page * count)
        throw std::length_error(fmt::format("{} labels for {} slices of {}", labels.size(), count, page));

    const std::int32_t columns = blocks(state.size[0]), rows = blocks(state.size[1]);
    // Blocks are built on all threads and put into the trees, which only one thread may change, after that.
    struct Built {
        std::unique_ptr<Leaf> wide;
        std::unique_ptr<NarrowLeaf> narrow;
        std::int32_t constant = 0;
    };
    std::vector<Built> built(static_cast<std::size_t>(columns) * rows);
    for (std::int32_t z0 = k - k % edge; z0 < k + count; z0 += edge) {
        parallel_for(rows, state.threads, [&](std::int64_t block_row) {
            const Lookup lookup(state.trees);
            std::array<std::int32_t, voxels_of_a_block> data;
            for (std::int32_t column = 0; column < columns; ++column) {
                const BlockPart part =
                    block_part(state.size, column * edge, static_cast<std::int32_t>(block_row) * edge, z0, k, count);
                const std::int32_t* const first =
                    labels.data() + (z0 - k) * page + part.origin.y() * row + part.origin.x();
                Built& block = built[block_row * columns + column];
                block = {};
                bool same = part.fills_all_slices;
                const std::int32_t value = first[part.z[0] * page];
                for (std::int32_t z = part.z[0]; same && z < part.z[1]; ++z)
                    for (std::int32_t y = 0; same && y < part.y[1]; ++y) {
                        const std::int32_t* const voxels = first + z * page + y * row;
                        same = std::all_of(voxels, voxels + part.x[1], [value](auto voxel) { return voxel == value; });
                    }
                if (same) {
                    block.constant = value;
                    continue;
                }
                const Block old = lookup.block(part.origin);
                for (std::int32_t at = 0; at < voxels_of_a_block; ++at) data[at] = old[at];
                for (std::int32_t z = part.z[0]; z < part.z[1]; ++z)
                    for (std::int32_t y = 0; y < part.y[1]; ++y) {
                        const std::int32_t* const voxels = first + z * page + y * row;
                        for (std::int32_t x = 0; x < part.x[1]; ++x) data[leaf_offset(x, y, z)] = voxels[x];
                    }
                if (std::all_of(data.begin(), data.end(), [](auto label) { return label >= 0 && label < 256; })) {
                    block.narrow = std::make_unique<NarrowLeaf>(part.origin, std::uint8_t{0}, true);
                    std::copy(data.begin(), data.end(), block.narrow->buffer().data());
                } else {
                    block.wide = std::make_unique<Leaf>(part.origin, 0, true);
                    std::copy(data.begin(), data.end(), block.wide->buffer().data());
                }
            }
        });
        openvdb::tree::ValueAccessor<Tree> wide(state.trees.wide);
        openvdb::tree::ValueAccessor<NarrowTree> narrow(state.trees.narrow);
        for (std::int32_t block_row = 0; block_row < rows; ++block_row)
            for (std::int32_t column = 0; column < columns; ++column) {
                Built& block = built[static_cast<std::size_t>(block_row) * columns + column];
                const openvdb::Coord origin(column * edge, block_row * edge, z0);
                if (block.narrow)
                    narrow.addLeaf(block.narrow.release());
                else if (narrow.probeConstLeaf(origin))
                    narrow.addTile(1, origin, 0, false);
                if (block.wide)
                    wide.addLeaf(block.wide.release());
                else if (wide.probeConstLeaf(origin) || wide.getValue(origin) != block.constant)
                    wide.addTile(1, origin, block.constant, block.constant != 0);
            }
    }
}

void LabelVolume::slices(std::int32_t k, std::int32_t count, std::vector<std::int32_t>& labels) const {
    const State& state = *state_;
    state.check_slices(k, count);
    const std::int64_t row = state.size[0], page = row * state.size[1];
    labels.resize(page * count);
    const std::int32_t columns = blocks(state.size[0]), rows = blocks(state.size[1]);
    for (std::int32_t z0 = k - k % edge; z0 < k + count; z0 += edge)
        parallel_for(rows, state.threads, [&](std::int64_t block_row) {
            const Lookup lookup(state.trees);
            for (std::int32_t column = 0; column < columns; ++column) {
                const BlockPart part =
                    block_part(state.size, column * edge, static_cast<std::int32_t>(block_row) * edge, z0, k, count);
                std::int32_t* const first = labels.data() + (z0 - k) * page + part.origin.y() * row + part.origin.x();
                const Block block = lookup.block(part.origin);
                for (std::int32_t z = part.z[0]; z < part.z[1]; ++z)
                    for (std::int32_t y = 0; y < part.y[1]; ++y) {
                        std::int32_t* const voxels = first + z * page + y * row;
                        if (block.is_constant())
                            std::fill(voxels, voxels + part.x[1], block.constant);
                        else
                            for (std::int32_t x = 0; x < part.x[1]; ++x) voxels[x] = block[leaf_offset(x, y, z)];
                    }
            }
        });
}

std::map<std::int32_t, std::int64_t> LabelVolume::histogram() const {
    const State& state = *state_;
    const VoxelIndex& size = state.size;
    const std::int32_t layers = blocks(size[2]);
    std::vector<std::map<std::int32_t, std::int64_t>> counted(layers);
    parallel_for(layers, state.threads, [&](std::int64_t layer) {
        const Lookup lookup(state.trees);
        auto& counts = counted[layer];
        const auto z0 = static_cast<std::int32_t>(layer) * edge;
        for (std::int32_t y0 = 0; y0 < size[1]; y0 += edge)
            for (std::int32_t x0 = 0; x0 < size[0]; x0 += edge) {
                const BlockPart part = block_part(size, x0, y0, z0, z0, edge);
                const std::int32_t depth = std::min(edge, size[2] - z0);
                const Block block = lookup.block(part.origin);
                if (block.is_constant()) {
                    counts[block.constant] += std::int64_t{1} * part.x[1] * part.y[1] * depth;
                    continue;
                }
                std::int32_t last = block[0];
                std::int64_t run = 0;
                for (std::int32_t x = 0; x < part.x[1]; ++x)
                    for (std::int32_t y = 0; y < part.y[1]; ++y)
                        for (std::int32_t z = 0; z < depth; ++z) {
                            const std::int32_t label = block[leaf_offset(x, y, z)];
                            if (label != last) {
                                counts[last] += run;
                                last = label;
                                run = 0;
                            }
                            ++run;
                        }
                counts[last] += run;
            }
    });
    std::map<std::int32_t, std::int64_t> total;
    for (const auto& counts : counted)
        for (const auto& [label, voxels] : counts) total[label] += voxels;
    return total;
}

std::int64_t LabelVolume::memory() const {
    return static_cast<std::int64_t>(state_->trees.wide.memUsage() + state_->trees.narrow.memUsage());
}

namespace {

using Votes = std::vector<std::pair<std::int32_t, std::int64_t>>;

void vote(Votes& votes, std::int32_t label, std::int64_t weight) {
    for (auto& [known, sum] : votes)
        if (known == label) {
            sum += weight;
            return;
        }
    votes.emplace_back(label, weight);
}

std::int32_t winner(const Votes& votes) {
    return std::max_element(votes.begin(), votes.end(),
                            [](const auto& a, const auto& b) {
                                return a.second < b.second || (a.second == b.second && a.first > b.first);
                            })
        ->first;
}

/// Integral of the kernel of level_set up to u (in widths).
double smoothing_integral(double u) {
    constexpr double of_density = 0.3989422804014327;  // 1 / sqrt(2 pi)
    return 0.5 * std::erfc(-u * std::numbers::sqrt2 / 2) + 0.5 * u * of_density * std::exp(-0.5 * u * u);
}

}  // namespace

struct LabelVolume::Sampler::State {
    explicit State(const LabelVolume::State& of) : volume(of), lookup(of.trees) {}
    const LabelVolume::State& volume;
    Lookup lookup;

    /// The voxels around one that level_set looks at.
    std::array<std::int32_t, 3> first{}, end{};
    std::vector<std::int32_t> around;  // x slowest, as in a leaf
    Votes votes;

    /// Copies those voxels. @return false where all have one label
    bool gather(const VoxelIndex& centre, std::int32_t reach);
    /// Label of the level set at a place within the centre, given from its middle in voxels.
    std::int32_t smooth(const VoxelIndex& centre, const Vec3& offset, double width);
};

bool LabelVolume::Sampler::State::gather(const VoxelIndex& centre, std::int32_t reach) {
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = std::max(0, centre[axis] - reach);
        end[axis] = std::min(volume.size[axis], centre[axis] + reach + 1);
    }
    const std::int32_t rows = end[1] - first[1], depth = end[2] - first[2];
    around.resize(std::size_t(end[0] - first[0]) * rows * depth);
    const auto block_end = [&](int axis, std::int32_t i) { return std::min(end[axis], i - i % edge + edge); };
    const std::int32_t label = lookup.label(openvdb::Coord(first[0], first[1], first[2]));
    bool mixed = false;
    for (std::int32_t x0 = first[0]; x0 < end[0]; x0 = block_end(0, x0))
        for (std::int32_t y0 = first[1]; y0 < end[1]; y0 = block_end(1, y0))
            for (std::int32_t z0 = first[2]; z0 < end[2]; z0 = block_end(2, z0)) {
                const std::int32_t z1 = block_end(2, z0);
                const Block block = lookup.block(openvdb::Coord(x0, y0, z0));
                if (block.is_constant()) mixed |= block.constant != label;
                for (std::int32_t x = x0; x < block_end(0, x0); ++x)
                    for (std::int32_t y = y0; y < block_end(1, y0); ++y) {
                        std::int32_t* to =
                            around.data() + (std::size_t(x - first[0]) * rows + (y - first[1])) * depth + z0 - first[2];
                        if (block.is_constant()) {
                            std::fill(to, to + (z1 - z0), block.constant);
                            continue;
                        }
                        const std::int32_t line = leaf_offset(x % edge, y % edge, 0);
                        for (std::int32_t z = z0; z < z1; ++z) {
                            *to++ = block[line + z % edge];
                            mixed |= to[-1] != label;
                        }
                    }
            }
    return mixed;
}

std::int32_t LabelVolume::Sampler::State::smooth(const VoxelIndex& centre, const Vec3& offset, double width) {
    // Whole numbers, so that equal shares tie exactly.
    constexpr std::int32_t max_edge = 64;
    std::array<std::array<std::int64_t, max_edge>, 3> weights;
    for (int axis = 0; axis < 3; ++axis) {
        double below = smoothing_integral((first[axis] - centre[axis] - 0.5 - offset[axis]) / width);
        for (std::int32_t i = first[axis]; i < end[axis]; ++i) {
            const double above = smoothing_integral((i + 1 - centre[axis] - 0.5 - offset[axis]) / width);
            weights[axis][i - first[axis]] = std::llround((above - below) * (1 << 19));
            below = above;
        }
    }
    votes.clear();
    const std::int32_t* label = around.data();
    for (std::int32_t x = 0; x < end[0] - first[0]; ++x)
        for (std::int32_t y = 0; y < end[1] - first[1]; ++y) {
            const std::int64_t face = weights[0][x] * weights[1][y];
            // Runs of one label along z cost one vote.
            for (std::int32_t z = 0; z < end[2] - first[2];) {
                const std::int32_t of_run = *label;
                std::int64_t sum = 0;
                for (; z < end[2] - first[2] && *label == of_run; ++z, ++label) sum += weights[2][z];
                vote(votes, of_run, face * sum);
            }
        }
    return winner(votes);
}

LabelVolume::Sampler::Sampler(const LabelVolume& volume) : state_(std::make_unique<State>(*volume.state_)) {}
LabelVolume::Sampler::~Sampler() = default;

std::int32_t LabelVolume::Sampler::at(const VoxelIndex& voxel) const {
    for (int axis = 0; axis < 3; ++axis)
        if (voxel[axis] < 0 || voxel[axis] >= state_->volume.size[axis]) return 0;
    return state_->lookup.label(openvdb::Coord(voxel[0], voxel[1], voxel[2]));
}

std::int32_t LabelVolume::Sampler::nearest(const Vec3& point) const {
    VoxelIndex voxel;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::floor((point[axis] - state_->volume.origin[axis]) / state_->volume.spacing[axis]);
        if (!(at >= 0 && at < state_->volume.size[axis])) return 0;
        voxel[axis] = static_cast<std::int32_t>(at);
    }
    return state_->lookup.label(openvdb::Coord(voxel[0], voxel[1], voxel[2]));
}

std::int32_t LabelVolume::Sampler::majority(const Vec3& point, double half) const {
    const LabelVolume::State& volume = state_->volume;
    std::array<std::int32_t, 3> first, end;
    // Whole numbers (1/1024 of a voxel), so that equal shares tie exactly.
    std::array<std::vector<std::int64_t>, 3> weights;
    for (int axis = 0; axis < 3; ++axis) {
        const double centre = (point[axis] - volume.origin[axis]) / volume.spacing[axis];
        const double low = std::max(centre - half / volume.spacing[axis], 0.0);
        const double high = std::min(centre + half / volume.spacing[axis], static_cast<double>(volume.size[axis]));
        if (!(low < high)) return nearest(point);
        first[axis] = static_cast<std::int32_t>(std::floor(low));
        end[axis] = static_cast<std::int32_t>(std::ceil(high));
        for (std::int32_t i = first[axis]; i < end[axis]; ++i)
            weights[axis].push_back(std::llround(1024 * (std::min(high, i + 1.0) - std::max(low, double(i)))));
    }
    Votes& votes = state_->votes;
    votes.clear();
    const auto part = [&](int axis, std::int32_t from, std::int32_t to) {
        std::int64_t sum = 0;
        for (std::int32_t i = from; i < to; ++i) sum += weights[axis][i - first[axis]];
        return sum;
    };
    const auto block_end = [&](int axis, std::int32_t i) { return std::min(end[axis], i - i % edge + edge); };
    for (std::int32_t x0 = first[0]; x0 < end[0]; x0 = block_end(0, x0))
        for (std::int32_t y0 = first[1]; y0 < end[1]; y0 = block_end(1, y0))
            for (std::int32_t z0 = first[2]; z0 < end[2]; z0 = block_end(2, z0)) {
                const std::int32_t x1 = block_end(0, x0), y1 = block_end(1, y0), z1 = block_end(2, z0);
                const openvdb::Coord corner(x0, y0, z0);
                const Block block = state_->lookup.block(corner);
                if (block.is_constant()) {
                    vote(votes, block.constant, part(0, x0, x1) * part(1, y0, y1) * part(2, z0, z1));
                    continue;
                }
                for (std::int32_t x = x0; x < x1; ++x)
                    for (std::int32_t y = y0; y < y1; ++y) {
                        const std::int64_t face = weights[0][x - first[0]] * weights[1][y - first[1]];
                        const std::int32_t line = leaf_offset(x % edge, y % edge, 0);
                        for (std::int32_t z = z0; z < z1; ++z)
                            vote(votes, block[line + z % edge], face * weights[2][z - first[2]]);
                    }
            }
    return winner(votes);
}

std::int32_t LabelVolume::Sampler::level_set(const Vec3& point, double width) const {
    State& state = *state_;
    if (!(width >= 0.2 && width <= 8)) throw std::out_of_range("width of the level set's smoothing");
    VoxelIndex voxel;
    Vec3 offset;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = (point[axis] - state.volume.origin[axis]) / state.volume.spacing[axis];
        if (!(at >= 0 && at < state.volume.size[axis])) return 0;
        voxel[axis] = static_cast<std::int32_t>(at);
        offset[axis] = at - (voxel[axis] + 0.5);
    }
    // Beyond 3.5 widths there is a thousandth of the kernel.
    const bool mixed = state.gather(voxel, static_cast<std::int32_t>(std::ceil(3.5 * width)));
    if (!mixed) return state.around.front();
    const std::int32_t own = state.lookup.label(openvdb::Coord(voxel[0], voxel[1], voxel[2]));
    const std::int32_t label = state.smooth(voxel, offset, width);
    return label == own || state.smooth(voxel, Vec3::Zero(), width) == own ? label : own;
}

}  // namespace tomodem
