#include "solver_plugin/pairs/vector_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "solver_plugin/pairs/avx2.hpp"
#include "solver_plugin/pairs/contact_change.hpp"

namespace tomodem::plugin {
namespace {

/// Blocks between a prefetch and its use: about one memory latency.
constexpr std::size_t prefetch_distance = PairList::tail;

constexpr int lanes = PairBlock::lanes;

}  // namespace

bool VectorPairs::supported() {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

void VectorPairs::set_laws(const PairLaws& laws, double inner_skin) {
    type_count_ = laws.type_count;
    packed_.set_types(laws.type_count);
    packed_.set_inner_skin(inner_skin);
    dispersed_ = laws.dispersed;
    seed_to_crown_ = laws.seed_to_crown;
    constants_.clear();
    crown_.clear();
    bounded_ = false;
    for (const bool same_object : {true, false})
        for (const law::Pair& law : laws.of_types) {
            constants_.push_back({law.seed_distance, law.crown_distance * law.crown_distance, law.repulsive_stiffness,
                                  same_object ? law.attractive_stiffness : 0.0, -law.max_attraction, same_object});
            crown_.push_back(law.crown_distance);
            bounded_ = bounded_ || std::isfinite(law.max_attraction);
        }
}

template <unsigned features>
TOMODEM_AVX2 void VectorPairs::compute(const ParticleView& particles, const PairStep& step, bool fresh,
                                       ContactMemory* memory) {
    constexpr bool several_laws = features & 1, bounded = features & 2, dispersed = features & 4;
    constexpr bool remembers = features & 8;
    const __m256d one = _mm256_set1_pd(1), zero = _mm256_setzero_pd();
    const __m256d min_squared = _mm256_set1_pd(1e-30);  // keeps the filling pairs finite
    const __m256d seed_to_crown = _mm256_set1_pd(seed_to_crown_);
    __m256d seed, crown_squared, repulsive, attractive, min_force;
    bool same_object = true;
    const auto use = [&](const PairConstants& constants) TOMODEM_AVX2 {
        seed = _mm256_set1_pd(constants.seed_distance);
        crown_squared = _mm256_set1_pd(constants.crown_squared);
        repulsive = _mm256_set1_pd(constants.repulsive_stiffness);
        attractive = _mm256_set1_pd(constants.attractive_stiffness);
        min_force = _mm256_set1_pd(constants.min_force);
        same_object = constants.same_object;
    };
    use(constants_[0]);
    // The fourth component is a radius, which has no past. At the first step every pair was where it is.
    const double step_back = step.set_up ? 0.0 : step.time_step;
    const __m256d back = _mm256_setr_pd(step_back, step_back, step_back, 0);
    const Row* const rows = packed_.rows();
    PackedParticles::Force* const forces = packed_.forces();
    ContactMemory::Outward* const outward = remembers ? memory->next_outward().data() : nullptr;
    PairBlock* const end = packed_.list().end();
    for (PairBlock* block = packed_.list().begin(); block < end; ++block) {
        for (int k = 0; k < lanes; ++k) {
            const std::int32_t later = block[prefetch_distance].neighbour[k];
            _mm_prefetch(reinterpret_cast<const char*>(rows + later), _MM_HINT_T0);
            _mm_prefetch(reinterpret_cast<const char*>(forces + later), _MM_HINT_T0);
            if constexpr (remembers) _mm_prefetch(reinterpret_cast<const char*>(outward + later), _MM_HINT_T0);
        }
        if constexpr (several_laws) use(constants_[block->law]);
        const __m256d here = _mm256_load_pd(rows[block->particle].position);
        const __m256d moving = _mm256_load_pd(rows[block->particle].velocity);
        __m256d apart[lanes], squares[lanes], approach[lanes];
        for (int k = 0; k < lanes; ++k) {
            const Row& other = rows[block->neighbour[k]];
            apart[k] = _mm256_sub_pd(here, _mm256_load_pd(other.position));
            squares[k] = _mm256_mul_pd(apart[k], apart[k]);
            approach[k] = _mm256_mul_pd(apart[k], _mm256_sub_pd(moving, _mm256_load_pd(other.velocity)));
        }
        const __m256d squared = _mm256_max_pd(sums(squares[0], squares[1], squares[2], squares[3]), min_squared);
        const __m256d rate = sums(approach[0], approach[1], approach[2], approach[3]);  // times the distance
        if constexpr (dispersed) {
            const __m256d others =
                _mm256_setr_pd(rows[block->neighbour[0]].velocity[3], rows[block->neighbour[1]].velocity[3],
                               rows[block->neighbour[2]].velocity[3], rows[block->neighbour[3]].velocity[3]);
            const __m256d crown = _mm256_add_pd(_mm256_set1_pd(rows[block->particle].velocity[3]), others);
            crown_squared = _mm256_mul_pd(crown, crown);
            seed = _mm256_mul_pd(crown, seed_to_crown);
        }
        const __m256d inside = _mm256_cmp_pd(squared, crown_squared, _CMP_LE_OQ);
        __m256d internal = inside;
        if constexpr (remembers) {
            if (fresh) {
                // Where the pairs were one step ago follows from their velocities.
                for (int k = 0; k < lanes; ++k) {
                    const __m256d speed = _mm256_sub_pd(moving, _mm256_load_pd(rows[block->neighbour[k]].velocity));
                    const __m256d before = _mm256_fnmadd_pd(speed, back, apart[k]);
                    squares[k] = _mm256_mul_pd(before, before);
                }
                const __m256d before_squared = sums(squares[0], squares[1], squares[2], squares[3]);
                block->inside = static_cast<std::uint8_t>(
                    _mm256_movemask_pd(_mm256_cmp_pd(before_squared, crown_squared, _CMP_LE_OQ)));
            }
            const auto now = static_cast<unsigned>(_mm256_movemask_pd(inside));
            // Pairs of two objects never attract: there is nothing to decide.
            const unsigned formed = same_object ? now & ~block->inside : 0U, left = block->interface & ~now;
            if ((formed | left) != 0) [[unlikely]]
                change_contacts(*block, formed, left, packed_.rows(), particles, step, *memory);
            block->inside = static_cast<std::uint8_t>(now);
            if (block->interface != 0) internal = _mm256_andnot_pd(lane_mask(block->interface), inside);
        }
        const __m256d inverse = _mm256_div_pd(one, _mm256_sqrt_pd(squared));
        // force / distance = stiffness (2 r_s / h - 1): repulsive above 0, attractive below
        const __m256d closeness = _mm256_fmsub_pd(seed, inverse, one);
        const __m256d pulls = _mm256_and_pd(_mm256_cmp_pd(rate, zero, _CMP_GT_OQ), internal);
        __m256d attraction = _mm256_mul_pd(attractive, closeness);
        if constexpr (bounded) attraction = _mm256_max_pd(attraction, _mm256_mul_pd(min_force, inverse));
        attraction = _mm256_and_pd(pulls, attraction);
        const __m256d over_distance = _mm256_blendv_pd(_mm256_mul_pd(repulsive, closeness), attraction, closeness);
        alignas(32) double each[lanes];
        _mm256_store_pd(each, over_distance);
        __m256d total = zero;
        for (int k = 0; k < lanes; ++k) {
            const __m256d force = _mm256_mul_pd(_mm256_broadcast_sd(&each[k]), apart[k]);
            total = _mm256_add_pd(total, force);
            double* const reaction = forces[block->neighbour[k]].component;
            _mm256_store_pd(reaction, _mm256_sub_pd(_mm256_load_pd(reaction), force));
        }
        double* const action = forces[block->particle].component;
        _mm256_store_pd(action, _mm256_add_pd(_mm256_load_pd(action), total));
        if constexpr (remembers) {
            if (!same_object) continue;
            alignas(32) double counts[lanes];
            _mm256_store_pd(counts, _mm256_and_pd(internal, one));
            __m256d away = zero;
            for (int k = 0; k < lanes; ++k) {
                const __m256d line = _mm256_mul_pd(_mm256_broadcast_sd(&counts[k]), apart[k]);
                away = _mm256_add_pd(away, line);
                double* const theirs = outward[block->neighbour[k]].data();
                _mm256_storeu_pd(theirs, _mm256_sub_pd(_mm256_loadu_pd(theirs), line));
            }
            double* const own = outward[block->particle].data();
            _mm256_storeu_pd(own, _mm256_add_pd(_mm256_loadu_pd(own), away));
        }
    }
}

TOMODEM_AVX2 double VectorPairs::seed_energy(int local_count) const {
    const __m256d zero = _mm256_setzero_pd(), half = _mm256_set1_pd(0.5), one = _mm256_set1_pd(1);
    const __m128i first_ghost = _mm_set1_epi32(local_count);
    __m256d energy = zero;
    const Row* const rows = packed_.rows();
    for (const PairBlock& block : packed_.list()) {
        const __m256d here = _mm256_load_pd(rows[block.particle].position);
        __m256d squares[lanes];
        double seeds[lanes];
        for (int k = 0; k < lanes; ++k) {
            const Row& other = rows[block.neighbour[k]];
            const __m256d apart = _mm256_sub_pd(here, _mm256_load_pd(other.position));
            squares[k] = _mm256_mul_pd(apart, apart);
            const bool filling = block.neighbour[k] == block.particle;
            seeds[k] = filling ? 0.0 : seed_to_crown_ * (rows[block.particle].velocity[3] + other.velocity[3]);
        }
        const __m256d distance = _mm256_sqrt_pd(sums(squares[0], squares[1], squares[2], squares[3]));
        const __m256d overlap = _mm256_max_pd(_mm256_sub_pd(_mm256_loadu_pd(seeds), distance), zero);
        // A pair across a process boundary is seen from both sides.
        const __m128i local =
            _mm_cmplt_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(block.neighbour)), first_ghost);
        const __m256d share = _mm256_blendv_pd(half, one, _mm256_castsi256_pd(_mm256_cvtepi32_epi64(local)));
        const __m256d stiffness = _mm256_set1_pd(0.5 * constants_[block.law].repulsive_stiffness);
        energy = _mm256_fmadd_pd(_mm256_mul_pd(share, stiffness), _mm256_mul_pd(overlap, overlap), energy);
    }
    alignas(32) double each[lanes];
    _mm256_store_pd(each, energy);
    return each[0] + each[1] + each[2] + each[3];
}

void VectorPairs::add_forces(const ParticleView& particles, const PairStep& step, double* forces,
                             ContactMemory* memory) {
    double crown = *std::max_element(crown_.begin(), crown_.end());
    if (dispersed_) crown = 2 * *std::max_element(particles.radius, particles.radius + particles.count);
    const bool fresh = packed_.follow(particles, crown, step.renumbered, memory);
    const bool several_laws = type_count_ > 1 || packed_.list().by_object();
    const unsigned features = several_laws * 1U + bounded_ * 2U + dispersed_ * 4U + (memory != nullptr) * 8U;
    static constexpr auto loops = []<unsigned... each>(std::integer_sequence<unsigned, each...>) {
        return std::array{&VectorPairs::compute<each>...};
    }
    (std::make_integer_sequence<unsigned, 16>());
    (this->*loops[features])(particles, step, fresh, memory);
    packed_.give_forces(particles, forces);
}

}  // namespace tomodem::plugin
