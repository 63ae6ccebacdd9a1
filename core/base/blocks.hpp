#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/base/parallel.hpp"

namespace tomodem {

/// Particles that a thread takes at once. Sums over blocks, then over the blocks in order, do not depend on the
/// threads.
inline constexpr std::int64_t block_size = 1024;

inline std::size_t blocks_of(std::size_t count) {
    return (count + block_size - 1) / block_size;
}

/// Calls work(block, first, last) for blocks of 0 ... count - 1.
template <class Work>
void for_blocks(std::size_t count, int threads, const Work& work) {
    const auto total = static_cast<std::int64_t>(count);
    parallel_for(static_cast<std::int64_t>(blocks_of(count)), threads, [&](std::int64_t block) {
        work(static_cast<std::size_t>(block), static_cast<std::size_t>(block * block_size),
             static_cast<std::size_t>(std::min(total, (block + 1) * block_size)));
    });
}

}  // namespace tomodem
