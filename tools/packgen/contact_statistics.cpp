#include <algorithm>
#include <cmath>

#include "tools/packgen/compaction.hpp"
#include "tools/packgen/neighbour_list.hpp"

namespace tomodem::packgen {

ContactStatistics contact_statistics(const Packing& packing) {
    const double edge = packing.box.edges[0];
    const double diameter = 2.0 * packing.seed_radius / edge;
    std::vector<Row> position;
    position.reserve(packing.size());
    for (const Vec3& p : packing.position) {
        const Vec3 s = (p - packing.box.origin) / edge;
        position.push_back({s.x(), s.y(), s.z(), 0.0});
    }
    std::vector<Row> unused(position.size());
    NeighbourList list;
    ThreadTeam alone(1);
    list.build(position, unused, diameter, alone);

    const auto nearest = [](double s) { return s - std::nearbyint(s); };
    ContactStatistics statistics;
    std::int64_t ends = 0;
    double overlaps = 0.0;
    for (std::size_t k = 0; k < list.chunk_count(); ++k) {
        const NeighbourBlocks blocks = list.chunk(k);
        for (std::size_t c = 0; c < list.chunk_length(k); ++c) {
            const std::size_t i = k * NeighbourList::chunk_size + c;
            for (std::size_t e = 4 * blocks.first_block[c]; e < 4 * blocks.first_block[c + 1]; ++e) {
                const auto j = static_cast<std::size_t>(blocks.entries[e]);
                if (j == i) continue;
                const double distance =
                    std::hypot(nearest(position[i].x - position[j].x), nearest(position[i].y - position[j].y),
                               nearest(position[i].z - position[j].z));
                const double overlap = 1.0 - distance / diameter;
                if (overlap <= 0.0) continue;
                ++ends;
                overlaps += overlap;
                statistics.max_overlap = std::max(statistics.max_overlap, overlap);
            }
        }
    }
    statistics.contacts = ends / 2;
    if (packing.size() > 0)
        statistics.mean_coordination = static_cast<double>(ends) / static_cast<double>(packing.size());
    if (ends > 0) statistics.mean_overlap = overlaps / static_cast<double>(ends);
    return statistics;
}

}  // namespace tomodem::packgen
