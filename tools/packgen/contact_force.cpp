#include "tools/packgen/contact_force.hpp"

#include <cmath>

namespace tomodem::packgen {

namespace {

using Lanes = double __attribute__((vector_size(32)));
using AliasedLanes = Lanes __attribute__((may_alias));
using Mask = std::int64_t __attribute__((vector_size(32)));

#define ALWAYS_INLINE inline __attribute__((always_inline))

// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer with two SSE2 additions (no fast-math here).
ALWAYS_INLINE Lanes nearest_image(Lanes difference) {
    constexpr double magic = 6755399441055744.0;
    return difference - ((difference + magic) - magic);
}

ALWAYS_INLINE Lanes square_root(Lanes a) {
    return Lanes{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
}

ALWAYS_INLINE double sum(Lanes a) {
    return (a[0] + a[1]) + (a[2] + a[3]);
}

struct Force {
    double x, y, z, load;
};

template <bool at_boundary>
ALWAYS_INLINE Force force_on(const Row* position, const Row& own, const std::int32_t* entry, const std::int32_t* end,
                             double diameter) {
    const double inverse_diameter = 1.0 / diameter;
    const double diameter_squared = diameter * diameter;
    Lanes fx{}, fy{}, fz{}, load{};
    for (; entry != end; entry += 4) {
        const Lanes a = *reinterpret_cast<const AliasedLanes*>(position + entry[0]);
        const Lanes b = *reinterpret_cast<const AliasedLanes*>(position + entry[1]);
        const Lanes c = *reinterpret_cast<const AliasedLanes*>(position + entry[2]);
        const Lanes d = *reinterpret_cast<const AliasedLanes*>(position + entry[3]);
        const Lanes xy_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
        const Lanes xy_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
        const Lanes z_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
        const Lanes z_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
        Lanes dx = own.x - __builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5);
        Lanes dy = own.y - __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7);
        Lanes dz = own.z - __builtin_shufflevector(z_ab, z_cd, 0, 1, 4, 5);
        if constexpr (at_boundary) {
            dx = nearest_image(dx);
            dy = nearest_image(dy);
            dz = nearest_image(dz);
        }
        const Lanes squared = dx * dx + dy * dy + dz * dz;
        const Mask touches = (squared < diameter_squared) & (squared > 0.0);
        const Lanes distance = square_root(squared);
        const Lanes scale = 1.0 / distance - inverse_diameter;
        const Lanes factor = reinterpret_cast<Lanes>(reinterpret_cast<Mask>(scale) & touches);
        fx += factor * dx;
        fy += factor * dy;
        fz += factor * dz;
        load += factor * distance;
    }
    return {sum(fx), sum(fy), sum(fz), sum(load)};
}

ALWAYS_INLINE ForceSums gather(const Row* position, const Row* velocity, Row* force, std::size_t first,
                               std::size_t count, const NeighbourBlocks& neighbours, double diameter) {
    ForceSums sums;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = first + k;
        const std::int32_t* begin = neighbours.entries + 4 * std::size_t{neighbours.first_block[k]};
        const std::int32_t* end = neighbours.entries + 4 * std::size_t{neighbours.first_block[k + 1]};
        const Force f = neighbours.at_boundary[k] != 0 ? force_on<true>(position, position[i], begin, end, diameter)
                                                       : force_on<false>(position, position[i], begin, end, diameter);
        force[i] = {f.x, f.y, f.z, 0.0};
        const Row& u = velocity[i];
        sums.force_velocity += f.x * u.x + f.y * u.y + f.z * u.z;
        sums.force_squared += f.x * f.x + f.y * f.y + f.z * f.z;
        sums.velocity_squared += u.x * u.x + u.y * u.y + u.z * u.z;
        sums.load += f.load;
    }
    return sums;
}

__attribute__((target("avx2"))) ForceSums gather_avx2(const Row* position, const Row* velocity, Row* force,
                                                      std::size_t first, std::size_t count,
                                                      const NeighbourBlocks& neighbours, double diameter) {
    return gather(position, velocity, force, first, count, neighbours, diameter);
}

ForceSums gather_baseline(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                          const NeighbourBlocks& neighbours, double diameter) {
    return gather(position, velocity, force, first, count, neighbours, diameter);
}

auto* version = __builtin_cpu_supports("avx2") ? gather_avx2 : gather_baseline;

}  // namespace

ForceSums contact_forces(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                         const NeighbourBlocks& neighbours, double diameter) {
    return version(position, velocity, force, first, count, neighbours, diameter);
}

void use_instruction_set(InstructionSet choice) {
    version = choice == InstructionSet::best && __builtin_cpu_supports("avx2") ? gather_avx2 : gather_baseline;
}

}  // namespace tomodem::packgen
