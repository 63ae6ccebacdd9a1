#include "solver_plugin/norton/flow_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::plugin {
namespace {

/// Least distance over the reach: two centres in one place have no direction.
constexpr double min_distance = 1e-9;

/// From one place to the other, and the square of the way.
struct Way {
    double component[3], squared = 0;

    TOMODEM_INLINE Way(const double* to, const double* from) {
        for (int c = 0; c < 3; ++c) {
            component[c] = to[c] - from[c];
            squared += component[c] * component[c];
        }
    }
    TOMODEM_INLINE Four with_length() const {
        return Four{static_cast<float>(component[0]), static_cast<float>(component[1]),
                    static_cast<float>(component[2]), std::sqrt(static_cast<float>(squared))};
    }
};

}  // namespace

TOMODEM_TWO_PROCESSORS void FlowPairs::measure(const ParticleView& particles, double reach) {
    const double least = min_distance * reach * (min_distance * reach), most = reach * reach;
    const double* const position = particles.position;
    rows_.resize(near_rows_.size());
    other_.resize(near_.size() + 1);
    apart_.resize(near_.size() + 1);
    std::int32_t* const other = other_.data();
    Four* const apart = apart_.data();
    std::uint32_t count = 0;
    for (std::size_t row = 0; row + 1 < near_rows_.size(); ++row) {
        const std::int32_t i = near_rows_[row].particle;
        rows_[row] = {i, count};
        for (std::uint32_t k = near_rows_[row].begin; k < near_rows_[row + 1].begin; ++k) {
            const Way way(position + 3 * static_cast<std::ptrdiff_t>(i),
                          position + 3 * static_cast<std::ptrdiff_t>(near_[k]));
            // Every one is written, and the next one over it unless it is in the crown.
            other[count] = near_[k];
            apart[count] = way.with_length();
            count += static_cast<std::uint32_t>(way.squared < most) & static_cast<std::uint32_t>(way.squared >= least);
        }
    }
    rows_.back() = {-1, count};
    pushing_.clear();
    for (const Pair& pair : near_pushing_) {
        const Way way(position + 3 * static_cast<std::ptrdiff_t>(pair.particle),
                      position + 3 * static_cast<std::ptrdiff_t>(pair.other));
        if (way.squared < most && way.squared >= least)
            pushing_.push_back({pair.particle, pair.other, way.with_length()});
    }
}

void FlowPairs::find(const ParticleView& particles, double reach, bool renumbered) {
    if (renumbered || reach + skin_ != searched_reach_ || strayed(particles)) search(particles, reach + skin_);
    measure(particles, reach);
}

bool FlowPairs::strayed(const ParticleView& particles) const {
    const double limit = 0.25 * skin_ * skin_;
    for (int i = 0; i < particles.count; ++i) {
        double squared = 0;
        for (int c = 0; c < 3; ++c) {
            const double way = particles.position[3 * i + c] - searched_at_[3 * i + c];
            squared += way * way;
        }
        if (squared > limit) return true;
    }
    return false;
}

void FlowPairs::search(const ParticleView& particles, double reach) {
    ++searches_;
    searched_reach_ = reach;
    searched_at_.resize(3 * static_cast<std::size_t>(particles.count));
    for (std::size_t k = 0; k < searched_at_.size(); ++k) searched_at_[k] = static_cast<float>(particles.position[k]);
    near_rows_.clear();
    near_.clear();
    near_pushing_.clear();
    search_.sort(particles.position, particles.local_count, particles.count, reach);
    for (int cell = 0; cell < search_.cell_count(); ++cell) {
        const int end = search_.first_slot(cell + 1);
        if (search_.first_slot(cell) == end) continue;
        search_.enter(cell);
        found_.resize(std::max(found_.size(), static_cast<std::size_t>(search_.most_found())));
        for (int slot = search_.first_slot(cell); slot < end; ++slot) {
            const std::int32_t i = search_.particle(slot);
            near_rows_.push_back({i, static_cast<std::uint32_t>(near_.size())});
            const int count = search_.find(slot, found_.data());
            for (int k = 0; k < count; ++k) {
                if (particles.same_object(i, found_[k]))
                    near_.push_back(found_[k]);
                else
                    near_pushing_.push_back({i, found_[k]});
            }
        }
    }
    near_rows_.push_back({-1, static_cast<std::uint32_t>(near_.size())});
}

}  // namespace tomodem::plugin
