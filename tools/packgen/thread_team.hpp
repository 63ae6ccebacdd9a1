#pragma once
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace tomodem::packgen {

/// A few threads that wait between short pieces of work, so that thousands of steps need not start new ones.
class ThreadTeam {
 public:
    /// @param threads  at least 1; the calling thread is one of them
    explicit ThreadTeam(int threads);
    ~ThreadTeam();
    ThreadTeam(const ThreadTeam&) = delete;
    ThreadTeam& operator=(const ThreadTeam&) = delete;

    /// Calls work(0) ... work(count - 1), each once, in any order and on any thread; returns when all are done.
    ///
    /// Each thread starts with its own part of the range, so its data stay in its cache, then helps the others.
    /// `work` must write only what belongs to its index (results then do not depend on the threads) and must not throw.
    void for_each(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
    struct alignas(64) Share {
        std::atomic<std::size_t> next{0};
        std::size_t end = 0;
    };
    void take_part(std::size_t first_share);
    void wait_for_work(std::size_t index);

    std::vector<Share> shares_;
    std::vector<std::thread> workers_;
    const std::function<void(std::size_t)>* work_ = nullptr;
    std::atomic<unsigned> round_{0};
    std::atomic<std::size_t> busy_{0};
    bool stopping_ = false;
};

}  // namespace tomodem::packgen
