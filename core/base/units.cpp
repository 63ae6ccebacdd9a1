#include "core/base/units.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "core/base/error.hpp"

namespace tomodem::units {
namespace {

/// `numerator` of tomodem's units are `denominator` of these: a quotient keeps 2.4um the same number as 0.0024.
struct Unit {
    std::string_view name;
    double numerator;
    double denominator;
};

constexpr Unit lengths[] = {{"nm", 1, 1e6}, {"um", 1, 1e3}, {"µm", 1, 1e3}, {"μm", 1, 1e3},
                            {"mm", 1, 1},   {"cm", 10, 1},  {"m", 1e3, 1}};
constexpr Unit times[] = {{"ms", 1, 1e3}, {"s", 1, 1}, {"min", 60, 1}, {"h", 3600, 1}};
constexpr Unit rates[] = {{"1/s", 1, 1}, {"s^-1", 1, 1}};
constexpr Unit forces[] = {{"uN", 1, 1}, {"µN", 1, 1}, {"μN", 1, 1}, {"mN", 1e3, 1}, {"N", 1e6, 1}};
constexpr Unit stiffnesses[] = {{"uN/mm", 1, 1}, {"µN/mm", 1, 1}, {"μN/mm", 1, 1}, {"N/mm", 1e6, 1}, {"N/m", 1e3, 1}};
constexpr Unit stresses[] = {{"Pa", 1, 1}, {"kPa", 1e3, 1}, {"MPa", 1e6, 1}, {"GPa", 1e9, 1}};
constexpr Unit masses[] = {{"mg", 1, 1e3}, {"g", 1, 1}, {"kg", 1e3, 1}};

/// A measure, the units it may carry, and the two of them that an error offers: `small` and `base` (factor 1).
struct Measure {
    std::string_view name;
    std::span<const Unit> units;
    Unit small;
    Unit base;
    std::string_view gap;  // between number and unit, where the unit itself starts with a digit
};

constexpr Measure length_measure{"length", lengths, {"um", 1, 1e3}, {"mm", 1, 1}, ""};
constexpr Measure time_measure{"time", times, {"ms", 1, 1e3}, {"s", 1, 1}, ""};
constexpr Measure rate_measure{"rate", rates, {"s^-1", 1, 1}, {"1/s", 1, 1}, " "};
constexpr Measure stiffness_measure{"stiffness", stiffnesses, {"N/m", 1e3, 1}, {"uN/mm", 1, 1}, ""};
constexpr Measure force_measure{"force", forces, {"mN", 1e3, 1}, {"uN", 1, 1}, ""};
constexpr Measure stress_measure{"stress", stresses, {"MPa", 1e6, 1}, {"Pa", 1, 1}, ""};
constexpr Measure mass_measure{"mass", masses, {"mg", 1, 1e3}, {"g", 1, 1}, ""};
constexpr Measure measures[] = {length_measure, time_measure,   rate_measure, stiffness_measure,
                                force_measure,  stress_measure, mass_measure};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blank = " \t\r\n";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::string known_units(const Measure& measure) {
    std::string list;
    for (const Unit& unit : measure.units) {
        if (unit.name.substr(0, 2) == "µ" || unit.name.substr(0, 2) == "μ") continue;
        list += (list.empty() ? "" : ", ") + std::string(unit.name);
    }
    return list;
}

double read(std::string_view original, const Measure& measure) {
    std::string_view text = trimmed(original);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string example = fmt::format("1{}{}", measure.gap, measure.base.name);
    if (error == std::errc::result_out_of_range)
        throw InvalidInput(fmt::format("{} '{}' is out of the range of numbers", measure.name, original));
    if (error != std::errc{} || !std::isfinite(value))
        throw InvalidInput(
            fmt::format("{} '{}' is not a number with a unit: write for example {}", measure.name, original, example));

    const std::string_view name = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
    if (name.empty()) {
        const std::string_view number = trimmed(text);
        const double in_base = value * measure.small.numerator / measure.small.denominator;
        throw InvalidInput(fmt::format("{} '{}' has no unit: write for example {}{}{} or {}{}{}", measure.name, number,
                                       number, measure.gap, measure.small.name, in_base, measure.gap,
                                       measure.base.name));
    }
    for (const Unit& unit : measure.units)
        if (unit.name == name) return value * unit.numerator / unit.denominator;
    for (const Measure& other : measures)
        for (const Unit& unit : other.units)
            if (unit.name == name)
                throw InvalidInput(fmt::format("{} '{}': '{}' measures a {}; a {} is given in {}", measure.name,
                                               original, name, other.name, measure.name, known_units(measure)));
    throw InvalidInput(fmt::format("{} '{}': unknown unit '{}'; a {} is given in {}", measure.name, original, name,
                                   measure.name, known_units(measure)));
}

}  // namespace

double length(std::string_view text) {
    return read(text, length_measure);
}
double time(std::string_view text) {
    return read(text, time_measure);
}
double rate(std::string_view text) {
    return read(text, rate_measure);
}
double stiffness(std::string_view text) {
    return read(text, stiffness_measure);
}
double force(std::string_view text) {
    return read(text, force_measure);
}
double stress(std::string_view text) {
    return read(text, stress_measure);
}
double mass(std::string_view text) {
    return read(text, mass_measure);
}

}  // namespace tomodem::units
