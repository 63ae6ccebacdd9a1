#pragma once
#include <immintrin.h>

/// Compiled for AVX2 whatever the build's target; run only where VectorPairs::supported() says so.
#define TOMODEM_AVX2 __attribute__((target("avx2,fma")))

namespace tomodem::plugin {

/// {sum(a), sum(b), sum(c), sum(d)}
TOMODEM_AVX2 inline __m256d sums(__m256d a, __m256d b, __m256d c, __m256d d) {
    const __m256d ab = _mm256_hadd_pd(a, b);
    const __m256d cd = _mm256_hadd_pd(c, d);
    return _mm256_add_pd(_mm256_permute2f128_pd(ab, cd, 0x21), _mm256_blend_pd(ab, cd, 0b1100));
}

/// One bit a lane to a mask of lanes.
TOMODEM_AVX2 inline __m256d lane_mask(unsigned bits) {
    const __m256i bit = _mm256_set_epi64x(8, 4, 2, 1);
    const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(bits), bit);
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit));
}

}  // namespace tomodem::plugin
