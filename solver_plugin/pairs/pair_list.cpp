#include "solver_plugin/pairs/pair_list.hpp"

#include <algorithm>
#include <utility>

namespace tomodem::plugin {
namespace {

/// Of the local particles, that may stray before everything is listed anew. Listing one alone costs about ten times
/// its share of the whole.
constexpr double most_strayed = 0.02;

constexpr int lanes = PairBlock::lanes;

constexpr std::uint32_t waiting = 0x80000000;
constexpr std::uint32_t no_link = 0x7FFFFFFF;

std::uint64_t key(std::int32_t i, std::int32_t j) {
    return static_cast<std::uint64_t>(std::min(i, j)) << 32 | static_cast<std::uint32_t>(std::max(i, j));
}

}  // namespace

void PairList::make(const ParticleView& particles, double reach, const ContactMemory* memory) {
    ++listings_;
    count_ = 0;
    strayed_ = 0;
    added_.clear();
    by_object_ = particles.object != nullptr;
    first_.assign(particles.local_count, waiting | no_link);
    links_.clear();
    free_link_ = no_link;
    making_ = true;
    search_.sort(particles.position, particles.local_count, particles.count, reach);
    for (int cell = 0; cell < search_.cell_count(); ++cell) {
        const int end = search_.first_slot(cell + 1);
        if (search_.first_slot(cell) == end) continue;
        search_.enter(cell);
        found_.resize(std::max(found_.size(), static_cast<std::size_t>(search_.most_found())));
        for (int slot = search_.first_slot(cell); slot < end; ++slot) {
            const std::int32_t i = search_.particle(slot);
            int count = search_.find(slot, found_.data());
            for (std::uint32_t link = first_[i] & ~waiting; link != no_link;) {
                if (static_cast<std::size_t>(count + 1 + lanes) > found_.size()) found_.resize(2 * found_.size());
                found_[count++] = links_[link].neighbour;
                const std::uint32_t taken = std::exchange(link, links_[link].before);
                links_[taken].before = std::exchange(free_link_, taken);
            }
            first_[i] = static_cast<std::uint32_t>(count_);
            add(i, found_.data(), count, particles, memory);
        }
    }
    making_ = false;
    made_ = count_;
    close();
    for (std::size_t k = 0; k < 3 * static_cast<std::size_t>(particles.count); ++k)
        listed_at_[k] = static_cast<float>(particles.position[k]);
}

bool PairList::mend(const ParticleView& particles, const std::vector<std::int32_t>& strayed,
                    const ContactMemory* memory) {
    strayed_ += static_cast<int>(strayed.size());
    if (strayed_ > most_strayed * particles.local_count + lanes) return false;
    const std::size_t before = count_;
    for (const std::int32_t i : strayed) {
        const double* const point = particles.position + 3 * static_cast<std::ptrdiff_t>(i);
        search_.find_around(point, found_);
        std::sort(found_.begin(), found_.end());
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
        const bool ghost = i >= particles.local_count;
        std::erase_if(
            found_, [&](std::int32_t j) { return j == i || (ghost && j >= particles.local_count) || is_listed(i, j); });
        for (const std::int32_t j : found_) added_.insert(key(i, j));
        const auto count = static_cast<int>(found_.size());
        found_.resize(found_.size() + lanes);
        if (!ghost) {
            add(i, found_.data(), count, particles, memory);
        } else {
            for (int k = 0; k < count; ++k) {
                std::int32_t one[1 + lanes] = {i};
                add(found_[k], one, 1, particles, memory);
            }
        }
        search_.move(i, point);
        for (int c = 0; c < 3; ++c) listed_at_[3 * static_cast<std::size_t>(i) + c] = static_cast<float>(point[c]);
    }
    for (std::size_t b = before; b < count_; ++b) {
        blocks_[b].inside = 0;
        for (int lane = 0; lane < lanes; ++lane)
            if (blocks_[b].neighbour[lane] == blocks_[b].particle) blocks_[b].inside |= 1U << lane;
    }
    close();
    return true;
}

bool PairList::is_listed(std::int32_t i, std::int32_t j) const {
    const auto has = [this](std::int32_t particle, std::int32_t neighbour) {
        if (static_cast<std::size_t>(particle) >= first_.size()) return false;
        for (std::size_t b = first_[particle]; b < made_ && blocks_[b].particle == particle; ++b)
            for (const std::int32_t listed : blocks_[b].neighbour)
                if (listed == neighbour) return true;
        return false;
    };
    return has(i, j) || has(j, i) || added_.contains(key(i, j));
}

/// Neighbours of one particle, class by class.
/// @param found  with room for `lanes` more
void PairList::add(std::int32_t i, std::int32_t* found, int count, const ParticleView& particles,
                   const ContactMemory* memory) {
    if (type_count_ == 1 && !by_object_) {
        add_blocks(i, 0, found, count, particles, memory);
        return;
    }
    const auto type_of = [&](std::int32_t k) { return type_count_ > 1 ? particles.type[k] - 1 : 0; };
    const int kinds = (by_object_ ? 2 : 1) * type_count_;
    const int room = count + lanes;
    sorted_.resize(std::max(sorted_.size(), static_cast<std::size_t>(kinds) * room));
    kept_.assign(kinds, 0);
    const std::int32_t object = by_object_ ? particles.object[particles.id[i] - 1] : 0;
    for (int k = 0; k < count; ++k) {
        const std::int32_t j = found[k];
        int kind = type_of(j);
        if (by_object_ && particles.object[particles.id[j] - 1] != object) kind += type_count_;
        sorted_[kind * room + kept_[kind]++] = j;
    }
    const int first_law = type_of(i) * type_count_;
    for (int kind = 0; kind < kinds; ++kind) {
        const int apart = kind >= type_count_ ? type_count_ * type_count_ : 0;
        add_blocks(i, first_law + kind % type_count_ + apart, sorted_.data() + static_cast<std::ptrdiff_t>(kind) * room,
                   kept_[kind], particles, memory);
    }
}

/// @param found  with room for `lanes` more
void PairList::add_blocks(std::int32_t i, int law, std::int32_t* found, int count, const ParticleView& particles,
                          const ContactMemory* memory) {
    if (making_) count = hand_on(i, found, count);
    std::fill_n(found + count, lanes, i);
    const std::size_t most = count_ + count / lanes + 1 + tail;
    if (blocks_.size() < most) blocks_.resize(most * 5 / 4);
    for (int k = 0; k < count; k += lanes) {
        PairBlock& block = blocks_[count_++];
        block = {i,
                 static_cast<std::int16_t>(law),
                 PairBlock::all_lanes,
                 0,
                 {found[k], found[k + 1], found[k + 2], found[k + 3]}};
        if (memory == nullptr || memory->interfaces(i).empty()) continue;
        for (int lane = 0; lane < lanes; ++lane)
            if (memory->is_interface(i, particles.id[block.neighbour[lane]])) block.interface |= 1U << lane;
    }
}

/// Leaves no block half empty: what is over goes to neighbours whose turn is still to come.
/// @return how many stay
int PairList::hand_on(std::int32_t i, std::int32_t* found, int count) {
    const int over = count % lanes;
    const auto can_take = [this](std::int32_t j) {
        return static_cast<std::size_t>(j) < first_.size() && (first_[j] & waiting) != 0;
    };
    int taken = 0;
    for (int k = count - 1; k >= 0 && taken < over; --k)
        if (can_take(found[k])) std::swap(found[k], found[count - ++taken]);
    if (taken < over) return count;
    for (int k = count - over; k < count; ++k) {
        std::uint32_t link = free_link_;
        if (link == no_link) {
            link = static_cast<std::uint32_t>(links_.size());
            links_.emplace_back();
        } else {
            free_link_ = links_[link].before;
        }
        links_[link] = {i, first_[found[k]] & ~waiting};
        first_[found[k]] = waiting | link;
    }
    return count - over;
}

void PairList::close() {
    blocks_.resize(std::max(blocks_.size(), count_ + tail));
    std::fill_n(blocks_.begin() + static_cast<std::ptrdiff_t>(count_), tail, PairBlock{});
}

}  // namespace tomodem::plugin
