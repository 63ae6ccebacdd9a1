#include "solver_plugin/vector_pairs.hpp"

#include <immintrin.h>

#include <algorithm>
#include <cmath>

// Compiled for AVX2 whatever the build's target; run only where VectorPairs::supported() says so.
#define TOMODEM_AVX2 __attribute__((target("avx2,fma")))

namespace tomodem::plugin {
namespace {

/// Blocks between a prefetch and its use: about one memory latency.
constexpr std::size_t prefetch_distance = 24;

/// {sum(a), sum(b), sum(c), sum(d)}
TOMODEM_AVX2 inline __m256d sums(__m256d a, __m256d b, __m256d c, __m256d d) {
    const __m256d ab = _mm256_hadd_pd(a, b);
    const __m256d cd = _mm256_hadd_pd(c, d);
    return _mm256_add_pd(_mm256_permute2f128_pd(ab, cd, 0x21), _mm256_blend_pd(ab, cd, 0b1100));
}

}  // namespace

bool VectorPairs::supported() {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

void VectorPairs::set_laws(std::vector<law::Bilin> laws, int type_count, double inner_skin) {
    type_count_ = type_count;
    inner_skin_ = inner_skin;
    constants_.clear();
    reach_squared_.clear();
    for (const law::Bilin& law : laws) {
        constants_.push_back({law.seed_distance, law.crown_distance * law.crown_distance, law.repulsive_stiffness,
                              law.attractive_stiffness});
        reach_squared_.push_back(std::pow(law.crown_distance + inner_skin, 2));
    }
}

double VectorPairs::copy_particles(const ParticleView& particles) {
    double farthest = 0;
    for (int i = 0; i < particles.count; ++i) {
        Row& row = rows_[i];
        double moved = 0;
        for (int c = 0; c < 3; ++c) {
            row.position[c] = particles.position[3 * i + c];
            row.velocity[c] = particles.velocity[3 * i + c];
            const double step = row.position[c] - pruned_at_[3 * i + c];
            moved += step * step;
        }
        farthest = std::max(farthest, moved);
    }
    return farthest;
}

void VectorPairs::prune(const ParticleView& particles, const NeighbourView& list) {
    ++prunings_;
    block_count_ = 0;
    for (int r = 0; r < list.row_count; ++r) {
        const int i = list.rows[r];
        const int length = list.lengths[i];
        if (scratch_.size() < static_cast<std::size_t>(length) + 4) scratch_.resize(length + 4);
        const double* const at = rows_[i].position;
        for (int type = 1; type <= type_count_; ++type) {
            const int law = (particles.type[i] - 1) * type_count_ + type - 1;
            const double reach_squared = reach_squared_[law];
            int kept = 0;
            for (int k = 0; k < length; ++k) {
                const int j = list.neighbours[i][k] & list.index_mask;
                const double* const there = rows_[j].position;
                const double dx = at[0] - there[0], dy = at[1] - there[1], dz = at[2] - there[2];
                scratch_[kept] = j;
                kept += (dx * dx + dy * dy + dz * dz < reach_squared) & (particles.type[j] == type);
            }
            while (kept % 4 != 0) scratch_[kept++] = i;
            if (blocks_.size() < block_count_ + kept / 4 + prefetch_distance)
                blocks_.resize(blocks_.size() * 5 / 4 + kept + prefetch_distance);
            for (int k = 0; k < kept; k += 4)
                blocks_[block_count_++] = {i, law, {scratch_[k], scratch_[k + 1], scratch_[k + 2], scratch_[k + 3]}};
        }
    }
    std::fill_n(blocks_.begin() + static_cast<std::ptrdiff_t>(block_count_), prefetch_distance, Block{});
    std::copy_n(particles.position, 3 * static_cast<std::size_t>(particles.count), pruned_at_.begin());
}

template <bool one_law>
TOMODEM_AVX2 void VectorPairs::compute() {
    const __m256d one = _mm256_set1_pd(1), zero = _mm256_setzero_pd();
    const __m256d least_squared = _mm256_set1_pd(1e-30);  // keeps the filling pairs finite
    __m256d seed, crown_squared, repulsive, attractive;
    const auto use = [&](const PairConstants& constants) TOMODEM_AVX2 {
        seed = _mm256_set1_pd(constants.seed_distance);
        crown_squared = _mm256_set1_pd(constants.crown_squared);
        repulsive = _mm256_set1_pd(constants.repulsive_stiffness);
        attractive = _mm256_set1_pd(constants.attractive_stiffness);
    };
    use(constants_[0]);
    const Row* const rows = rows_.data();
    Force* const forces = forces_.data();
    const Block* const end = blocks_.data() + block_count_;
    for (const Block* block = blocks_.data(); block < end; ++block) {
        for (int k = 0; k < 4; ++k) {
            const std::int32_t later = block[prefetch_distance].neighbour[k];
            _mm_prefetch(reinterpret_cast<const char*>(rows + later), _MM_HINT_T0);
            _mm_prefetch(reinterpret_cast<const char*>(forces + later), _MM_HINT_T0);
        }
        if constexpr (!one_law) use(constants_[block->law]);
        const __m256d here = _mm256_load_pd(rows[block->particle].position);
        const __m256d moving = _mm256_load_pd(rows[block->particle].velocity);
        __m256d apart[4], squares[4], approach[4];
        for (int k = 0; k < 4; ++k) {
            const Row& other = rows[block->neighbour[k]];
            apart[k] = _mm256_sub_pd(here, _mm256_load_pd(other.position));
            squares[k] = _mm256_mul_pd(apart[k], apart[k]);
            approach[k] = _mm256_mul_pd(apart[k], _mm256_sub_pd(moving, _mm256_load_pd(other.velocity)));
        }
        const __m256d squared = _mm256_max_pd(sums(squares[0], squares[1], squares[2], squares[3]), least_squared);
        const __m256d rate = sums(approach[0], approach[1], approach[2], approach[3]);  // times the distance
        const __m256d inverse = _mm256_div_pd(one, _mm256_sqrt_pd(squared));
        // force / distance = stiffness (2 r_s / h - 1): repulsive above 0, attractive below
        const __m256d closeness = _mm256_fmsub_pd(seed, inverse, one);
        const __m256d pulls =
            _mm256_and_pd(_mm256_cmp_pd(rate, zero, _CMP_GT_OQ), _mm256_cmp_pd(squared, crown_squared, _CMP_LE_OQ));
        const __m256d attraction = _mm256_and_pd(pulls, _mm256_mul_pd(attractive, closeness));
        const __m256d over_distance = _mm256_blendv_pd(_mm256_mul_pd(repulsive, closeness), attraction, closeness);
        alignas(32) double each[4];
        _mm256_store_pd(each, over_distance);
        __m256d total = zero;
        for (int k = 0; k < 4; ++k) {
            const __m256d force = _mm256_mul_pd(_mm256_broadcast_sd(&each[k]), apart[k]);
            total = _mm256_add_pd(total, force);
            double* const reaction = forces[block->neighbour[k]].component;
            _mm256_store_pd(reaction, _mm256_sub_pd(_mm256_load_pd(reaction), force));
        }
        double* const action = forces[block->particle].component;
        _mm256_store_pd(action, _mm256_add_pd(_mm256_load_pd(action), total));
    }
}

void VectorPairs::add_forces(const ParticleView& particles, const NeighbourView& list, bool rebuilt, double* forces) {
    const auto count = static_cast<std::size_t>(particles.count);
    if (rows_.size() < count) {
        rows_.resize(count, Row{});
        forces_.resize(count, Force{});
        pruned_at_.resize(3 * count);
    }
    const double farthest = copy_particles(particles);
    if (rebuilt || farthest > 0.25 * inner_skin_ * inner_skin_) prune(particles, list);
    if (constants_.size() == 1)
        compute<true>();
    else
        compute<false>();
    for (int i = 0; i < particles.count; ++i) {
        if (i < particles.local_count)
            for (int c = 0; c < 3; ++c) forces[3 * i + c] += forces_[i].component[c];
        forces_[i] = {};
    }
}

}  // namespace tomodem::plugin
