#include "solver_plugin/pairs/contact_memory.hpp"

#include <algorithm>

namespace tomodem::plugin {

void ContactMemory::resize(int local, int ghosts) {
    local_ = local;
    const auto count = static_cast<std::size_t>(local) + static_cast<std::size_t>(ghosts);
    outward_.resize(std::max(count, outward_.size()), Outward{});
    next_.resize(std::max(count, next_.size()), Outward{});
    interfaces_.resize(std::max(static_cast<std::size_t>(local), interfaces_.size()));
}

void ContactMemory::finish_step() {
    std::copy_n(next_.begin(), local_, outward_.begin());
    std::fill(next_.begin(), next_.end(), Outward{});
}

bool ContactMemory::is_interface(int i, std::int64_t partner) const {
    return std::any_of(interfaces_[i].begin(), interfaces_[i].end(),
                       [partner](const Interface& known) { return known.partner == partner; });
}

bool ContactMemory::classify(int i, int j, const double* line, const std::int32_t* id, std::int64_t step) {
    if (!law::is_interface(law_, outward_[i].data(), outward_[j].data(), line)) return false;
    interfaces_[i].push_back({id[j], step});
    if (j < local_) interfaces_[j].push_back({id[i], step});
    return true;
}

void ContactMemory::forget(int i, int j, const std::int32_t* id) {
    const auto drop = [this](int particle, std::int64_t partner) {
        std::erase_if(interfaces_[particle], [partner](const Interface& known) { return known.partner == partner; });
    };
    drop(i, id[j]);
    if (j < local_) drop(j, id[i]);
}

std::int64_t ContactMemory::heal(std::int64_t step, std::int64_t age) {
    std::int64_t healed = 0;
    for (int i = 0; i < local_; ++i)
        healed += static_cast<std::int64_t>(
            std::erase_if(interfaces_[i], [step, age](const Interface& known) { return step - known.since >= age; }));
    return healed;
}

}  // namespace tomodem::plugin
