#include "solver_plugin/quasi_static/flow_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::plugin {
namespace {

/// Least distance over the reach: two centres in one place have no direction.
constexpr double min_distance = 1e-9;

}  // namespace

void FlowPairs::find(const ParticleView& particles, double reach) {
    rows_.clear();
    other_.clear();
    apart_.clear();
    pushing_.clear();
    search_.sort(particles.position, particles.local_count, particles.count, reach);
    for (int cell = 0; cell < search_.cell_count(); ++cell) {
        const int end = search_.first_slot(cell + 1);
        if (search_.first_slot(cell) == end) continue;
        search_.enter(cell);
        found_.resize(std::max(found_.size(), static_cast<std::size_t>(search_.most_found())));
        for (int slot = search_.first_slot(cell); slot < end; ++slot) {
            const std::int32_t i = search_.particle(slot);
            rows_.push_back({i, static_cast<std::uint32_t>(other_.size())});
            const int count = search_.find(slot, found_.data());
            for (int k = 0; k < count; ++k) {
                const std::int32_t j = found_[k];
                double apart[3], squared = 0;
                for (int c = 0; c < 3; ++c) {
                    apart[c] = particles.position[3 * i + c] - particles.position[3 * j + c];
                    squared += apart[c] * apart[c];
                }
                const double distance = std::sqrt(squared);
                if (distance >= reach || distance < min_distance * reach) continue;
                const Four row{static_cast<float>(apart[0]), static_cast<float>(apart[1]), static_cast<float>(apart[2]),
                               static_cast<float>(distance)};
                if (!particles.same_object(i, j)) {
                    pushing_.push_back({i, j, row});
                    continue;
                }
                other_.push_back(j);
                apart_.push_back(row);
            }
        }
    }
    rows_.push_back({-1, static_cast<std::uint32_t>(other_.size())});
}

}  // namespace tomodem::plugin
