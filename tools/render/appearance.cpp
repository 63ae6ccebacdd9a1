#include "tools/render/appearance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tomodem::render {
namespace {

constexpr std::array<Rgb, 7> okabe_ito{Rgb{213, 94, 0},    Rgb{0, 114, 178},  Rgb{0, 158, 115}, Rgb{230, 159, 0},
                                       Rgb{204, 121, 167}, Rgb{86, 180, 233}, Rgb{240, 228, 66}};

std::map<std::int32_t, std::int64_t> particles_of_phases(const Packing& packing) {
    std::map<std::int32_t, std::int64_t> count;
    for (const auto label : packing.species) ++count[label];
    return count;
}

}  // namespace

std::map<std::int32_t, Rgb> phase_colours(const Packing& packing) {
    const auto count = particles_of_phases(packing);
    const auto largest =
        std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    std::map<std::int32_t, Rgb> colours;
    std::size_t next = 0;
    for (const auto& [label, particles] : count)
        colours[label] = label == largest->first ? skin_colour : okabe_ito[next++ % okabe_ito.size()];
    return colours;
}

Rgb object_colour(std::int32_t object) {
    if (object == 0) return skin_colour;
    // Seven hues at three lightnesses: 21 objects before a colour comes again.
    const std::size_t number = static_cast<std::size_t>(object - 1);
    const Rgb hue = okabe_ito[number % okabe_ito.size()];
    const double lightness = std::array{1.0, 0.72, 1.3}[number / okabe_ito.size() % 3];
    const auto scaled = [&](std::uint8_t value) {
        const double result = lightness <= 1 ? value * lightness : 255 - (255 - value) * (2 - lightness);
        return static_cast<std::uint8_t>(result);
    };
    return {scaled(hue.red), scaled(hue.green), scaled(hue.blue)};
}

std::vector<LegendEntry> phase_legend(const Packing& packing, const std::map<std::int32_t, std::string>& names,
                                      std::optional<std::int32_t> only_species) {
    std::vector<LegendEntry> legend;
    const auto colours = phase_colours(packing);
    for (const auto& [label, particles] : particles_of_phases(packing)) {
        if (only_species && label != *only_species) continue;
        const auto name = names.find(label);
        const double share = 100.0 * static_cast<double>(particles) / static_cast<double>(packing.size());
        const std::string text = name != names.end() ? name->second : fmt::format("label {}", label);
        legend.push_back({colours.at(label), fmt::format("{}  {:.1f} %", text, share)});
    }
    return legend;
}

void RangeFinder::add(std::vector<double> values) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return;
    const auto at = [&](std::size_t place) {
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place), values.end());
        return values[place];
    };
    const std::size_t last = values.size() - 1, outliers = last / 100;
    const double low = at(outliers), high = at(last - outliers), min = at(0), max = at(last);
    low_ = any_ ? std::min(low_, low) : low;
    high_ = any_ ? std::max(high_, high) : high;
    min_ = any_ ? std::min(min_, min) : min;
    max_ = any_ ? std::max(max_, max) : max;
    any_ = true;
}

std::optional<ColourRange> RangeFinder::range(const std::optional<std::pair<double, double>>& ends) const {
    if (!any_) return std::nullopt;
    ColourRange range{ends ? ends->first : low_, ends ? ends->second : high_};
    if (range.low < 0 && range.high > 0) {
        range.map = ColourMap::diverging;
        if (!ends) {
            range.high = std::max(-range.low, range.high);
            range.low = -range.high;
        }
    }
    if (range.low == range.high) {  // one value everywhere is in the middle
        const double around = range.low == 0 ? 1 : 0.01 * std::abs(range.low);
        range.low -= around;
        range.high += around;
    }
    range.lower_values = min_ < range.low;
    range.higher_values = max_ > range.high;
    return range;
}

std::vector<Rgb> value_colours(const std::vector<double>& values, const ColourRange& range) {
    std::vector<Rgb> colours;
    colours.reserve(values.size());
    for (const double value : values)
        colours.push_back(std::isfinite(value) ? colour_at(range.map, (value - range.low) / (range.high - range.low))
                                               : Rgb{150, 150, 150});
    return colours;
}

namespace {

struct DisplayUnit {
    std::string name;
    double factor;  ///< of the file's unit in one of it
};

DisplayUnit display_unit(double largest, const std::string& unit) {
    std::vector<DisplayUnit> units;
    if (unit == "Pa") units = {{"GPa", 1e9}, {"MPa", 1e6}, {"kPa", 1e3}, {"Pa", 1}};
    if (unit == "mm") units = {{"m", 1e3}, {"mm", 1}, {"µm", 1e-3}, {"nm", 1e-6}};
    for (const DisplayUnit& one : units)
        if (largest >= 0.9995 * one.factor) return one;
    return units.empty() ? DisplayUnit{unit, 1} : units.back();
}

}  // namespace

ColourBar colour_bar_of(const ColourRange& range, const std::string& title, const std::string& unit) {
    const DisplayUnit display = display_unit(std::max(std::abs(range.low), std::abs(range.high)), unit);
    return {.map = range.map,
            .low = range.low / display.factor,
            .high = range.high / display.factor,
            .title = display.name.empty() ? title : fmt::format("{} [{}]", title, display.name),
            .lower_values = range.lower_values,
            .higher_values = range.higher_values};
}

std::string value_text(double value, const std::string& unit) {
    const DisplayUnit display = display_unit(std::abs(value), unit);
    return fmt::format("{:.3g}{}{}", value / display.factor, display.name.empty() ? "" : " ", display.name);
}

}  // namespace tomodem::render
