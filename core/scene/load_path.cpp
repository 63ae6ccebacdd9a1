#include "core/scene/load_path.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/polynomial.hpp"

namespace tomodem {
namespace {

std::int64_t whole_steps(double duration, double time_step) {
    return static_cast<std::int64_t>(std::max(1.0, std::round(duration / time_step)));
}

/// Smooth rise of the rate from `from` to `to` [1/s], flat at both ends, over about the strain of the initiation.
LoadSegment ramp(double start_strain, double from, double to, const Initiation& initiation, double time_step) {
    LoadSegment segment{.strain = start_strain,
                        .time_step = time_step,
                        .initiates = true,
                        .affine = initiation.affine,
                        .noise = initiation.noise * std::abs(to)};
    segment.steps = whole_steps(2 * initiation.strain / std::abs(from + to), time_step);
    const double duration = static_cast<double>(segment.steps) * time_step, change = to - from;
    segment.rate = {from, 0, 3 * change / std::pow(duration, 2), -2 * change / std::pow(duration, 3)};
    return segment;
}

}  // namespace

double LoadSegment::rate_at(double time) const {
    return polynomial::value(rate, time);
}

double LoadSegment::strain_at(double time) const {
    return strain + polynomial::integral(rate, time);
}

double LoadSegment::end_strain() const {
    return strain_at(static_cast<double>(steps) * time_step);
}

std::int64_t LoadSegment::step_at(double wanted) const {
    const double change = std::abs(wanted - strain), whole = std::abs(end_strain() - strain);
    if (change >= whole) return steps;
    std::int64_t low = 0, high = steps;
    while (high - low > 1) {
        const std::int64_t middle = low + (high - low) / 2;
        (std::abs(strain_at(static_cast<double>(middle) * time_step) - strain) < change ? low : high) = middle;
    }
    const auto distance = [&](std::int64_t step) {
        return std::abs(strain_at(static_cast<double>(step) * time_step) - wanted);
    };
    return distance(low) < distance(high) ? low : high;
}

std::vector<std::int64_t> LoadSegment::curve_steps(double spacing) const {
    const double change = end_strain() - strain;
    const auto points = std::max<std::int64_t>(1, std::llround(std::abs(change) / spacing));
    std::vector<std::int64_t> result;
    for (std::int64_t point = 1; point <= points; ++point) {
        const double share = static_cast<double>(point) / static_cast<double>(points);
        const std::int64_t step = point == points ? steps : step_at(strain + share * change);
        if (step > (result.empty() ? 0 : result.back())) result.push_back(step);
    }
    return result;
}

std::vector<LoadSegment> load_path(const Scene& scene, double time_step, const LoadBegin& begin) {
    if (scene.duration)
        return {
            {.rate = {*scene.nominal_rate}, .steps = whole_steps(*scene.duration, time_step), .time_step = time_step}};
    std::vector<LoadSegment> path;
    double reached = begin.strain, last_rate = begin.rate;
    for (const LoadStep& step : scene.steps) {
        const double target = begin.strain + step.strain;
        const double sign = target > reached ? 1 : -1, wanted = sign * step.rate.front();
        // A change of direction starts from rest, so that the strain before it is not overrun.
        const double from = last_rate * sign > 0 ? last_rate : 0;
        if (scene.initiation && from != wanted) {
            path.push_back(ramp(reached, from, wanted, *scene.initiation, time_step));
            reached = path.back().end_strain();
        }
        const double change = std::abs(target - reached);
        LoadSegment segment{.strain = reached, .rate = step.rate, .time_step = time_step};
        segment.steps = whole_steps(polynomial::time_to_reach(step.rate, change).value(), time_step);
        const double duration = static_cast<double>(segment.steps) * time_step;
        const double scale = sign * change / polynomial::integral(step.rate, duration);
        for (double& coefficient : segment.rate) coefficient *= scale;
        last_rate = segment.rate_at(duration);
        reached = target;
        path.push_back(segment);
    }
    return path;
}

}  // namespace tomodem
