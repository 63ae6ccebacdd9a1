#include "tools/vol2pack/resolution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "tools/vol2pack/geometric_error.hpp"

namespace tomodem::vol2pack {

std::vector<ResolutionStep> choose_resolution(const LabelVolume& volume, const Packing& brick,
                                              const ResolutionOptions& options, Reporter& reporter) {
    const Box box{volume.origin(), volume.extent(), {false, false, false}};
    const auto voxels = volume.histogram();
    // Particles at a radius of one voxel.
    const double finest = static_cast<double>(brick.size()) *
                          (box.edges / options.pixel * brick.seed_radius).cwiseQuotient(brick.box.edges).prod();
    constexpr double fewest = 64;
    const int coarsest = std::max(0, static_cast<int>(std::floor(std::log2(finest / fewest))));
    std::vector<ResolutionStep> steps;
    for (int k = coarsest; k >= 0; --k) {
        ResolutionStep step;
        step.pixels_per_seed = std::exp2(k / 3.0);
        step.particles = finest / std::exp2(k);
        const auto give_up = [&](const std::string& why) {
            std::string best;
            if (!steps.empty()) {
                const auto smallest = std::min_element(steps.begin(), steps.end(),
                                                       [](const auto& a, const auto& b) { return a.error < b.error; });
                best = fmt::format("; the smallest error is {:.3g} % at {:.3g} pixels per seed", 100 * smallest->error,
                                   smallest->pixels_per_seed);
            }
            throw InvalidInput(fmt::format("no resolution keeps the volume of every label within {:g} %: {}{}",
                                           100 * options.max_error, why, best));
        };
        if (step.particles > static_cast<double>(options.max_particles))
            give_up(fmt::format("{:.3g} pixels per seed would take about {:.3g} particles, more than the {} allowed",
                                step.pixels_per_seed, step.particles, options.max_particles));
        for (std::uint64_t placement = 0; placement < 4; ++placement) {
            const std::uint64_t seed = options.random_seed + placement * 0x9E3779B97F4A7C15U;
            const Tiling tiling(brick, step.pixels_per_seed * options.pixel, box, seed, options.max_particles * 2);
            const auto held = label_places(volume, tiling, nullptr, options.filter, options.threads, reporter).count();
            step.error = std::max(step.error, largest_volume_error(voxels, held));
        }
        steps.push_back(step);
        if (step.error <= options.max_error) return steps;
        if (k == 0)
            give_up(
                fmt::format("even a radius of 1 voxel has {:.3g} % (parts of two or three voxels? --filter nearest "
                            "keeps them; a label of few voxels? see --min-component)",
                            100 * step.error));
    }
    return steps;
}

void report_resolution(const std::vector<ResolutionStep>& steps, double max_error, Reporter& reporter) {
    const ResolutionStep& chosen = steps.back();
    reporter.report("pixels_per_seed", chosen.pixels_per_seed);
    reporter.report("chosen_for_error", 100 * chosen.error, "%");
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    for (const ResolutionStep& step : steps)
        table.push_back(
            {{"pixels_per_seed", step.pixels_per_seed}, {"particles", step.particles}, {"error", step.error}});
    reporter.report_json("resolutions_tried", table);
    std::string why =
        fmt::format("{:.3g} pixels per seed: every label keeps its volume within {:.3g} % (asked: {:g} %)",
                    chosen.pixels_per_seed, 100 * chosen.error, 100 * max_error);
    if (steps.size() > 1) {
        const ResolutionStep& coarser = steps[steps.size() - 2];
        why += fmt::format("; at {:.3g} it is {:.3g} %", coarser.pixels_per_seed, 100 * coarser.error);
    } else {
        why += "; coarser ones have too few particles to measure it";
    }
    reporter.note(why);
}

}  // namespace tomodem::vol2pack
