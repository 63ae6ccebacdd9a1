#include "solver_plugin/pairs/pair_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "solver_plugin/pairs/two_processors.hpp"

namespace tomodem::plugin {
namespace {

constexpr int lanes = 8;
constexpr float far_away = 1e18F;

typedef float Floats __attribute__((vector_size(4 * lanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * lanes)));

TOMODEM_INLINE Floats all(float x) {
    return Floats{x, x, x, x, x, x, x, x};
}

}  // namespace

int PairSearch::cell_of(const double* point) const {
    int cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const int along = static_cast<int>((point[axis] - low_[axis]) * cells_per_length_[axis]);
        cell = cell * cells_[axis] + std::clamp(along, 0, cells_[axis] - 1);
    }
    return cell;
}

void PairSearch::place(const double* position, int begin, int end, Sorted& sorted) {
    const int count = end - begin;
    sorted.start.assign(cell_count() + 1, 0);
    cell_.resize(count);
    for (int k = 0; k < count; ++k) {
        cell_[k] = cell_of(position + 3 * (begin + k));
        ++sorted.start[cell_[k] + 1];
    }
    for (int cell = 0; cell < cell_count(); ++cell) sorted.start[cell + 1] += sorted.start[cell];
    sorted.index.resize(count + lanes);
    for (auto& values : sorted.coordinate) {
        values.resize(count + lanes);
        std::fill_n(values.begin() + count, lanes, far_away);
    }
    for (int k = 0; k < count; ++k) {
        const int slot = sorted.start[cell_[k]]++;
        sorted.index[slot] = begin + k;
        for (int axis = 0; axis < 3; ++axis)
            sorted.coordinate[axis][slot] = static_cast<float>(position[3 * (begin + k) + axis] - low_[axis]);
    }
    // Filling moved every start to the next cell's.
    std::copy_backward(sorted.start.begin(), sorted.start.end() - 1, sorted.start.end());
    sorted.start[0] = 0;
}

void PairSearch::sort(const double* position, int local_count, int count, double reach) {
    double high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = high[axis] = count > 0 ? position[axis] : 0.0;
        for (int i = 0; i < count; ++i) {
            low_[axis] = std::min(low_[axis], position[3 * i + axis]);
            high[axis] = std::max(high[axis], position[3 * i + axis]);
        }
    }
    // A sample that has flown apart must not ask for more cells than it has particles.
    double width = reach;
    const auto cells = [&](double edge) {
        double product = 1;
        for (int axis = 0; axis < 3; ++axis) product *= std::max(1.0, std::floor((high[axis] - low_[axis]) / edge));
        return product;
    };
    while (cells(width) > 8.0 * count + 1000) width *= 2;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = high[axis] - low_[axis];
        cells_[axis] = std::max(1, static_cast<int>(extent / width));
        cells_per_length_[axis] = extent > 0 ? cells_[axis] / extent : 0.0;
    }
    // Coordinates in single precision are off by some 1e-7 of the extent, and of the distance to the origin: none
    // within reach may be missed.
    double extent = 0;
    for (int axis = 0; axis < 3; ++axis)
        extent = std::max({extent, high[axis] - low_[axis], std::abs(low_[axis]), std::abs(high[axis])});
    const double safe_reach = reach + 1e-6 * extent;
    reach_squared_ = static_cast<float>(safe_reach * safe_reach);
    place(position, 0, local_count, local_);
    place(position, local_count, count, ghosts_);
    moved_.index.assign(lanes, 0);
    for (auto& values : moved_.coordinate) values.assign(lanes, far_away);
}

void PairSearch::move(std::int32_t particle, const double* point) {
    // In front of the far away ones at the end.
    moved_.index.insert(moved_.index.end() - lanes, particle);
    for (int axis = 0; axis < 3; ++axis) {
        auto& values = moved_.coordinate[axis];
        values.insert(values.end() - lanes, static_cast<float>(point[axis] - low_[axis]));
    }
}

