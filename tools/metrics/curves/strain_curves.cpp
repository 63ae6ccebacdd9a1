#include "tools/metrics/curves/strain_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace tomodem::curves {
namespace {

const Observable& checked(const RunReader& run, const std::filesystem::path& path, const CurveName& wanted) {
    const Observable& curve = run.observable(wanted.name);
    if (curve.unit != wanted.unit)
        throw InvalidInput(fmt::format("'{}': the curve {} is in '{}', expected '{}'", path.string(), wanted.name,
                                       curve.unit, wanted.unit));
    if (curve.value.empty())
        throw InvalidInput(
            fmt::format("'{}': the curve {} has no points; run the simulation further", path.string(), wanted.name));
    for (std::size_t i = 0; i < curve.value.size(); ++i)
        if (!std::isfinite(curve.value[i]) || !std::isfinite(curve.time[i]))
            throw InvalidInput(fmt::format("'{}': point {} (counted from 0) of the curve {} is not a finite number",
                                           path.string(), i, wanted.name));
    return curve;
}

}  // namespace

StrainCurves read_strain_curves(const std::filesystem::path& path, const std::vector<CurveName>& names) {
    const RunReader run(path);
    const Observable& strain = checked(run, path, {"strain", ""});
    if (strain.value.size() < 2)
        throw InvalidInput(fmt::format("'{}': the curve strain has one point; a curve needs two", path.string()));
    StrainCurves curves{.time = strain.time, .strain = strain.value, .value = {}};
    if (!std::is_sorted(curves.time.begin(), curves.time.end()))
        throw InvalidInput(fmt::format("'{}': the time of the curve strain runs backwards", path.string()));
    for (const CurveName& wanted : names) {
        const Observable& curve = checked(run, path, wanted);
        std::vector<double>& values = curves.value[wanted.name];
        if (curve.time == strain.time)
            values = curve.value;
        else
            for (const double time : strain.time) values.push_back(value_at(curve, time));
    }
    return curves;
}

PiecewiseLinear::PiecewiseLinear(std::span<const double> x, std::span<const double> y) : x_(x), y_(y) {
    integral_.resize(x.size(), 0.0);
    for (std::size_t i = 1; i < x.size(); ++i)
        integral_[i] = integral_[i - 1] + 0.5 * (x[i] - x[i - 1]) * (y[i] + y[i - 1]);
}

std::size_t PiecewiseLinear::segment(double x) const {
    const auto above = std::upper_bound(x_.begin(), x_.end(), x);
    const std::size_t index = above == x_.begin() ? 0 : std::size_t(above - x_.begin()) - 1;
    return std::min(index, x_.size() < 2 ? 0 : x_.size() - 2);
}

double PiecewiseLinear::at(double x) const {
    const std::size_t i = segment(x);
    if (x_.size() < 2 || x <= x_[i]) return y_[i];
    if (x >= x_[i + 1]) return y_[i + 1];
    return y_[i] + (x - x_[i]) / (x_[i + 1] - x_[i]) * (y_[i + 1] - y_[i]);
}

double PiecewiseLinear::integral_to(double x) const {
    const std::size_t i = segment(x);
    return integral_[i] + 0.5 * (x - x_[i]) * (y_[i] + at(x));
}

double PiecewiseLinear::mean(double from, double to) const {
    return to > from ? (integral_to(to) - integral_to(from)) / (to - from) : at(from);
}

std::vector<Leg> legs(std::span<const double> strain) {
    std::vector<Leg> result;
    std::size_t first = 0;
    double direction = 0.0;
    for (std::size_t i = 1; i < strain.size(); ++i) {
        const double step = strain[i] - strain[i - 1];
        if (step * direction < 0.0) {
            result.push_back({first, i - 1});
            first = i - 1;
        }
        if (step != 0.0) direction = step;
    }
    result.push_back({first, strain.size() - 1});
    return result;
}

namespace {

/// The way that the strain has gone since the beginning of the leg; not decreasing.
std::vector<double> way(const StrainCurves& curves, const Leg& leg) {
    std::vector<double> result;
    for (std::size_t i = leg.first; i <= leg.last; ++i)
        result.push_back(std::abs(curves.strain[i] - curves.strain[leg.first]));
    return result;
}

std::span<const double> part(const std::vector<double>& values, const Leg& leg) {
    return std::span(values).subspan(leg.first, leg.last - leg.first + 1);
}

void average_leg(const std::vector<double>& source, const Leg& leg, const std::vector<double>& x, double width,
                 std::vector<double>& target) {
    const PiecewiseLinear curve(x, part(source, leg));
    for (std::size_t i = leg.first == 0 ? 0 : 1; i < x.size(); ++i) {
        const double from = std::max(x[i] - 0.5 * width, x.front());
        const double to = std::min(x[i] + 0.5 * width, x.back());
        target[leg.first + i] = to > from ? curve.mean(from, to) : source[leg.first + i];
    }
}

}  // namespace

