#pragma once
#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace tomodem {

/// Calls body(i) for i = 0 .. count - 1 on up to `threads` threads, in any order.
///
/// If calls throw, the exception of the smallest i is thrown again when all threads have ended, so that the message
/// does not depend on the number of threads. (Later items may be left out then, earlier ones never.)
template <class Body>
void parallel_for(std::int64_t count, int threads, const Body& body) {
    std::atomic<std::int64_t> next{0};
    std::atomic<bool> failed{false};
    std::vector<std::pair<std::int64_t, std::exception_ptr>> errors(std::max(1, threads), {count, nullptr});
    const auto work = [&](int thread) {
        for (std::int64_t i; !failed && (i = next++) < count;) {
            try {
                body(i);
            } catch (...) {
                errors[thread] = {i, std::current_exception()};
                failed = true;
                return;
            }
        }
    };
    std::vector<std::thread> pool;
    for (int thread = 1; thread < threads && thread < count; ++thread) pool.emplace_back(work, thread);
    work(0);
    for (auto& thread : pool) thread.join();
    const auto first =
        std::min_element(errors.begin(), errors.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (first->second) std::rethrow_exception(first->second);
}

}  // namespace tomodem
