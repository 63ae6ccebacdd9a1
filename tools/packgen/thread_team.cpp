#include "tools/packgen/thread_team.hpp"

#include <algorithm>

namespace tomodem::packgen {

namespace {

// The next piece of work is usually some microseconds away, less than it takes to be woken up by the system.
template <class Changed>
bool changes_soon(Changed changed) {
    for (int tries = 0; tries < 500; ++tries) {
        if (changed()) return true;
        __builtin_ia32_pause();
    }
    return false;
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) : shares_(static_cast<std::size_t>(std::max(threads, 1))) {
    for (std::size_t index = 1; index < shares_.size(); ++index)
        workers_.emplace_back([this, index] { wait_for_work(index); });
}

ThreadTeam::~ThreadTeam() {
    stopping_ = true;
    round_.fetch_add(1);
    round_.notify_all();
    for (std::thread& worker : workers_) worker.join();
}

void ThreadTeam::for_each(std::size_t count, const std::function<void(std::size_t)>& work) {
    if (workers_.empty() || count < 2) {
        for (std::size_t index = 0; index < count; ++index) work(index);
        return;
    }
    for (std::size_t share = 0; share < shares_.size(); ++share) {
        shares_[share].next.store(count * share / shares_.size(), std::memory_order_relaxed);
        shares_[share].end = count * (share + 1) / shares_.size();
    }
    work_ = &work;
    busy_.store(workers_.size());
    round_.fetch_add(1);
    round_.notify_all();
    take_part(0);
    if (changes_soon([this] { return busy_.load() == 0; })) return;
    for (std::size_t busy = busy_.load(); busy != 0; busy = busy_.load()) busy_.wait(busy);
}

void ThreadTeam::take_part(std::size_t first_share) {
    for (std::size_t k = 0; k < shares_.size(); ++k) {
        Share& share = shares_[(first_share + k) % shares_.size()];
        for (std::size_t index = share.next.fetch_add(1); index < share.end; index = share.next.fetch_add(1))
            (*work_)(index);
    }
}

void ThreadTeam::wait_for_work(std::size_t index) {
    for (unsigned seen = 0;;) {
        if (!changes_soon([&] { return round_.load() != seen; })) round_.wait(seen);
        ++seen;
        if (stopping_) return;
        take_part(index);
        if (busy_.fetch_sub(1) == 1) busy_.notify_one();
    }
}

}  // namespace tomodem::packgen