StrainCurves averaged_over_strain(const StrainCurves& curves, double width) {
    if (!(width > 0.0)) return curves;
    StrainCurves result = curves;
    for (const Leg& leg : legs(curves.strain)) {
        const std::vector<double> x = way(curves, leg);
        average_leg(curves.time, leg, x, width, result.time);
        average_leg(curves.strain, leg, x, width, result.strain);
        for (const auto& [name, values] : curves.value) average_leg(values, leg, x, width, result.value[name]);
    }
    return result;
}

double largest_strain(const StrainCurves& curves) {
    double largest = 0.0;
    for (const double strain : curves.strain) largest = std::max(largest, std::abs(strain));
    return largest;
}

std::optional<double> equilibrium_error(double force_top, double force_bottom) {
    const double mean = 0.5 * (std::abs(force_top) + std::abs(force_bottom));
    if (mean == 0.0) return std::nullopt;
    return std::abs(force_top + force_bottom) / mean;
}

double frame_strain(const RunReader& run, std::size_t index) {
    if (run.observables().empty() && run.frame_count() == 1) return 0.0;
    return value_at(run.observable("strain"), run.frame_time(index));
}

StrainCurves equilibrium_errors(const StrainCurves& forces) {
    StrainCurves result;
    const auto& top = forces.value.at("force_top");
    const auto& bottom = forces.value.at("force_bottom");
    for (std::size_t i = 0; i < forces.strain.size(); ++i) {
        const std::optional<double> error = equilibrium_error(top[i], bottom[i]);
        if (!error) continue;
        result.time.push_back(forces.time[i]);
        result.strain.push_back(forces.strain[i]);
        result.value["force_top"].push_back(top[i]);
        result.value["force_bottom"].push_back(bottom[i]);
        result.value["equilibrium_error"].push_back(*error);
    }
    if (result.strain.empty()) throw InvalidInput("the forces on both planes are zero in the whole run");
    return result;
}

namespace {

/// Means over `from` to `to` of |value| on a leg on which |strain| grows from `lowest` to `highest`.
struct RisingLeg {
    RisingLeg(const StrainCurves& curves, const std::string& name, const Leg& leg) {
        const double sign = curves.strain[leg.last] < 0.0 ? -1.0 : 1.0;
        for (std::size_t i = leg.first; i <= leg.last; ++i) {
            x.push_back(sign * curves.strain[i]);
            magnitude.push_back(std::abs(curves.value.at(name)[i]));
        }
        time = part(curves.time, leg);
        lowest = std::max(0.0, x.front());  // |strain| is x once the leg has passed 0
        highest = x.back();
    }

    Plateau over(double from, double to) const {
        const PiecewiseLinear curve(x, magnitude), clock(x, time);
        const double duration = clock.at(to) - clock.at(from);
        if (!(duration > 0.0))
            throw InvalidInput(fmt::format("the strain goes from {:g} to {:g} in no time", from, to));
        Plateau result{.mean = curve.mean(from, to), .rate = (to - from) / duration, .from = from, .to = to};
        result.highest = std::max(curve.at(from), curve.at(to));
        double sum = 0.0, squares = 0.0;
        int count = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (x[i] < from || x[i] > to) continue;
            result.highest = std::max(result.highest, magnitude[i]);
            const double difference = magnitude[i] - result.mean;
            sum += difference;
            squares += difference * difference;
            ++count;
        }
        if (count > 1) result.deviation = std::sqrt(std::max(0.0, squares - sum * sum / count) / (count - 1));
        return result;
    }

    std::vector<double> x, magnitude;
    std::span<const double> time;
    double lowest, highest;
};

}  // namespace

Plateau plateau(const StrainCurves& curves, const std::string& name, double at, double window) {
    for (const Leg& leg : legs(curves.strain)) {
        const RisingLeg rising(curves, name, leg);
        if (rising.lowest > at || rising.highest < at - 0.1 * window) continue;
        const double from = std::max(at - window, rising.lowest), to = std::min(at + window, rising.highest);
        if (to > from) return rising.over(from, to);
    }
    throw InvalidInput(fmt::format("the strain does not get to {:g}: the largest is {:.4g}; give a smaller --at", at,
                                   largest_strain(curves)));
}

Plateau mean_between(const StrainCurves& curves, const std::string& name, double from, double to) {
    const double slack = 0.05 * (to - from);
    if (to > from)
        for (const Leg& leg : legs(curves.strain)) {
            const RisingLeg rising(curves, name, leg);
            if (rising.lowest <= from + slack && rising.highest >= to - slack)
                return rising.over(std::max(from, rising.lowest), std::min(to, rising.highest));
        }
    throw InvalidInput(
        fmt::format("the strain does not go from {:g} to {:g}: the largest is {:.4g}; give other --from "
                    "and --to",
                    from, to, largest_strain(curves)));
}

}  // namespace tomodem::curves
