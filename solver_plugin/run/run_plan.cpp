#include "solver_plugin/run/run_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "solver_plugin/run/run_curves.hpp"

namespace tomodem {
namespace {

/// Of stress, in a point of the curves: 20 in a window.
constexpr int samples_per_point = 2;

/// Steps after which, at the next point of the curves, the solver is set up anew: what a checkpoint can be made of.
constexpr std::int64_t steps_between_rests = 2000, quasi_static_steps_between_rests = 10;

std::vector<std::int64_t> every_step(std::int64_t steps) {
    std::vector<std::int64_t> all(static_cast<std::size_t>(steps));
    std::iota(all.begin(), all.end(), 1);
    return all;
}

}  // namespace

std::vector<PlannedPoint> plan_points(const Scene& scene, const std::vector<LoadSegment>& segments) {
    const bool quasi_static = scene.scheme == Scheme::quasi_static;
    const double spacing = scene.averaging_strain / points_per_window;
    const std::int64_t between_rests = quasi_static ? quasi_static_steps_between_rests : steps_between_rests;
    const double frame_spacing = scene.path_length() / static_cast<double>(scene.frames);
    std::vector<PlannedPoint> plan;
    double travelled = 0;
    std::int64_t frames = 0, since_rest = 0;
    for (std::size_t k = 0; k < segments.size(); ++k) {
        std::int64_t from = 0;
        double reached = segments[k].strain;
        for (const std::int64_t to : quasi_static ? every_step(segments[k].steps) : segments[k].curve_steps(spacing)) {
            const double strain = segments[k].strain_at(segments[k].time_step * static_cast<double>(to));
            travelled += std::abs(strain - reached);
            reached = strain;
            PlannedPoint point{k, from, to, travelled};
            if (travelled >= static_cast<double>(frames + 1) * frame_spacing * (1 - 1e-9)) {
                point.frame = true;
                frames = static_cast<std::int64_t>(travelled / frame_spacing * (1 + 1e-9));
            }
            since_rest += to - from;
            // A run that continues from the end of a load must begin as one does that goes on with the next load.
            const bool ends_load = to == segments[k].steps && k + 1 < segments.size();
            point.rest = since_rest >= between_rests || ends_load;
            if (point.rest) since_rest = 0;
            from = to;
            plan.push_back(point);
        }
    }
    for (std::size_t k = 0; scene.write_stress && k < plan.size(); ++k)
        for (std::size_t j = k; j < std::min(plan.size(), k + static_cast<std::size_t>(window_points(scene))); ++j)
            if (plan[j].frame) {
                plan[k].sampled = true;
                break;
            }
    return plan;
}

std::vector<std::int64_t> sample_steps(std::int64_t steps, std::size_t point) {
    const auto samples = std::min<std::int64_t>(samples_per_point, steps);
    std::vector<std::int64_t> result;
    for (std::int64_t k = 0; k < samples; ++k) {
        const std::int64_t from = steps * k / samples, length = steps * (k + 1) / samples - from;
        const double place = std::numbers::phi * static_cast<double>(samples * static_cast<std::int64_t>(point) + k);
        result.push_back(from + 1 +
                         static_cast<std::int64_t>((place - std::floor(place)) * static_cast<double>(length)));
    }
    return result;
}

}  // namespace tomodem
