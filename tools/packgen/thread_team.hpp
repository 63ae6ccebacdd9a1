#pragma once
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

namespace tomodem::packgen {

/// Threads for thousands of short loops over the same range. One arena of TBB for all of them: parallel_for of
/// core/base enters a new one at each call, which takes as long as a loop over a few thousand particles.
class ThreadTeam {
 public:
    /// @param threads  at least 1; the calling thread is one of them
    explicit ThreadTeam(int threads) : threads_(std::max(threads, 1)), arena_(threads_) {}

    /// Calls work(0) ... work(count - 1), each once, in any order and on any thread; returns when all are done.
    ///
    /// Each thread starts with the part of the range that it had in the loop before, so its data stay in its cache,
    /// then helps the others. `work` must write only what belongs to its index: results then do not depend on the
    /// threads.
    template <class Work>
    void for_each(std::size_t count, const Work& work) {
        if (threads_ == 1 || count < 2) {
            for (std::size_t index = 0; index < count; ++index) work(index);
            return;
        }
        arena_.execute([&] { tbb::parallel_for(std::size_t{0}, count, work, partitioner_); });
    }

 private:
    int threads_;
    tbb::task_arena arena_;
    tbb::affinity_partitioner partitioner_;
};

}  // namespace tomodem::packgen