TOMODEM_TWO_PROCESSORS int PairSearch::search(const Run& run, const float* at, std::int32_t* found, int count) const {
    const Floats here[3] = {all(at[0]), all(at[1]), all(at[2])};
    const Floats reach_squared = all(reach_squared_);
    const float* const coordinate[3] = {run.particles->coordinate[0].data(), run.particles->coordinate[1].data(),
                                        run.particles->coordinate[2].data()};
    const std::int32_t* const index = run.particles->index.data();
    for (int k = run.begin; k < run.end; k += lanes) {
        Floats squared{};
        for (int axis = 0; axis < 3; ++axis) {
            Floats way;
            std::memcpy(&way, coordinate[axis] + k, sizeof way);
            way -= here[axis];
            squared += way * way;
        }
        const Ints near = squared < reach_squared;  // -1 or 0
        // Every one is written, and the next one over it unless it is near.
        const int behind = std::min(lanes, run.end - k);
        for (int lane = 0; lane < behind; ++lane) {
            found[count] = index[k + lane];
            count -= near[lane];
        }
    }
    return count;
}

void PairSearch::find_around(const double* point, std::vector<std::int32_t>& found) const {
    float at[3];
    for (int axis = 0; axis < 3; ++axis) at[axis] = static_cast<float>(point[axis] - low_[axis]);
    int count = 0;
    const auto look = [&](const Sorted& particles, int begin, int end) {
        found.resize(std::max(found.size(), static_cast<std::size_t>(count + end - begin + lanes)));
        count = search({&particles, begin, end}, at, found.data(), count);
    };
    const int cell = cell_of(point);
    const int x = cell % cells_[0], y = cell / cells_[0] % cells_[1], z = cell / cells_[0] / cells_[1];
    for (int row_z = std::max(0, z - 1); row_z <= std::min(cells_[2] - 1, z + 1); ++row_z)
        for (int row_y = std::max(0, y - 1); row_y <= std::min(cells_[1] - 1, y + 1); ++row_y) {
            const int row = (row_z * cells_[1] + row_y) * cells_[0];
            const int first = row + std::max(0, x - 1), behind = row + std::min(cells_[0] - 1, x + 1) + 1;
            look(local_, local_.start[first], local_.start[behind]);
            look(ghosts_, ghosts_.start[first], ghosts_.start[behind]);
        }
    look(moved_, 0, static_cast<int>(moved_.index.size()) - lanes);
    found.resize(count);
}

void PairSearch::enter(int cell) {
    run_count_ = most_found_ = 0;
    const auto add = [&](const Sorted& particles, int begin, int end) {
        if (begin == end) return;
        runs_[run_count_++] = {&particles, begin, end};
        most_found_ += end - begin + lanes;
    };
    const int at[3] = {cell % cells_[0], cell / cells_[0] % cells_[1], cell / cells_[0] / cells_[1]};
    const int before = at[0] > 0 ? 1 : 0, after = at[0] + 1 < cells_[0] ? 1 : 0;
    // Own cell and the next along x, where find() leaves out what comes before its slot.
    own_end_ = local_.start[cell + 1 + after];
    most_found_ += own_end_ - local_.start[cell] + lanes;
    for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
            const int y = at[1] + dy, z = at[2] + dz;
            if (y < 0 || y >= cells_[1] || z < 0 || z >= cells_[2]) continue;
            const int row = (z * cells_[1] + y) * cells_[0] + at[0];
            const bool ahead = dz > 0 || (dz == 0 && dy > 0);
            if (ahead) add(local_, local_.start[row - before], local_.start[row + after + 1]);
            add(ghosts_, ghosts_.start[row - before], ghosts_.start[row + after + 1]);
        }
}

int PairSearch::find(int slot, std::int32_t* found) const {
    const float at[3] = {local_.coordinate[0][slot], local_.coordinate[1][slot], local_.coordinate[2][slot]};
    int count = search({&local_, slot + 1, own_end_}, at, found, 0);
    for (int k = 0; k < run_count_; ++k) count = search(runs_[k], at, found, count);
    return count;
}

}  // namespace tomodem::plugin
