#include "tools/packgen/contact_force.hpp"

#include <cmath>

namespace tomodem::packgen {

namespace {

using Lanes = double __attribute__((vector_size(32)));
using AliasedLanes = Lanes __attribute__((may_alias));
using Mask = std::int64_t __attribute__((vector_size(32)));

#define ALWAYS_INLINE inline __attribute__((always_inline))

// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer with two SSE2 additions (no fast-math here).
ALWAYS_INLINE Lanes nearest_image(Lanes difference, double edge, double per_edge) {
    constexpr double magic = 6755399441055744.0;
    return difference - edge * ((difference * per_edge + magic) - magic);
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

/// Edges of the box and their inverses, 0 along an axis with walls.
struct Periods {
    double edge[3], per_edge[3];
};

template <bool at_boundary, bool equal_radii>
ALWAYS_INLINE Force force_on(const Row* position, const Row& own, const std::int32_t* entry, const std::int32_t* end,
                             double diameter, const Periods& periods) {
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
            dx = nearest_image(dx, periods.edge[0], periods.per_edge[0]);
            dy = nearest_image(dy, periods.edge[1], periods.per_edge[1]);
            dz = nearest_image(dz, periods.edge[2], periods.per_edge[2]);
        }
        const Lanes squared = dx * dx + dy * dy + dz * dz;
        const Lanes distance = square_root(squared);
        Mask touches;
        Lanes scale;
        if constexpr (equal_radii) {
            touches = (squared < diameter_squared) & (squared > 0.0);
            scale = 1.0 / distance - inverse_diameter;
        } else {
            const Lanes reach = own.radius + __builtin_shufflevector(z_ab, z_cd, 2, 3, 6, 7);
            touches = (distance < reach * diameter) & (squared > 0.0);
            scale = reach / distance - inverse_diameter;
        }
        const Lanes factor = reinterpret_cast<Lanes>(reinterpret_cast<Mask>(scale) & touches);
        fx += factor * dx;
        fy += factor * dy;
        fz += factor * dz;
        load += factor * distance;
    }
    return {sum(fx), sum(fy), sum(fz), sum(load)};
}

/// Adds the push of the two walls of each axis that has them.
ALWAYS_INLINE void add_walls(const Row& own, double diameter, const Region& region, Force& f) {
    const double radius = region.equal_radii ? 0.5 : own.radius;
    const double at[3] = {own.x, own.y, own.z};
    double* const force[3] = {&f.x, &f.y, &f.z};
    for (int axis = 0; axis < 3; ++axis) {
        if (region.periodic[axis]) continue;
        const double low = radius - at[axis] / diameter, high = radius - (region.edges[axis] - at[axis]) / diameter;
        const double pushed_up = low > 0.0 ? low : 0.0, pushed_down = high > 0.0 ? high : 0.0;
        *force[axis] += pushed_up - pushed_down;
        f.load += pushed_up + pushed_down;
    }
}

template <bool equal_radii>
ALWAYS_INLINE ForceSums gather(const Row* position, const Row* velocity, Row* force, std::size_t first,
                               std::size_t count, const NeighbourBlocks& neighbours, double diameter,
                               const Region& region) {
    Periods periods;
    for (int axis = 0; axis < 3; ++axis) {
        periods.edge[axis] = region.edges[axis];
        periods.per_edge[axis] = region.periodic[axis] ? 1.0 / region.edges[axis] : 0.0;
    }
    const bool walls = region.has_walls();
    ForceSums sums;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = first + k;
        const std::int32_t* begin = neighbours.entries + 4 * std::size_t{neighbours.first_block[k]};
        const std::int32_t* end = neighbours.entries + 4 * std::size_t{neighbours.first_block[k + 1]};
        Force f = neighbours.at_boundary[k] != 0
                      ? force_on<true, equal_radii>(position, position[i], begin, end, diameter, periods)
                      : force_on<false, equal_radii>(position, position[i], begin, end, diameter, periods);
        if (walls) add_walls(position[i], diameter, region, f);
        force[i] = {f.x, f.y, f.z, 0.0};
        const Row& u = velocity[i];
        sums.force_velocity += f.x * u.x + f.y * u.y + f.z * u.z;
        sums.force_squared += f.x * f.x + f.y * f.y + f.z * f.z;
        sums.velocity_squared += u.x * u.x + u.y * u.y + u.z * u.z;
        sums.load += f.load;
    }
    return sums;
}

template <bool equal_radii>
__attribute__((target("avx2"))) ForceSums gather_avx2(const Row* position, const Row* velocity, Row* force,
                                                      std::size_t first, std::size_t count,
                                                      const NeighbourBlocks& neighbours, double diameter,
                                                      const Region& region) {
    return gather<equal_radii>(position, velocity, force, first, count, neighbours, diameter, region);
}

template <bool equal_radii>
ForceSums gather_baseline(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                          const NeighbourBlocks& neighbours, double diameter, const Region& region) {
    return gather<equal_radii>(position, velocity, force, first, count, neighbours, diameter, region);
}

bool has_avx2() {
    return __builtin_cpu_supports("avx2") != 0;
}

bool use_avx2 = has_avx2();

}  // namespace

ForceSums contact_forces(const Row* position, const Row* velocity, Row* force, std::size_t first, std::size_t count,
                         const NeighbourBlocks& neighbours, double diameter, const Region& region) {
    const auto version = region.equal_radii ? (use_avx2 ? gather_avx2<true> : gather_baseline<true>)
                                            : (use_avx2 ? gather_avx2<false> : gather_baseline<false>);
    return version(position, velocity, force, first, count, neighbours, diameter, region);
}

void use_instruction_set(InstructionSet choice) {
    use_avx2 = choice == InstructionSet::best && has_avx2();
}

}  // namespace tomodem::packgen
