#include "core/scene/unusual_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/polynomial.hpp"
#include "core/packing/packing.hpp"

namespace tomodem {
namespace {

[[noreturn]] void refuse(const Scene& scene, std::int64_t line, const std::string& what) {
    throw InvalidInput(
        fmt::format("scene '{}' line {}: {}; if it is meant, write unusual_values = true as the scene's first line",
                    scene.path.string(), line, what));
}

void check_phase(const Scene& scene, const Phase& phase, double duration) {
    const double rate = scene.highest_rate();
    if (phase.norton) {
        const double stress = phase.norton->stress(rate) * pascal_per_megapascal;
        if (stress > max_usual_flow_stress)
            refuse(scene, phase.line,
                   fmt::format("K = {:g} of [phase.{}] makes a flow stress of {:.3g} GPa at {:g} /s, which no material "
                               "has: K is in MPa.s^M (if this one is in Pa.s^M, write {:g})",
                               phase.norton->consistency, phase.name, stress / 1e9, rate,
                               phase.norton->consistency / pascal_per_megapascal));
    } else if (phase.repulsive_stiffness) {
        const double modulus = *phase.repulsive_stiffness / (2 * scene.seed_radius);
        if (modulus > max_usual_seed_modulus)
            refuse(
                scene, phase.line,
                fmt::format("repulsive_stiffness = {:g} uN/mm of [phase.{}] is {:.3g} GPa over the seed's diameter of "
                            "{:g} mm, which makes a flow stress of 15 GPa and more: check its unit, and seed_radius",
                            *phase.repulsive_stiffness, phase.name, modulus / 1e9, 2 * scene.seed_radius));
    }
    if (!phase.hardening) return;
    auto points = phase.hardening->table;
    if (points.empty()) points = {{0, phase.hardening->factor(0)}, {duration, phase.hardening->factor(duration)}};
    for (const auto& [time, factor] : points)
        if (!(factor <= max_usual_hardening && factor >= 1 / max_usual_hardening))
            refuse(scene, phase.line,
                   fmt::format("hardening of [phase.{}] has the factor {:g} at {:g} s: it is the strength over that at "
                               "the start, which is 1 (not per cent, and not a stress)",
                               phase.name, factor, time));
}

/// @return how long the step takes [s]
double check_step(const Scene& scene, const LoadStep& step, double reached) {
    if (std::abs(step.strain) > max_usual_strain) {
        const double from_per_cent = 1 + step.strain / 100;
        refuse(scene, step.line,
               fmt::format("strain = {:g} leaves {:.2g} times the height: strains are true strains, ln(H / H0){}",
                           step.strain, std::exp(step.strain),
                           from_per_cent > 0
                               ? fmt::format(" ({:g} % of the height is {:.4g})", step.strain, std::log(from_per_cent))
                               : std::string()));
    }
    const double end = polynomial::time_to_reach(step.rate, std::abs(step.strain - reached)).value();
    for (const double rate : {step.rate.front(), polynomial::largest_magnitude(step.rate, end)})
        if (rate < min_usual_rate || rate > max_usual_rate)
            refuse(scene, step.line,
                   fmt::format("the rate is {:g} /s, where {:g} to {:g} is usual: it is the true strain rate in 1/s",
                               rate, min_usual_rate, max_usual_rate));
    return end;
}

}  // namespace

void refuse_unusual_values(const Scene& scene) {
    double reached = 0, duration = scene.duration.value_or(0);
    for (const LoadStep& step : scene.steps) {
        duration += check_step(scene, step, reached);
        reached = step.strain;
    }
    if (const auto rate = scene.nominal_rate; rate && (*rate < min_usual_rate || *rate > max_usual_rate))
        refuse(scene, scene.load_line,
               fmt::format("rate = {:g} in [load] is a nominal strain rate in 1/s, where {:g} to {:g} is usual", *rate,
                           min_usual_rate, max_usual_rate));
    for (const Phase& phase : scene.phases) check_phase(scene, phase, duration);
}

void refuse_unusual_size(const Scene& scene, const Packing& sample) {
    if (scene.unusual_values) return;
    if (sample.seed_radius < min_usual_sample_seed_radius || sample.seed_radius > max_usual_sample_seed_radius)
        refuse(scene, 1,
               fmt::format("the particles of the sample have a radius of {:g} mm, where {:g} to {:g} is usual: was the "
                           "voxel size given in the right unit?",
                           sample.seed_radius, min_usual_sample_seed_radius, max_usual_sample_seed_radius));
}

}  // namespace tomodem
