#include "solver_plugin/pairs/norton_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "core/law/norton_state.hpp"
#include "solver_plugin/pairs/avx2.hpp"
#include "solver_plugin/pairs/contact_change.hpp"

namespace tomodem::plugin {
namespace {

using C = law::NortonConstants;
using Row = PackedParticles::Row;

constexpr int lanes = PairBlock::lanes;

/// Blocks between a prefetch and its use; a particle's sums and state are three cache lines each.
constexpr std::size_t prefetch_distance = 8;

/// Least square of a distance, in seeds: keeps the filling pairs finite.
constexpr double min_squared = 1e-20;

/// {b, c, a, d} of {a, b, c, d}
TOMODEM_AVX2 inline __m256d turned(__m256d vector) {
    return _mm256_permute4x64_pd(vector, _MM_SHUFFLE(3, 0, 2, 1));
}

TOMODEM_AVX2 inline void add_to(double* numbers, __m256d vector) {
    _mm256_store_pd(numbers, _mm256_add_pd(_mm256_load_pd(numbers), vector));
}

/// All ones where the pair is one of two objects' or an interface.
TOMODEM_AVX2 inline __m256d apart_for_good(const PairBlock& block) {
    return lane_mask(block.law != 0 ? PairBlock::all_lanes : block.interface);
}

/// The geometry of a block: from each neighbour to its particle.
struct Four {
    __m256d apart[lanes], speed[lanes], squared;

    TOMODEM_AVX2 Four(const PairBlock& block, const Row* rows, double diameter) {
        const __m256d here = _mm256_load_pd(rows[block.particle].position);
        const __m256d moving = _mm256_load_pd(rows[block.particle].velocity);
        __m256d squares[lanes];
        for (int k = 0; k < lanes; ++k) {
            const Row& other = rows[block.neighbour[k]];
            apart[k] = _mm256_sub_pd(here, _mm256_load_pd(other.position));
            speed[k] = _mm256_sub_pd(moving, _mm256_load_pd(other.velocity));
            squares[k] = _mm256_mul_pd(apart[k], apart[k]);
        }
        squared = _mm256_max_pd(sums(squares[0], squares[1], squares[2], squares[3]),
                                _mm256_set1_pd(min_squared * diameter * diameter));
    }

