#include "tools/packgen/neighbour_list.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::packgen {

namespace {

double wrapped(double s) {
    s -= std::floor(s);
    return s < 1.0 ? s : 0.0;  // -1e-17 wraps to 1
}

int cell_coordinate(double s, int cells) {
    return std::min(static_cast<int>(s * cells), cells - 1);
}

}  // namespace

void NeighbourList::build(std::vector<Row>& position, std::vector<Row>& travellers, double cutoff, ThreadTeam& team) {
    cutoff_ = cutoff;
    const std::size_t particles = position.size();
    // Larger cells than necessary in a gas, where there would be many more cells than particles.
    cells_ = static_cast<int>(std::min(1.0 / cutoff, std::ceil(std::cbrt(static_cast<double>(particles)))));
    if (cells_ < 3) cells_ = 1;
    sort_by_cell(position, travellers, team);
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

void NeighbourList::sort_by_cell(std::vector<Row>& position, std::vector<Row>& travellers, ThreadTeam& team) {
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
    for_particles([&](std::size_t i) {
        Row& p = position[i];
        p = {wrapped(p.x), wrapped(p.y), wrapped(p.z), 0.0};
        const int x = cell_coordinate(p.x, cells_), y = cell_coordinate(p.y, cells_), z = cell_coordinate(p.z, cells_);
        cell_of_[i] = (z * cells_ + y) * cells_ + x;
    });
    cell_start_.assign(static_cast<std::size_t>(cells_) * cells_ * cells_ + 1, 0);
    for (const std::int32_t cell : cell_of_) ++cell_start_[static_cast<std::size_t>(cell) + 1];
    for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
    // Counting sort; afterwards cell_start_[c] holds the start of c + 1, so the array is shifted back by one.
    for (std::size_t i = 0; i < particles; ++i)
        order_[static_cast<std::size_t>(cell_start_[cell_of_[i]]++)] = static_cast<std::int32_t>(i);
    for (std::size_t c = cell_start_.size() - 1; c > 0; --c) cell_start_[c] = cell_start_[c - 1];
    cell_start_[0] = 0;
    for (std::vector<Row>* rows : {&position, &travellers}) {
        for_particles([&](std::size_t i) { sorted_[i] = (*rows)[static_cast<std::size_t>(order_[i])]; });
        rows->swap(sorted_);
    }
}

void NeighbourList::fill(Chunk& chunk, std::size_t first, std::size_t count, const std::vector<Row>& position) const {
    chunk.entries.clear();
    chunk.first_block.assign(1, 0);
    chunk.at_boundary.resize(count);
    std::vector<std::int32_t> found;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = first + k;
        const Row& p = position[i];
        const auto outermost = [&](double s) {
            const int c = cell_coordinate(s, cells_);
            return c == 0 || c == cells_ - 1;
        };
        chunk.at_boundary[k] = outermost(p.x) || outermost(p.y) || outermost(p.z);
        const std::size_t length = cells_ < 3 ? near_all(position, i, found) : near_cells(position, i, found);
        chunk.entries.insert(chunk.entries.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(length));
        chunk.entries.resize((chunk.entries.size() + 3) / 4 * 4, static_cast<std::int32_t>(i));
        chunk.first_block.push_back(static_cast<std::uint32_t>(chunk.entries.size() / 4));
    }
}

std::size_t NeighbourList::near_cells(const std::vector<Row>& position, std::size_t i,
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
            const double dx = x - q.x, dy = y - q.y, dz = z - q.z;
            found[length] = j;
            length += static_cast<std::size_t>((dx * dx + dy * dy + dz * dz < cutoff_squared) &
                                               (static_cast<std::size_t>(j) != i));
        }
    };
    const int cx = cell_coordinate(p.x, cells_), cy = cell_coordinate(p.y, cells_), cz = cell_coordinate(p.z, cells_);
    for (int oz = -1; oz <= 1; ++oz) {
        const int wrap_z = cz + oz < 0 ? 1 : cz + oz == cells_ ? -1 : 0;
        for (int oy = -1; oy <= 1; ++oy) {
            const int wrap_y = cy + oy < 0 ? 1 : cy + oy == cells_ ? -1 : 0;
            const std::int32_t row = ((cz + oz + wrap_z * cells_) * cells_ + cy + oy + wrap_y * cells_) * cells_;
            const double y = p.y + wrap_y, z = p.z + wrap_z;
            if (cx == 0) scan(row, cells_ - 1, cells_, p.x + 1.0, y, z);
            scan(row, std::max(cx - 1, 0), std::min(cx + 2, cells_), p.x, y, z);
            if (cx == cells_ - 1) scan(row, 0, 1, p.x - 1.0, y, z);
        }
    }
    return length;
}

std::size_t NeighbourList::near_all(const std::vector<Row>& position, std::size_t i,
                                    std::vector<std::int32_t>& found) const {
    const auto nearest = [](double s) { return s - std::nearbyint(s); };
    found.resize(position.size());
    std::size_t length = 0;
    for (std::size_t j = 0; j < position.size(); ++j) {
        const double dx = nearest(position[i].x - position[j].x), dy = nearest(position[i].y - position[j].y),
                     dz = nearest(position[i].z - position[j].z);
        if (j != i && dx * dx + dy * dy + dz * dz < cutoff_ * cutoff_) found[length++] = static_cast<std::int32_t>(j);
    }
    return length;
}

}  // namespace tomodem::packgen
