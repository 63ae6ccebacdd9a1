#include "core/scene/load_path.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/polynomial.hpp"

namespace tomodem {
namespace {

std::int64_t whole_steps(double duration, double time_step) {
    return static_cast<std::int64_t>(std::max(1.0, std::round(duration / time_step)));
}

/// Steps of at most that strain each, but for roundings.
std::int64_t enough_steps(double strain, double strain_per_step) {
    return static_cast<std::int64_t>(std::max(1.0, std::ceil(strain / strain_per_step * (1 - 1e-9))));
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

/// Shares of the highest rate of a step between which the segments of a quasi-static load are.
constexpr double rate_bands[] = {0.5, 0.25, 0.125};

/// Segments closer to each other than that share of the step's duration are one.
constexpr double shortest_segment = 1e-9;

/// A step of a quasi-static load.
/// @param rate      signed
/// @param duration  s
void add_segments(const std::vector<double>& rate, double strain, double duration, double strain_per_step,
                  std::vector<LoadSegment>& path) {
    const double highest = polynomial::largest_magnitude(rate, duration);
    std::vector<double> ends;
    for (const double share : rate_bands) {
        std::vector<double> above = rate;
        above.front() -= std::copysign(share * highest, rate.front());
        for (const double time : polynomial::sign_changes(above, 0, duration)) ends.push_back(time);
    }
    std::sort(ends.begin(), ends.end());
    ends.push_back(duration);
    double start = 0;
    for (const double end : ends) {
        const bool last = end == duration;
        if (const double least = shortest_segment * duration; !last && (end - start < least || duration - end < least))
            continue;
        LoadSegment segment{.strain = strain, .rate = polynomial::from(rate, start)};
        const double length = end - start, fastest = polynomial::largest_magnitude(segment.rate, length);
        segment.steps = enough_steps(fastest * length, strain_per_step);
        segment.time_step = length / static_cast<double>(segment.steps);
        strain = segment.end_strain();
        path.push_back(std::move(segment));
        start = end;
    }
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

std::vector<LoadClock> clocks_of(const std::vector<LoadSegment>& segments) {
    std::vector<LoadClock> clocks;
    LoadClock clock;
    std::int64_t step = 0;
    for (const LoadSegment& segment : segments) {
        clock = clock.from(step, segment.time_step);
        clocks.push_back(clock);
        step += segment.steps;
    }
    return clocks;
}

std::vector<LoadSegment> load_path(const Scene& scene, const Model& model, const LoadBegin& begin) {
    const double time_step = model.time_step;
    const bool quasi_static = model.scheme == Scheme::quasi_static;
    if (scene.duration) {
        const double rate = *scene.nominal_rate, duration = *scene.duration;
        if (!quasi_static) return {{.rate = {rate}, .steps = whole_steps(duration, time_step), .time_step = time_step}};
        std::vector<LoadSegment> path;
        add_segments({rate}, 0, duration, model.strain_per_step, path);
        return path;
    }
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
        if (quasi_static) {
            const double duration = polynomial::time_to_reach(step.rate, change).value();
            std::vector<double> rate = step.rate;
            for (double& coefficient : rate) coefficient *= sign * change / polynomial::integral(step.rate, duration);
            add_segments(rate, reached, duration, model.strain_per_step, path);
            last_rate = path.back().rate_at(path.back().time_step * static_cast<double>(path.back().steps));
            reached = target;
            continue;
        }
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
