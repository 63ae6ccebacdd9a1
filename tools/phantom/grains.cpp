#include "tools/phantom/grains.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"

namespace tomodem::phantom {
namespace {

double sphere_diameter(double volume) {
    return std::cbrt(6 * volume / std::numbers::pi);
}

Grain sphere_of_volume(double volume) {
    return {{{Vec3::Zero(), sphere_diameter(volume) / 2}}};
}

void scale(Grain& grain, double factor) {
    for (Sphere& sphere : grain.spheres) {
        sphere.centre *= factor;
        sphere.radius *= factor;
    }
}

/// Volumes drawn one after the other until their sum is as near to `total` as it gets, then scaled to meet it.
std::vector<double> volumes_of_sum(double total, const std::function<double()>& draw) {
    std::vector<double> volumes;
    double sum = 0;
    for (;;) {
        constexpr std::size_t max_grains = 2'000'000;
        if (volumes.size() == max_grains)
            throw InvalidInput(fmt::format("the fraction asks for more than {} grains; make them larger", max_grains));
        const double next = draw();
        if (sum + next > total && (sum + next - total >= total - sum) && !volumes.empty()) break;
        volumes.push_back(next);
        sum += next;
        if (sum > total) break;
    }
    const double factor = total / sum;
    if (factor < 0.5)
        throw InvalidInput(
            fmt::format("one grain of {:.4g} mm diameter is already more than the fraction asked for; make the "
                        "grains smaller or the volume larger",
                        sphere_diameter(volumes[0])));
    for (double& volume : volumes) volume *= factor;
    return volumes;
}

/// 3 to 5 overlapping spheres around a corner, like the branches of a shrinkage pore.
Grain draw_cluster(double volume, Random& random) {
    const int count = 3 + static_cast<int>(random.uniform(0, 3));
    Grain grain{{{Vec3::Zero(), 1.0}}};
    for (int i = 1; i < count; ++i) {
        const Sphere& stem = grain.spheres[static_cast<std::size_t>(random.uniform(0, static_cast<double>(i)))];
        const double radius = random.uniform(0.6, 1.0);
        grain.spheres.push_back({stem.centre + random.uniform(1.0, 1.3) * stem.radius * random.direction(), radius});
    }
    scale(grain, std::cbrt(volume / grain_volume(grain)));
    return grain;
}

}  // namespace

std::optional<std::array<double, 2>> diameter_range(const std::string& text) {
    if (text.empty()) return {};
    try {
        const auto colon = text.find(':');
        const double low = units::length(text.substr(0, colon));
        const double high = colon == std::string::npos ? low : units::length(text.substr(colon + 1));
        if (!(low > 0) || high < low) throw InvalidInput("expected 0 < smallest <= largest");
        return std::array{low, high};
    } catch (const InvalidInput& error) {
        throw WrongUsage("--diameter '" + text + "': " + error.what());
    }
}

std::vector<Grain> draw_inclusions(const InclusionRequest& request, double volume, Random& random) {
    std::vector<double> volumes;
    const auto draw = [&] {
        const double diameter = random.uniform((*request.diameter)[0], (*request.diameter)[1]);
        return std::numbers::pi / 6 * diameter * diameter * diameter;
    };
    if (request.fraction && request.count && !request.diameter)
        volumes.assign(*request.count, *request.fraction * volume / static_cast<double>(*request.count));
    else if (request.fraction && request.diameter && !request.count)
        volumes = volumes_of_sum(*request.fraction * volume, draw);
    else if (request.count && request.diameter && !request.fraction)
        for (std::int64_t i = 0; i < *request.count; ++i) volumes.push_back(draw());
    else
        throw WrongUsage("give two of --fraction, --count and --diameter");
    std::vector<Grain> grains;
    for (const double one : volumes) grains.push_back(sphere_of_volume(one));
    return grains;
}

std::vector<Grain> draw_pores(const PoreRequest& request, double volume, Random& random) {
    const auto volumes = volumes_of_sum(request.porosity * volume, [&] {
        double deviation = random.normal();
        while (std::abs(deviation) > 2.5) deviation = random.normal();
        const double diameter = request.median_diameter * std::exp(request.spread * deviation);
        return std::numbers::pi / 6 * diameter * diameter * diameter;
    });
    std::vector<Grain> grains;
    for (const double one : volumes)
        grains.push_back(random.uniform(0, 1) < request.cluster_share ? draw_cluster(one, random)
                                                                      : sphere_of_volume(one));
    return grains;
}

std::vector<Grain> place_touching(std::vector<Grain> spheres, const Vec3& edges, double overlap, Random& random,
                                  Reporter& reporter) {
    double largest = 0;
    for (Grain& grain : spheres) {
        largest = std::max(largest, grain.spheres[0].radius);
        grain.spheres[0].radius *= 1 - overlap;
    }
    // Smaller spheres fill a smaller box without overlap; as large as they are, they touch and stay inside.
    const Vec3 margin = Vec3::Constant(overlap * largest);
    spheres = place_without_overlap(std::move(spheres), edges - 2 * margin, 0.0, random, reporter);
    for (Grain& grain : spheres) {
        grain.spheres[0].radius /= 1 - overlap;
        grain.spheres[0].centre += margin;
    }
    return spheres;
}

}  // namespace tomodem::phantom
