#include "tools/packgen/neighbour_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tomodem::packgen {

namespace {

double wrapped(double s, double edge) {
    s -= edge * std::floor(s / edge);
    return s < edge ? s : 0.0;  // -1e-17 wraps to the edge
}

int cell_coordinate(double s, int cells, double edge) {
    return std::clamp(static_cast<int>(s * cells / edge), 0, cells - 1);
}

}  // namespace

void NeighbourList::build(std::vector<Row>& position, std::vector<Row>& attached, double cutoff, ThreadTeam& team,
                          const Region& region, double diameter, double skin) {
    cutoff_ = cutoff;
    region_ = region;
    diameter_ = diameter;
    skin_ = skin;
    const std::size_t particles = position.size();
    // Larger cells than necessary in a gas, where there would be many more cells than particles.
    const double one_each = std::cbrt(static_cast<double>(particles) / region.volume());
    for (int axis = 0; axis < 3; ++axis) {
        const double edge = region.edges[axis];
        cells_[axis] = static_cast<int>(std::max(1.0, std::min(edge / cutoff, std::ceil(edge * one_each))));
        if (region.periodic[axis] && cells_[axis] < 3) cells_[axis] = 1;
    }
    sort_by_cell(position, attached, team);
    chunks_.resize((particles + chunk_size - 1) / chunk_size);
    team.for_each(chunks_.size(), [&](std::size_t k) {
        const std::size_t first = k * chunk_size;
        fill(chunks_[k], first, std::min(chunk_size, particles - first), position);
    });
}

NeighbourBlocks NeighbourList::chunk(std::size_t chunk) const {
    const Chunk& c = chunks_[chunk];
    return {c.entries.data(), c.first_block.data(), c.at_boundary.data()};
}

void NeighbourList::sort_by_cell(std::vector<Row>& position, std::vector<Row>& attached, ThreadTeam& team) {
    const std::size_t particles = position.size();
    cell_of_.resize(particles);
    order_.resize(particles);
    sorted_.resize(particles);
    const std::size_t chunks = (particles + chunk_size - 1) / chunk_size;
    const auto for_particles = [&](auto&& work) {
        team.for_each(chunks, [&](std::size_t k) {
            const std::size_t end = std::min(particles, (k + 1) * chunk_size);
            for (std::size_t i = k * chunk_size; i < end; ++i) work(i);
        });
    };
    const double edge_x = region_.edges[0], edge_y = region_.edges[1], edge_z = region_.edges[2];
    for_particles([&](std::size_t i) {
        Row& p = position[i];
        if (region_.periodic[0]) p.x = wrapped(p.x, edge_x);
        if (region_.periodic[1]) p.y = wrapped(p.y, edge_y);
        if (region_.periodic[2]) p.z = wrapped(p.z, edge_z);
        const int x = cell_coordinate(p.x, cells_[0], edge_x), y = cell_coordinate(p.y, cells_[1], edge_y),
                  z = cell_coordinate(p.z, cells_[2], edge_z);
        cell_of_[i] = (z * cells_[1] + y) * cells_[0] + x;
    });
    cell_start_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2] + 1, 0);
    for (const std::int32_t cell : cell_of_) ++cell_start_[static_cast<std::size_t>(cell) + 1];
    for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
    // Counting sort; afterwards cell_start_[c] holds the start of c + 1, so the array is shifted back by one.
    for (std::size_t i = 0; i < particles; ++i)
        order_[static_cast<std::size_t>(cell_start_[cell_of_[i]]++)] = static_cast<std::int32_t>(i);
    for (std::size_t c = cell_start_.size() - 1; c > 0; --c) cell_start_[c] = cell_start_[c - 1];
    cell_start_[0] = 0;
    for (std::vector<Row>* rows : {&position, &attached}) {
        for_particles([&](std::size_t i) { sorted_[i] = (*rows)[static_cast<std::size_t>(order_[i])]; });
        rows->swap(sorted_);
    }
}

bool NeighbourList::one_cell() const {
    for (int axis = 0; axis < 3; ++axis)
        if (region_.periodic[axis] && cells_[axis] == 1) return true;
    return false;
}

