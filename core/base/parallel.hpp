#pragma once
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>

namespace tomodem {

/// Calls body(i) for i = 0 .. count - 1 on up to `threads` threads, in any order.
///
/// If calls throw, the exception of the smallest i is thrown again at the end, so that the message does not depend on
/// the number of threads. (Later items may be left out then, earlier ones never.)
template <class Body>
void parallel_for(std::int64_t count, int threads, const Body& body) {
    std::mutex mutex;
    std::atomic<std::int64_t> first_failed{std::numeric_limits<std::int64_t>::max()};
    std::exception_ptr error;
    const auto work = [&](std::int64_t i) {
        if (i > first_failed) return;
        try {
            body(i);
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (i < first_failed) {
                first_failed = i;
                error = std::current_exception();
            }
        }
    };
    // TBB starts more threads than there are cores only where that is allowed, and prints a warning otherwise.
    std::optional<tbb::global_control> allowed;
    if (threads > tbb::info::default_concurrency())
        allowed.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(std::max(1, threads));
    arena.execute([&] { tbb::parallel_for(std::int64_t{0}, count, work); });
    if (error) std::rethrow_exception(error);
}

}  // namespace tomodem
