// bench_vol2pack_filters: what each filter of vol2pack does to spheres and rods of known volume and surface.
//
// Bodies of n particle diameters across at p voxels per seed radius, at random places (rods of random direction),
// filled with the given bricks, each moved at random. For each filter: error of the volume (mean and scatter), error of
// the surface as vol2pack states it, the share of the body's particles that have another label than the body itself
// would give them, and how often nothing is left. "exact" asks the body and not its image: what the packing itself
// scatters. Prints CSV; filters.py makes the bricks, the table and the plot.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/vol2pack/geometric_error.hpp"

namespace tomodem::vol2pack {
namespace {

constexpr double pi = std::numbers::pi;

struct Request {
    std::vector<std::filesystem::path> bricks;
    double work = 1.0;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("bench_vol2pack_filters",
                     "Measure the filters of vol2pack on spheres and rods of known volume and surface.");
    usage.inputs("BRICK", request.bricks, "Periodic packings (.h5).")
        .threads()
        .option("--work", request.work, cli::Unit::none, cli::positive,
                "Factor on the number of repetitions; 1 takes about three minutes.");
    return usage;
}

struct Body {
    Vec3 centre, axis;  // a rod has an axis, a sphere has none
    double radius;
    bool holds(const Vec3& point) const {
        const Vec3 from = point - centre;
        return (axis.isZero() ? from.squaredNorm() : from.cross(axis).squaredNorm()) < radius * radius;
    }
};

LabelVolume image_of(const Body& body, int size) {
    LabelVolume volume({size, size, size}, Vec3::Ones());
    std::vector<std::int32_t> slab;
    for (int k = 0; k < size; k += LabelVolume::slab) {
        const int count = std::min(LabelVolume::slab, size - k);
        slab.clear();
        for (int z = k; z < k + count; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) slab.push_back(body.holds(Vec3(x + 0.5, y + 0.5, z + 0.5)) ? 2 : 1);
        volume.set_slices(k, count, slab);
    }
    return volume;
}

Places exact_places(const Tiling& tiling, const Body& body) {
    Places places;
    for (std::int64_t place = 0; place < tiling.places(); ++place) {
        const Vec3 at = tiling.from_corner(place);
        places.label.push_back(tiling.in_box(at)      ? 1 + body.holds(at)
                               : tiling.in_margin(at) ? -2 - body.holds(tiling.mirrored(at))
                                                      : Places::outside);
    }
    return places;
}

struct Scatter {
    double sum = 0, squares = 0;
    int count = 0;
    void add(double value) {
        sum += value;
        squares += value * value;
        ++count;
    }
    double mean() const { return sum / count; }
    double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};

struct Outcome {
    Scatter volume, surface, wrong;
    int lost = 0;
};

void run(const Request& request, cli::Tool& tool) {
    const int threads = tool.threads();
    std::vector<Packing> bricks;
    for (const auto& path : request.bricks) bricks.push_back(read_packing(path));
    std::vector<std::pair<std::string, LabelFilter>> filters{{"nearest", {}}};
    for (const double size : {0.25, 0.5, 1.0}) filters.push_back({fmt::format("box {}", size), {Filter::box, size, 0}});
    for (const double width : {0.5, 0.8, 1.2, 2.0})
        filters.push_back({fmt::format("level-set {}", width), {Filter::level_set, 0, width}});

    fmt::print(
        "body,filter,pixels_per_seed,diameters,volume_error,volume_scatter,surface_error,surface_scatter,"
        "wrong_labels,lost,trials\n");
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> normal;
    for (const bool rod : {false, true})
        for (const double pixels : {1.0, 2.0, 4.0})
            for (const double diameters :
                 rod ? std::vector<double>{1, 1.5, 2, 3} : std::vector<double>{3, 5, 8, 12, 20, 30}) {
                const double radius = diameters * pixels;
                const int size = static_cast<int>(std::ceil(2 * radius + (rod ? 16 : 4) * pixels));
                const int trials =
                    std::max(3, static_cast<int>(request.work * std::min(60.0, 900 / std::pow(diameters, 1.4))));
                std::vector<Outcome> outcomes(filters.size() + 1);
                for (int trial = 0; trial < trials; ++trial) {
                    Body body{
                        Vec3::Constant(size / 2.0 - 0.5) + Vec3(uniform(random), uniform(random), uniform(random)),
                        Vec3::Zero(), radius};
                    if (rod) body.axis = Vec3(normal(random), normal(random), normal(random)).normalized();
                    const LabelVolume volume = image_of(body, size);
                    const Tiling tiling(bricks[trial % bricks.size()], pixels, {Vec3::Zero(), volume.extent(), {}},
                                        static_cast<std::uint64_t>(trial + 1));
                    const auto needles = tiling.needles();
                    const Places exact = exact_places(tiling, body);
                    const auto exact_count = exact.count();
                    // A rod's own volume and surface in the box are those of its particles and of its finest needles.
                    const double box = volume.extent().prod(), candidates = [&] {
                        double sum = 0;
                        for (const auto& [label, count] : exact_count) sum += double(count);
                        return sum;
                    }();
                    const double true_volume = rod ? double(volume.histogram()[2]) : 4 * pi / 3 * std::pow(radius, 3);
                    const double true_surface =
                        rod ? measure_image(volume, 1, threads).label[2].surface : 4 * pi * radius * radius;
                    for (std::size_t f = 0; f <= filters.size(); ++f) {
                        const Places places =
                            f == 0 ? exact : label_places(volume, tiling, nullptr, filters[f - 1].second, threads);
                        Outcome& outcome = outcomes[f];
                        const auto count = places.count();
                        const double held = count.contains(2) ? double(count.at(2)) : 0;
                        auto surfaces = particle_surfaces(tiling, places, needles, threads);
                        std::int64_t wrong = 0;
                        for (std::size_t i = 0; i < places.label.size(); ++i)
                            wrong += places.label[i] >= 0 && places.label[i] != exact.label[i];
                        outcome.volume.add(held / candidates * box / true_volume - 1);
                        outcome.surface.add(surfaces[2] / true_surface - 1);
                        outcome.wrong.add(double(wrong) / (true_volume / box * candidates));
                        outcome.lost += held == 0;
                    }
                }
                for (std::size_t f = 0; f < outcomes.size(); ++f) {
                    const Outcome& outcome = outcomes[f];
                    fmt::print("{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{}\n", rod ? "rod" : "sphere",
                               f == 0 ? "exact" : filters[f - 1].first, pixels, diameters, outcome.volume.mean(),
                               outcome.volume.deviation(), outcome.surface.mean(), outcome.surface.deviation(),
                               outcome.wrong.mean(), outcome.lost, trials);
                }
            }
}

}  // namespace
}  // namespace tomodem::vol2pack

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::vol2pack::usage, tomodem::vol2pack::run);
}