void NeighbourList::fill(Chunk& chunk, std::size_t first, std::size_t count, const std::vector<Row>& position) const {
    chunk.entries.clear();
    chunk.first_block.assign(1, 0);
    chunk.at_boundary.resize(count);
    std::vector<std::int32_t> found;
    const auto near_some =
        one_cell() ? (region_.equal_radii ? &NeighbourList::near<true, true> : &NeighbourList::near<true, false>)
                   : (region_.equal_radii ? &NeighbourList::near<false, true> : &NeighbourList::near<false, false>);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = first + k;
        const Row& p = position[i];
        const auto outermost = [&](int axis, double s) {
            const int c = cell_coordinate(s, cells_[axis], region_.edges[axis]);
            return region_.periodic[axis] && (c == 0 || c == cells_[axis] - 1);
        };
        chunk.at_boundary[k] = outermost(0, p.x) || outermost(1, p.y) || outermost(2, p.z);
        const std::size_t length = (this->*near_some)(position, i, found);
        chunk.entries.insert(chunk.entries.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(length));
        chunk.entries.resize((chunk.entries.size() + 3) / 4 * 4, static_cast<std::int32_t>(i));
        chunk.first_block.push_back(static_cast<std::uint32_t>(chunk.entries.size() / 4));
    }
}

/// `one_cell`: some periodic edge has one cell, whose particles may be near through either of its ends.
template <bool one_cell, bool equal_radii>
std::size_t NeighbourList::near(const std::vector<Row>& position, std::size_t i,
                                std::vector<std::int32_t>& found) const {
    const Row& p = position[i];
    const double cutoff_squared = cutoff_ * cutoff_;
    std::size_t length = 0;
    // Particles of the cells [from, to) of one row lie behind one another; their images are shifted against p.
    const auto scan = [&](std::int32_t row, int from, int to, double x, double y, double z) {
        const std::int32_t begin = cell_start_[static_cast<std::size_t>(row + from)];
        const std::int32_t end = cell_start_[static_cast<std::size_t>(row + to)];
        if (found.size() < length + static_cast<std::size_t>(end - begin))
            found.resize(2 * (length + static_cast<std::size_t>(end - begin)));
        for (std::int32_t j = begin; j < end; ++j) {
            const Row& q = position[static_cast<std::size_t>(j)];
            double dx = x - q.x, dy = y - q.y, dz = z - q.z;
            if constexpr (one_cell) {
                dx = region_.nearest(0, dx);
                dy = region_.nearest(1, dy);
                dz = region_.nearest(2, dz);
            }
            double near_squared = cutoff_squared;
            if constexpr (!equal_radii) {
                const double near = std::min(cutoff_, (p.radius + q.radius) * diameter_ + skin_);
                near_squared = near * near;
            }
            found[length] = j;
            length += static_cast<std::size_t>((dx * dx + dy * dy + dz * dz < near_squared) &
                                               (static_cast<std::size_t>(j) != i));
        }
    };
    const std::array<double, 3> at{p.x, p.y, p.z};
    std::array<int, 3> cell, low, high;  // offsets of the cells to look at
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = cell_coordinate(at[axis], cells_[axis], region_.edges[axis]);
        const bool alone = cells_[axis] == 1, walls = !region_.periodic[axis];
        low[axis] = alone || (walls && cell[axis] == 0) ? 0 : -1;
        high[axis] = alone || (walls && cell[axis] == cells_[axis] - 1) ? 0 : 1;
    }
    const auto wrap = [&](int axis, int offset) {
        return cell[axis] + offset < 0 ? 1 : cell[axis] + offset == cells_[axis] ? -1 : 0;
    };
    const int nx = cells_[0], cx = cell[0];
    for (int oz = low[2]; oz <= high[2]; ++oz) {
        const int wrap_z = wrap(2, oz);
        for (int oy = low[1]; oy <= high[1]; ++oy) {
            const int wrap_y = wrap(1, oy);
            const std::int32_t row =
                ((cell[2] + oz + wrap_z * cells_[2]) * cells_[1] + cell[1] + oy + wrap_y * cells_[1]) * nx;
            const double y = p.y + wrap_y * region_.edges[1], z = p.z + wrap_z * region_.edges[2];
            if (cx + low[0] < 0) scan(row, nx - 1, nx, p.x + region_.edges[0], y, z);
            scan(row, std::max(cx - 1, 0), std::min(cx + 2, nx), p.x, y, z);
            if (cx + high[0] == nx) scan(row, 0, 1, p.x - region_.edges[0], y, z);
        }
    }
    return length;
}

}  // namespace tomodem::packgen