    /// Pairs in the crown; not those that fill the block up.
    TOMODEM_AVX2 __m256d inside(double reach, double diameter) const {
        const __m256d real = _mm256_cmp_pd(squared, _mm256_set1_pd(2 * min_squared * diameter * diameter), _CMP_GT_OQ);
        return _mm256_and_pd(real, _mm256_cmp_pd(squared, _mm256_set1_pd(reach * reach), _CMP_LE_OQ));
    }
};

}  // namespace

void NortonPairs::set_law(const law::Norton& law, double list_skin) {
    law_ = law;
    packed_.set_inner_skin(list_skin * (C::crown * law.seed_diameter));
}

bool NortonPairs::bonded(const ParticleView& particles, int i, int j, const ContactMemory* memory) const {
    return particles.same_object(i, j) && (memory == nullptr || !memory->is_interface(i, particles.id[j]));
}

void NortonPairs::update_contacts(const ParticleView& particles, const PairStep& step, bool fresh,
                                  ContactMemory& memory) {
    const Row* const rows = packed_.rows();
    const double reach = C::crown * law_.seed_diameter;
    const double back = step.set_up ? 0.0 : step.time_step;
    for (PairBlock& block : packed_.list()) {
        const Row& here = rows[block.particle];
        unsigned now = 0, before = 0;
        double apart[lanes][3];
        for (int k = 0; k < lanes; ++k) {
            const Row& there = rows[block.neighbour[k]];
            double squared = 0, squared_before = 0;
            for (int c = 0; c < 3; ++c) {
                apart[k][c] = here.position[c] - there.position[c];
                // Where the pair was one step ago follows from the velocities.
                const double past = apart[k][c] - back * (here.velocity[c] - there.velocity[c]);
                squared += apart[k][c] * apart[k][c];
                squared_before += past * past;
            }
            now |= static_cast<unsigned>(squared <= reach * reach) << k;
            before |= static_cast<unsigned>(squared_before <= reach * reach) << k;
        }
        if (fresh) block.inside = static_cast<std::uint8_t>(before);
        // Pairs of two objects never hold together: there is nothing to decide.
        const unsigned formed = block.law == 0 ? now & ~block.inside : 0U, left = block.interface & ~now;
        if ((formed | left) != 0) change_contacts(block, formed, left, rows, particles, step, memory);
        block.inside = static_cast<std::uint8_t>(now);
        if (block.law != 0) continue;
        for (int k = 0; k < lanes; ++k) {
            if ((now & ~block.interface & (1U << k)) == 0) continue;
            for (int c = 0; c < 3; ++c) {
                memory.next_outward()[block.particle][c] += apart[k][c];
                memory.next_outward()[block.neighbour[k]][c] -= apart[k][c];
            }
        }
    }
}

TOMODEM_AVX2 void NortonPairs::add_sums() {
    const double d = law_.seed_diameter, reach = C::crown * d;
    const __m256d one = _mm256_set1_pd(1), over_reach = _mm256_set1_pd(1 / reach);
    const __m256d fourth = _mm256_castsi256_pd(_mm256_set_epi64x(-1, 0, 0, 0));
    const Row* const rows = packed_.rows();
    Sums* const all = sums_.data();
    const PairBlock* const end = packed_.list().end();
    for (const PairBlock* block = packed_.list().begin(); block < end;) {
        const std::int32_t i = block->particle;
        __m256d moment[3] = {}, diagonal = {}, off = {}, outward = {};
        for (; block < end && block->particle == i; ++block) {
            for (int k = 0; k < lanes; ++k) {
                const auto* const later = reinterpret_cast<const char*>(all + block[prefetch_distance].neighbour[k]);
                _mm_prefetch(later, _MM_HINT_T0);
                _mm_prefetch(later + 64, _MM_HINT_T0);
                _mm_prefetch(later + 128, _MM_HINT_T0);
                _mm_prefetch(reinterpret_cast<const char*>(rows + block[prefetch_distance].neighbour[k]), _MM_HINT_T0);
            }
            const Four four(*block, rows, d);
            const __m256d inside = four.inside(reach, d);
            const __m256d distance = _mm256_sqrt_pd(four.squared);
            const __m256d closeness = _mm256_fnmadd_pd(distance, over_reach, one);
            const __m256d weight = _mm256_and_pd(inside, _mm256_mul_pd(closeness, closeness));
            alignas(32) double weights[lanes], over_distance[lanes], bonds[lanes];
            _mm256_store_pd(weights, weight);
            _mm256_store_pd(over_distance, _mm256_div_pd(weight, distance));
            _mm256_store_pd(bonds, _mm256_and_pd(_mm256_andnot_pd(apart_for_good(*block), inside), one));
            for (int k = 0; k < lanes; ++k) {
                const __m256d arm = _mm256_mul_pd(_mm256_broadcast_sd(&bonds[k]), four.apart[k]);
                const __m256d rows_of_moment[3] = {_mm256_mul_pd(arm, _mm256_permute4x64_pd(four.speed[k], 0x00)),
                                                   _mm256_mul_pd(arm, _mm256_permute4x64_pd(four.speed[k], 0x55)),
                                                   _mm256_mul_pd(arm, _mm256_permute4x64_pd(four.speed[k], 0xAA))};
                const __m256d squares =
                    _mm256_fmadd_pd(arm, four.apart[k], _mm256_and_pd(fourth, _mm256_broadcast_sd(&weights[k])));
                const __m256d mixed = _mm256_mul_pd(arm, turned(four.apart[k]));
                const __m256d away = _mm256_mul_pd(_mm256_broadcast_sd(&over_distance[k]), four.apart[k]);
                law::NortonSums& theirs = all[block->neighbour[k]].of;
                for (int c = 0; c < 3; ++c) {
                    add_to(theirs.moment[c], rows_of_moment[c]);
                    moment[c] = _mm256_add_pd(moment[c], rows_of_moment[c]);
                }
                add_to(theirs.diagonal, squares);
                add_to(theirs.off, mixed);
                add_to(theirs.outward, _mm256_sub_pd(_mm256_setzero_pd(), away));
                diagonal = _mm256_add_pd(diagonal, squares);
                off = _mm256_add_pd(off, mixed);
                outward = _mm256_add_pd(outward, away);
            }
        }
        law::NortonSums& own = all[i].of;
        for (int c = 0; c < 3; ++c) add_to(own.moment[c], moment[c]);
        add_to(own.diagonal, diagonal);
        add_to(own.off, off);
        add_to(own.outward, outward);
    }
}

/// Rows of four to columns of four.
TOMODEM_AVX2 inline void transpose(__m256d& a, __m256d& b, __m256d& c, __m256d& d) {
    const __m256d ab_low = _mm256_unpacklo_pd(a, b), ab_high = _mm256_unpackhi_pd(a, b);
    const __m256d cd_low = _mm256_unpacklo_pd(c, d), cd_high = _mm256_unpackhi_pd(c, d);
    a = _mm256_permute2f128_pd(ab_low, cd_low, 0x20);
    b = _mm256_permute2f128_pd(ab_high, cd_high, 0x20);
    c = _mm256_permute2f128_pd(ab_low, cd_low, 0x31);
    d = _mm256_permute2f128_pd(ab_high, cd_high, 0x31);
}

/// base^exponent for a positive, normal base, to some 1e-15: by the logarithm and the exponential of base 2.
TOMODEM_AVX2 inline __m256d power(__m256d base, __m256d exponent) {
    // base = 2^n m with m from sqrt(1/2) to sqrt(2); ln m = 2 (t + t^3/3 + t^5/5 + ...), t = (m - 1) / (m + 1)
    const __m256i bits = _mm256_castpd_si256(base);
    const __m256i shifted = _mm256_sub_epi64(bits, _mm256_set1_epi64x(0x3FE6A09E667F3BCD));
    const __m256i high = _mm256_srli_epi64(_mm256_add_epi64(shifted, _mm256_set1_epi64x(0x4000000000000000)), 52);
    const __m256d magic = _mm256_set1_pd(0x1.8p52);
    const __m256d twos =
        _mm256_sub_pd(_mm256_sub_pd(_mm256_castsi256_pd(_mm256_add_epi64(high, _mm256_castpd_si256(magic))), magic),
                      _mm256_set1_pd(1024));
    const __m256i whole = _mm256_slli_epi64(_mm256_sub_epi64(high, _mm256_set1_epi64x(1024)), 52);
    const __m256d m = _mm256_castsi256_pd(_mm256_sub_epi64(bits, whole));
    const __m256d one = _mm256_set1_pd(1);
    const __m256d t = _mm256_div_pd(_mm256_sub_pd(m, one), _mm256_add_pd(m, one)), square = _mm256_mul_pd(t, t);
    __m256d series = _mm256_set1_pd(1.0 / 21);
    for (int odd = 19; odd > 0; odd -= 2) series = _mm256_fmadd_pd(series, square, _mm256_set1_pd(1.0 / odd));
    const __m256d log2 = _mm256_fmadd_pd(_mm256_mul_pd(t, series), _mm256_set1_pd(2 / 0x1.62e42fefa39efp-1), twos);
    // 2^y = 2^n e^(f ln 2), n the whole number nearest to y
    const __m256d y = _mm256_mul_pd(exponent, log2), sum = _mm256_add_pd(y, magic);
    const __m256d f = _mm256_mul_pd(_mm256_sub_pd(y, _mm256_sub_pd(sum, magic)), _mm256_set1_pd(0x1.62e42fefa39efp-1));
    __m256d exponential = one;
    for (int k = 13; k > 0; --k)
        exponential = _mm256_fmadd_pd(_mm256_mul_pd(exponential, f), _mm256_set1_pd(1.0 / k), one);
    return _mm256_castsi256_pd(
        _mm256_add_epi64(_mm256_castpd_si256(exponential), _mm256_slli_epi64(_mm256_castpd_si256(sum), 52)));
}

/// Four numbers as norton_state() takes them: __m256d has an attribute that template arguments lose.
typedef double Lanes __attribute__((vector_size(32)));

struct Raise {
    TOMODEM_AVX2 void operator()(Lanes& base, const Lanes& exponent) const { base = power(base, exponent); }
};
struct Root {
    TOMODEM_AVX2 void operator()(Lanes& square) const { square = _mm256_sqrt_pd(square); }
};

TOMODEM_AVX2 void NortonPairs::find_states(const ParticleView& particles) {
    for (int first = 0; first < particles.local_count; first += lanes) {
        law::NortonMaterialOf<Lanes> material;
        double consistency[lanes], sensitivity[lanes], strength[lanes];
        for (int k = 0; k < lanes; ++k) {
            const int i = std::min(first + k, particles.local_count - 1);
            const law::NortonMaterial& own = law_.materials[particles.type[i] - 1];
            consistency[k] = own.consistency;
            sensitivity[k] = own.rate_sensitivity;
            strength[k] = own.strength;
        }
        material.consistency = _mm256_loadu_pd(consistency);
        material.rate_sensitivity = _mm256_loadu_pd(sensitivity);
        material.strength = _mm256_loadu_pd(strength);

        law::NortonSumsOf<Lanes> sums;
        const auto load = [&](const double* numbers, Lanes& to_a, Lanes& to_b, Lanes& to_c, Lanes& to_d) TOMODEM_AVX2 {
            constexpr std::size_t stride = sizeof(Sums) / sizeof(double);
            __m256d a = _mm256_load_pd(numbers);
            __m256d b = _mm256_load_pd(numbers + stride);
            __m256d c = _mm256_load_pd(numbers + 2 * stride);
            __m256d d = _mm256_load_pd(numbers + 3 * stride);
            transpose(a, b, c, d);
            to_a = a;
            to_b = b;
            to_c = c;
            to_d = d;
        };
        const law::NortonSums& from = sums_[first].of;
        Lanes unused;
        for (int c = 0; c < 3; ++c)
            load(from.moment[c], sums.moment[c][0], sums.moment[c][1], sums.moment[c][2], unused);
        load(from.diagonal, sums.diagonal[0], sums.diagonal[1], sums.diagonal[2], sums.density);
        load(from.off, sums.off[0], sums.off[1], sums.off[2], unused);
        load(from.outward, sums.outward[0], sums.outward[1], sums.outward[2], unused);

        law::NortonStateOf<Lanes> found;
        law::norton_state(law_, material, sums, Raise(), Root(), found);

        law::NortonState& to = states_[first].of;
        const auto store = [&](double* numbers, __m256d a, __m256d b, __m256d c, __m256d d) TOMODEM_AVX2 {
            constexpr std::size_t stride = sizeof(State) / sizeof(double);
            transpose(a, b, c, d);
            _mm256_store_pd(numbers, a);
            _mm256_store_pd(numbers + stride, b);
            _mm256_store_pd(numbers + 2 * stride, c);
            _mm256_store_pd(numbers + 3 * stride, d);
        };
        const __m256d zero = _mm256_setzero_pd();
        store(to.traction[0], found.traction[0][0], found.traction[0][1], found.traction[0][2], found.pressure);
        store(to.traction[1], found.traction[1][0], found.traction[1][1], found.traction[1][2], found.viscosity);
        store(to.traction[2], found.traction[2][0], found.traction[2][1], found.traction[2][2], material.strength);
        store(to.diagonal, found.diagonal[0], found.diagonal[1], found.diagonal[2], zero);
        store(to.off, found.off[0], found.off[1], found.off[2], zero);
        store(to.lateral, found.lateral[0], found.lateral[1], found.lateral[2], zero);
    }
    std::fill_n(sums_.begin(), particles.count, Sums{});
}

TOMODEM_AVX2 void NortonPairs::compute() {
    const double d = law_.seed_diameter, reach = C::crown * d;
    const __m256d one = _mm256_set1_pd(1), two = _mm256_set1_pd(2), zero = _mm256_setzero_pd();
    const __m256d half = _mm256_set1_pd(0.5), over_reach = _mm256_set1_pd(1 / reach);
    const __m256d core = _mm256_set1_pd(C::core * d), core_stiffness = _mm256_set1_pd(0.5 * C::core_stiffness * d);
    const __m256d share = _mm256_set1_pd(2 * C::pair_share * d), minus_reach = _mm256_set1_pd(-reach);
    const Row* const rows = packed_.rows();
    const State* const states = states_.data();
    PackedParticles::Force* const forces = packed_.forces();
    const PairBlock* const end = packed_.list().end();
    for (const PairBlock* block = packed_.list().begin(); block < end; ++block) {
        for (int k = 0; k < lanes; ++k) {
            const std::int32_t later = block[prefetch_distance].neighbour[k];
            const auto* const state = reinterpret_cast<const char*>(states + later);
            _mm_prefetch(state, _MM_HINT_T0);
            _mm_prefetch(state + 64, _MM_HINT_T0);
            _mm_prefetch(state + 128, _MM_HINT_T0);
            _mm_prefetch(reinterpret_cast<const char*>(rows + later), _MM_HINT_T0);
            _mm_prefetch(reinterpret_cast<const char*>(forces + later), _MM_HINT_T0);
        }
        const Four four(*block, rows, d);
        const law::NortonState& own = states[block->particle].of;
        const law::NortonState* const theirs[lanes] = {&states[block->neighbour[0]].of, &states[block->neighbour[1]].of,
                                                       &states[block->neighbour[2]].of,
                                                       &states[block->neighbour[3]].of};
        const __m256d own_diagonal = _mm256_load_pd(own.diagonal), own_off = _mm256_load_pd(own.off);
        const __m256d own_lateral = _mm256_load_pd(own.lateral);
        __m256d separations[lanes], flows[lanes], projections[lanes], lateral[lanes];
        for (int k = 0; k < lanes; ++k) {
            separations[k] = _mm256_mul_pd(four.apart[k], four.speed[k]);
            const __m256d diagonal = _mm256_add_pd(own_diagonal, _mm256_load_pd(theirs[k]->diagonal));
            const __m256d off = _mm256_add_pd(own_off, _mm256_load_pd(theirs[k]->off));
            flows[k] = _mm256_mul_pd(
                four.apart[k], _mm256_fmadd_pd(diagonal, four.apart[k], _mm256_mul_pd(off, turned(four.apart[k]))));
            lateral[k] = _mm256_sub_pd(own_lateral, _mm256_load_pd(theirs[k]->lateral));
            projections[k] = _mm256_mul_pd(lateral[k], four.apart[k]);
        }
        const __m256d inside = four.inside(reach, d);
        const __m256d distance = _mm256_sqrt_pd(four.squared), over = _mm256_div_pd(one, distance);
        const __m256d separation =
            _mm256_mul_pd(over, sums(separations[0], separations[1], separations[2], separations[3]));
        const __m256d mean_flow =
            _mm256_mul_pd(_mm256_mul_pd(half, over), sums(flows[0], flows[1], flows[2], flows[3]));
        const __m256d along = _mm256_mul_pd(over, sums(projections[0], projections[1], projections[2], projections[3]));
        const __m256d closeness = _mm256_max_pd(_mm256_fnmadd_pd(distance, over_reach, one), zero);
        const __m256d overlap = _mm256_max_pd(_mm256_sub_pd(core, distance), zero);
        const __m256d pressures =
            _mm256_setr_pd(theirs[0]->pressure(), theirs[1]->pressure(), theirs[2]->pressure(), theirs[3]->pressure());
        const __m256d strengths =
            _mm256_setr_pd(theirs[0]->strength(), theirs[1]->strength(), theirs[2]->strength(), theirs[3]->strength());
        const __m256d others = _mm256_setr_pd(theirs[0]->viscosity(), theirs[1]->viscosity(), theirs[2]->viscosity(),
                                              theirs[3]->viscosity());
        const __m256d viscosity = _mm256_set1_pd(own.viscosity());
        const __m256d pressure = _mm256_add_pd(_mm256_set1_pd(own.pressure()), pressures);
        const __m256d strength = _mm256_add_pd(_mm256_set1_pd(own.strength()), strengths);
        const __m256d central = _mm256_fmadd_pd(_mm256_mul_pd(core_stiffness, strength), overlap,
                                                _mm256_mul_pd(_mm256_mul_pd(two, closeness), pressure));
        const __m256d dashpot =
            _mm256_div_pd(_mm256_mul_pd(share, _mm256_mul_pd(viscosity, others)), _mm256_add_pd(viscosity, others));
        const __m256d bonded = _mm256_andnot_pd(apart_for_good(*block), inside);
        const __m256d across =
            _mm256_and_pd(bonded, _mm256_mul_pd(_mm256_mul_pd(minus_reach, over), _mm256_mul_pd(closeness, closeness)));
        __m256d radial = _mm256_fmadd_pd(_mm256_mul_pd(two, closeness), along, central);
        radial = _mm256_fnmadd_pd(dashpot, _mm256_sub_pd(separation, mean_flow), radial);
        radial = _mm256_fnmadd_pd(across, along, radial);
        radial = _mm256_blendv_pd(_mm256_and_pd(inside, _mm256_max_pd(central, zero)), radial, bonded);
        alignas(32) double radials[lanes], acrosses[lanes], bonds[lanes];
        _mm256_store_pd(radials, _mm256_mul_pd(radial, over));
        _mm256_store_pd(acrosses, across);
        _mm256_store_pd(bonds, _mm256_and_pd(bonded, one));
        __m256d total = zero;
        for (int k = 0; k < lanes; ++k) {
            const __m256d arm = _mm256_mul_pd(_mm256_broadcast_sd(&bonds[k]), four.apart[k]);
            __m256d force = _mm256_mul_pd(_mm256_broadcast_sd(&radials[k]), four.apart[k]);
            force = _mm256_fmadd_pd(_mm256_broadcast_sd(&acrosses[k]), lateral[k], force);
            const auto traction = [&](int column) TOMODEM_AVX2 {
                return _mm256_add_pd(_mm256_load_pd(own.traction[column]), _mm256_load_pd(theirs[k]->traction[column]));
            };
            force = _mm256_fnmadd_pd(traction(0), _mm256_permute4x64_pd(arm, 0x00), force);
            force = _mm256_fnmadd_pd(traction(1), _mm256_permute4x64_pd(arm, 0x55), force);
            force = _mm256_fnmadd_pd(traction(2), _mm256_permute4x64_pd(arm, 0xAA), force);
            total = _mm256_add_pd(total, force);
            double* const reaction = forces[block->neighbour[k]].component;
            _mm256_store_pd(reaction, _mm256_sub_pd(_mm256_load_pd(reaction), force));
        }
        add_to(forces[block->particle].component, total);
    }
}

void NortonPairs::pack(int i, double* numbers) const {
    const law::NortonState& state = states_[i].of;
    for (int column = 0; column < 3; ++column) {
        numbers = std::copy_n(state.traction[column], 4, numbers);
        *numbers++ = state.diagonal[column];
        *numbers++ = state.off[column];
        *numbers++ = state.lateral[column];
    }
}

void NortonPairs::unpack(int i, const double* numbers) {
    law::NortonState& state = states_[i].of;
    for (int column = 0; column < 3; ++column) {
        std::copy_n(numbers, 4, state.traction[column]);
        state.diagonal[column] = numbers[4];
        state.off[column] = numbers[5];
        state.lateral[column] = numbers[6];
        numbers += 7;
    }
}

void NortonPairs::add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step,
                             double* forces, ContactMemory* memory, const UsePair* use) {
    const bool fresh = packed_.follow(particles, C::crown * law_.seed_diameter, step.renumbered, memory);
    // States are found four at a time.
    if (const std::size_t room = static_cast<std::size_t>(particles.count) + lanes; sums_.size() < room) {
        sums_.resize(room);
        states_.resize(room);
    }
    if (memory != nullptr) update_contacts(particles, step, fresh, *memory);
    add_sums();
    find_states(particles);
    exchange();
    compute();
    packed_.give_forces(particles, forces);
    if (use != nullptr) pair_forces(particles, list, memory, *use);
}

void NortonPairs::pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                              const UsePair& use) const {
    const double reach = C::crown * law_.seed_diameter;
    for_each_pair(list, [&](int i, int j) {
        double apart[3], speed[3], squared = 0, force[3];
        for (int c = 0; c < 3; ++c) {
            apart[c] = particles.position[3 * i + c] - particles.position[3 * j + c];
            speed[c] = particles.velocity[3 * i + c] - particles.velocity[3 * j + c];
            squared += apart[c] * apart[c];
        }
        if (squared > reach * reach) return;
        law::norton_force(law_, state(i), state(j), apart, speed, bonded(particles, i, j, memory), force);
        use(i, j, force, apart);
    });
}

double NortonPairs::wall_force(const WallContact& contact) const {
    return law::norton_wall_force(law_, state(contact.particle).strength(), contact.distance, contact.rate,
                                  contact.other_force, contact.time_step_over_mass);
}

double NortonPairs::seed_energy(const ParticleView& particles, const NeighbourView& list) const {
    return spring_energy(particles, list, [&](int i, int j) {
        return std::pair(C::core * law_.seed_diameter,
                         C::core_stiffness * law_.seed_diameter * (state(i).strength() + state(j).strength()) / 2);
    });
}

}  // namespace tomodem::plugin
