#include "tools/metrics/curves/stress_resolution.hpp"

#include <cmath>

#include "core/base/error.hpp"
#include "core/scene/law.hpp"
#include "core/scene/scene.hpp"
#include "core/surface/alpha_surface.hpp"
#include "core/surface/envelope.hpp"

namespace tomodem::curves {
namespace {

double across_of(const Packing& packing) {
    try {
        const AlphaSurface surface =
            alpha_surface(packing.position, {.probe_radius = default_probe_radius(packing.seed_radius)});
        return particles_across(surface.volume, surface.area, packing.seed_radius);
    } catch (const InvalidInput&) {
        return particles_across(0.0, 0.0, packing.seed_radius);  // no four particles lie together
    }
}

double needed_across(const RunReader& run) {
    constexpr double viscous = 2.0, others = 3.0;
    const std::string& scene = run.provenance().scene;
    if (scene.empty()) return others;
    try {
        const bool damped = parse_stored_scene(scene, "of the run").law().traits().damping == Damping::law;
        return damped ? viscous : others;
    } catch (const InvalidInput&) {
        return others;  // a law that `solve` alone was built with
    }
}

std::int64_t rounded_up(double number) {
    const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
    return std::llround(std::ceil(number / unit) * unit);
}

}  // namespace

StressResolution stress_resolution(const RunReader& run, double plane_difference) {
    StressResolution result{.particles_across = across_of(run.packing()),
                            .particles_needed = needed_across(run),
                            .plane_difference = plane_difference};
    if (!result.fine_enough())
        result.particles_to_do =
            rounded_up(double(run.packing().size()) * std::pow(result.particles_needed / result.particles_across, 3));
    return result;
}

}  // namespace tomodem::curves
