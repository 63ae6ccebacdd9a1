#include "tools/packgen/compaction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "tools/packgen/contact_force.hpp"
#include "tools/packgen/neighbour_list.hpp"
#include "tools/packgen/thread_team.hpp"

namespace tomodem::packgen {

namespace {

// Unit set of this file: d = 1, k = 1, m = 1; d is the mean diameter. Positions are fractions of the shortest edge of
// the box, L, so that the affine part of the compaction is a growing diameter d / L, and velocities u are relative to
// it.

constexpr double skin = 0.15;          // of d
constexpr double shortest_box = 2.25;  // of the largest diameter: three crown radii

/// What is packed: radii over d (empty: all 1/2) and the box.
struct Content {
    std::vector<double> radius;
    double mean_cube = 1.0;         ///< of the radii over d / 2
    double largest_diameter = 1.0;  ///< over d
    Region region;

    /// The shortest edge.
    double edge_at(std::int64_t particles, double density) const {
        return std::cbrt(static_cast<double>(particles) * mean_cube * std::numbers::pi /
                         (6.0 * density * region.volume()));
    }
};

// Not std::uniform_real_distribution: its result is the library's choice.
double uniform(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Radii over their mean: normal deviates cut at three standard deviations, then shifted and stretched so that mean and
/// standard deviation are exactly those asked for. exp() only decides what is drawn, so its last bit, which depends on
/// the processor, shows in no radius.
std::vector<double> radius_factors(std::int64_t count, double dispersion, std::mt19937_64& random) {
    std::vector<double> factor;
    factor.reserve(static_cast<std::size_t>(count));
    while (static_cast<std::int64_t>(factor.size()) < count) {
        const double deviate = 6.0 * uniform(random) - 3.0;
        if (uniform(random) < std::exp(-0.5 * deviate * deviate)) factor.push_back(deviate);
    }
    double sum = 0.0, squares = 0.0;
    for (const double f : factor) sum += f;
    const double mean = sum / static_cast<double>(count);
    for (const double f : factor) squares += (f - mean) * (f - mean);
    const double stretch = dispersion / std::sqrt(squares / static_cast<double>(count));
    for (double& f : factor) f = 1.0 + stretch * (f - mean);
    return factor;
}

Content content_of(const Compaction& wanted) {
    Content content;
    const double shortest = *std::min_element(wanted.aspect.begin(), wanted.aspect.end());
    for (int axis = 0; axis < 3; ++axis) content.region.edges[axis] = wanted.aspect[axis] / shortest;
    content.region.periodic = wanted.periodic;
    if (wanted.dispersion == 0.0) return content;
    // A generator of its own: the same points, whatever the dispersion.
    std::mt19937_64 random(static_cast<std::uint64_t>(wanted.random_seed) ^ 0x9e3779b97f4a7c15ULL);
    content.radius = radius_factors(wanted.particles, wanted.dispersion, random);
    content.region.equal_radii = false;
    double cubes = 0.0;
    for (double& f : content.radius) {
        cubes += f * f * f;
        content.largest_diameter = std::max(content.largest_diameter, f);
        f *= 0.5;
    }
    content.mean_cube = cubes / static_cast<double>(wanted.particles);
    return content;
}

/// Spheres in a box of given edge, their list, and one step of their motion.
class Assembly {
 public:
    Assembly(const Content& content, std::int64_t particles, std::int64_t random_seed, double edge, int threads)
        : team_(threads),
          region_(content.region),
          largest_diameter_(content.largest_diameter),
          edge_(edge),
          position_(static_cast<std::size_t>(particles)) {
        std::mt19937_64 random(static_cast<std::uint64_t>(random_seed));
        for (Row& p : position_) {
            p.x = uniform(random) * region_.edges[0];
            p.y = uniform(random) * region_.edges[1];
            p.z = uniform(random) * region_.edges[2];
        }
        for (std::size_t i = 0; i < content.radius.size(); ++i) position_[i].radius = content.radius[i];
        velocity_.resize(position_.size());
        force_.resize(position_.size());
        list_neighbours();
    }

    void set_edge(double edge) {
        edge_ = edge;
        if (list_is_stale()) list_neighbours();
    }

    /// Forces at the present positions, and their sums.
    ForceSums evaluate() {
        ++evaluations_;
        chunk_sums_.resize(list_.chunk_count());
        team_.for_each(list_.chunk_count(), [&](std::size_t k) {
            chunk_sums_[k] =
                contact_forces(position_.data(), velocity_.data(), force_.data(), k * NeighbourList::chunk_size,
                               list_.chunk_length(k), list_.chunk(k), 1.0 / edge_, region_);
        });
        ForceSums sums;
        for (const ForceSums& chunk : chunk_sums_) {
            sums.force_velocity += chunk.force_velocity;
            sums.force_squared += chunk.force_squared;
            sums.velocity_squared += chunk.velocity_squared;
            sums.load += chunk.load;
        }
        return sums;
    }

    /// u <- keep u + kick F, then x <- x + drift u.
    void move(double keep, double kick, double drift) {
        const double step = drift / edge_;
        chunk_moved_.resize(list_.chunk_count());
        team_.for_each(list_.chunk_count(), [&](std::size_t k) {
            const std::size_t first = k * NeighbourList::chunk_size;
            double largest = 0.0;
            for (std::size_t i = first; i < first + list_.chunk_length(k); ++i) {
                Row& u = velocity_[i];
                Row& p = position_[i];
                const Row &f = force_[i], &from = listed_position_[i];
                u = {keep * u.x + kick * f.x, keep * u.y + kick * f.y, keep * u.z + kick * f.z, 0.0};
                p = {p.x + step * u.x, p.y + step * u.y, p.z + step * u.z, p.radius};
                const double dx = p.x - from.x, dy = p.y - from.y, dz = p.z - from.z;
                largest = std::max(largest, dx * dx + dy * dy + dz * dz);
            }
            chunk_moved_[k] = largest;
        });
        largest_move_ = std::sqrt(*std::max_element(chunk_moved_.begin(), chunk_moved_.end()));
        if (list_is_stale()) list_neighbours();
    }

    const std::vector<Row>& position() const { return position_; }
    std::int64_t evaluations() const { return evaluations_; }

 private:
    /// Two particles may have come closer by twice the largest move; positions are fractions of a shrinking edge. The
    /// largest spheres are the first that the list may miss.
    bool list_is_stale() const { return largest_diameter_ / edge_ + 2.0 * largest_move_ > list_.cutoff(); }

    void list_neighbours() {
        double longest = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis)
            if (region_.periodic[axis]) longest = std::min(longest, 0.5 * region_.edges[axis]);
        list_.build(position_, velocity_, std::min((largest_diameter_ + skin) / edge_, longest), team_, region_,
                    1.0 / edge_, skin / edge_);
        listed_position_ = position_;
        largest_move_ = 0.0;
    }

    ThreadTeam team_;
    Region region_;
    double largest_diameter_;
    double edge_;
    std::vector<Row> position_, velocity_, force_, listed_position_;
    NeighbourList list_;
    double largest_move_ = 0.0;
    std::vector<ForceSums> chunk_sums_;
    std::vector<double> chunk_moved_;
    std::int64_t evaluations_ = 0;
};

/// Shrinks the box to `edge` at the wanted strain rate.
void compress(Assembly& assembly, double start_edge, double edge, double rate,
              const std::function<void(double)>& progress) {
    constexpr double time_step = 0.3;  // the stiffest mode of a dense packing has a period of about 2.2
    constexpr double drag = 0.5;
    const double whole_strain = std::log(start_edge / edge);
    // Products instead of pow(), whose last bit depends on the processor.
    for (double now = start_edge; now > edge;) {
        assembly.evaluate();
        assembly.move(1.0 - drag * time_step, time_step, time_step);
        now = std::max(edge, now * (1.0 - rate * time_step));
        assembly.set_edge(now);
        progress(std::log(start_edge / now) / whole_strain);
    }
}

struct Rest {
    double residual, load;
};

/// Minimises the elastic energy (FIRE) until the net forces are small against the load.
Rest relax(Assembly& assembly, double max_residual, std::int64_t max_steps,
           const std::function<void(double)>& progress) {
    constexpr double longest_step = 0.5, mixing_at_start = 0.1;
    constexpr double negligible = 1e-6;  // overlaps of 1e-6 d: what is left below jamming, where no load is carried
    const double particles = static_cast<double>(assembly.position().size());
    double time_step = 0.2, mixing = mixing_at_start, worst = 0.0;
    int downhill = 0;
    for (std::int64_t step = 0; step < max_steps; ++step) {
        const ForceSums sums = assembly.evaluate();
        const double residual = std::sqrt(sums.force_squared / particles), load = sums.load / particles;
        const double aim = std::max(max_residual * load, negligible);
        if (residual <= aim) return {residual, load};
        worst = std::max(worst, residual / aim);
        progress(1.0 - std::log(residual / aim) / std::log(worst));
        if (sums.force_velocity > 0.0) {
            const double turn = mixing * std::sqrt(sums.velocity_squared / sums.force_squared);
            assembly.move(1.0 - mixing, turn + time_step, time_step);
            if (++downhill > 5) {
                time_step = std::min(1.1 * time_step, longest_step);
                mixing *= 0.99;
            }
        } else {
            if (step > 0) time_step *= 0.5;
            mixing = mixing_at_start;
            downhill = 0;
            assembly.move(0.0, time_step, time_step);
        }
    }
    throw InvalidInput(
        fmt::format("the packing of {} particles did not come to rest in {} steps: try another random seed",
                    assembly.position().size(), max_steps));
}

/// Interleaves the bits of the cell of a grid of 2^21 cells along the longest edge.
std::uint64_t morton_key(const Row& p, double longest_edge) {
    const auto spread = [&](double s) {
        std::uint64_t b = std::min<std::uint64_t>(static_cast<std::uint64_t>(s / longest_edge * 0x1p21), 0x1fffff);
        b = (b | b << 32) & 0x1f00000000ffff;
        b = (b | b << 16) & 0x1f0000ff0000ff;
        b = (b | b << 8) & 0x100f00f00f00f00f;
        b = (b | b << 4) & 0x10c30c30c30c30c3;
        return (b | b << 2) & 0x1249249249249249;
    };
    return spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2;
}

Packing to_packing(std::vector<Row> position, const Region& region, double edge, double seed_radius) {
    const auto inside = [&](int axis, double s) {
        const double length = region.edges[axis];
        return region.periodic[axis] ? s - length * std::floor(s / length) : std::clamp(s, 0.0, length);
    };
    for (Row& p : position) p = {inside(0, p.x), inside(1, p.y), inside(2, p.z), p.radius};
    std::vector<std::pair<std::uint64_t, std::size_t>> order(position.size());
    const double longest = *std::max_element(region.edges.begin(), region.edges.end());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = {morton_key(position[i], longest), i};
    std::sort(order.begin(), order.end());
    Packing packing;
    packing.box = {Vec3::Zero(), edge * Vec3(region.edges[0], region.edges[1], region.edges[2]), region.periodic};
    packing.seed_radius = seed_radius;
    packing.species.assign(order.size(), 1);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Row& p = position[order[k].second];
        const auto scaled = [&](int axis, double s) {
            return s * edge < packing.box.edges[axis] || !region.periodic[axis] ? s * edge : 0.0;
        };
        packing.position.emplace_back(scaled(0, p.x), scaled(1, p.y), scaled(2, p.z));
        packing.id.push_back(static_cast<std::int64_t>(k) + 1);
        if (!region.equal_radii) packing.radius.push_back(2.0 * p.radius * seed_radius);
    }
    return packing;
}

void check(const Compaction& wanted) {
    if (!(wanted.density >= lowest_density && wanted.density <= highest_density))
        throw InvalidInput(fmt::format("density {} is out of range: expected {} to {}", wanted.density, lowest_density,
                                       highest_density));
    if (!(wanted.dispersion >= 0.0 && wanted.dispersion <= highest_dispersion))
        throw InvalidInput(
            fmt::format("dispersion {} is out of range: expected 0 to {}", wanted.dispersion, highest_dispersion));
    const auto [shortest, longest] = std::minmax_element(wanted.aspect.begin(), wanted.aspect.end());
    if (!(*shortest > 0.0 && *longest <= highest_aspect * *shortest))
        throw InvalidInput(
            fmt::format("aspect {}:{}:{} is out of range: expected three positive numbers, the largest "
                        "at most {} times the smallest",
                        wanted.aspect[0], wanted.aspect[1], wanted.aspect[2], highest_aspect));
    if (wanted.particles > 2'000'000'000)
        throw InvalidInput(fmt::format("{} particles are too many: at most 2e9", wanted.particles));
}

void check_size(const Compaction& wanted, const Content& content) {
    const double edge = content.edge_at(std::max<std::int64_t>(wanted.particles, 0), wanted.density);
    const double shortest = shortest_box * content.largest_diameter;
    if (edge < shortest) {
        const double enough = std::pow(shortest, 3) * 6.0 * wanted.density * content.region.volume() /
                              (std::numbers::pi * content.mean_cube);
        throw InvalidInput(fmt::format(
            "{} particles at density {} fill a box whose shortest edge is {:.2f} seed diameters, less than three crown "
            "radii{} ({:.4g}): take at least {} particles",
            wanted.particles, wanted.density, edge, content.radius.empty() ? "" : " of the largest sphere", shortest,
            static_cast<std::int64_t>(std::ceil(enough))));
    }
}

}  // namespace

CompactedPacking compact(const Compaction& wanted) {
    check(wanted);
    const Content content = content_of(wanted);
    check_size(wanted, content);
    const double start_density = std::min(0.25, 0.5 * wanted.density);
    const double start_edge = content.edge_at(wanted.particles, start_density);
    const double edge = content.edge_at(wanted.particles, wanted.density);
    const auto progress = [&](double from, double share) {
        return [&, from, share](double done) {
            if (wanted.progress) wanted.progress(from + share * std::clamp(done, 0.0, 1.0));
        };
    };
    Assembly assembly(content, wanted.particles, wanted.random_seed, start_edge, wanted.threads);
    compress(assembly, start_edge, edge, wanted.rate, progress(0.0, 0.3));
    CompactedPacking result;
    const Rest rest = relax(assembly, wanted.max_residual, wanted.max_steps, progress(0.3, 0.7));
    result.residual = rest.residual;
    result.load = rest.load;
    result.steps = assembly.evaluations();
    result.packing =
        to_packing(assembly.position(), content.region, 2.0 * wanted.seed_radius * edge, wanted.seed_radius);
    return result;
}

}  // namespace tomodem::packgen
