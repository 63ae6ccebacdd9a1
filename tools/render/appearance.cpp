#include "tools/render/appearance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "core/error.hpp"

namespace tomodem {
namespace {

constexpr Rgb light_grey{203, 208, 214};
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
    const auto most =
        std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    std::map<std::int32_t, Rgb> colours;
    std::size_t next = 0;
    for (const auto& [label, particles] : count)
        colours[label] = label == most->first ? light_grey : okabe_ito[next++ % okabe_ito.size()];
    return colours;
}

Rgb object_colour(std::int32_t object) {
    if (object == 0) return light_grey;
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

Box bounds(const std::vector<Vec3>& centres, double radius) {
    if (centres.empty()) throw InvalidInput("there is nothing to draw: no particles");
    Vec3 low = centres.front(), high = centres.front();
    for (const Vec3& centre : centres) {
        low = low.cwiseMin(centre);
        high = high.cwiseMax(centre);
    }
    return {.origin = low.array() - radius, .edges = (high - low).array() + 2 * radius};
}

Box bounds_of_run(const RunReader& run) {
    const double radius = run.packing().seed_radius;
    const Box first = bounds(run.packing().position, radius);
    if (run.frame_count() < 2) return first;
    const Box last = bounds(run.frame(run.frame_count() - 1).position, radius);
    const Vec3 low = first.origin.cwiseMin(last.origin);
    const Vec3 high = (first.origin + first.edges).cwiseMax(last.origin + last.edges);
    return {.origin = low, .edges = high - low};
}

View view_of(const Box& region, Cut cut) {
    const Vec3 direction = cut == Cut::x ? Vec3(1.0, -0.55, 0.5) : Vec3(0.55, -1.0, 0.5);
    return {.towards_camera = direction, .low = region.origin, .high = region.origin + region.edges};
}

void show(const Packing& packing, const std::vector<Vec3>& positions, const Vec3& middle, const Appearance& appearance,
          Picture& picture) {
    if (appearance.colour == ColourBy::object && packing.object.empty())
        throw InvalidInput(
            "the packing does not tell objects apart; make it with vol2pack --objects, or colour by phase");
    const auto colours = phase_colours(packing);
    const auto count = particles_of_phases(packing);
    if (appearance.only_species && !count.contains(*appearance.only_species)) {
        std::vector<std::int32_t> labels;
        for (const auto& [label, particles] : count) labels.push_back(label);
        throw InvalidInput(fmt::format("no particle has label {}; the packing has {}", *appearance.only_species,
                                       fmt::join(labels, ", ")));
    }

    std::set<std::int32_t> objects;
    for (std::size_t k = 0; k < packing.size(); ++k) {
        const std::int32_t label = packing.species[k];
        if (appearance.only_species && label != *appearance.only_species) continue;
        if (!packing.object.empty()) objects.insert(packing.object[k]);
        if (appearance.cut == Cut::x && positions[k].x() > middle.x()) continue;
        if (appearance.cut == Cut::y && positions[k].y() < middle.y()) continue;
        picture.centres.push_back(positions[k]);
        picture.colours.push_back(appearance.colour == ColourBy::phase    ? colours.at(label)
                                  : appearance.colour == ColourBy::object ? object_colour(packing.object[k])
                                                                          : light_grey);
    }
    if (picture.centres.empty()) throw InvalidInput("there is nothing to draw: the cut leaves no particle");
    picture.radius = packing.seed_radius;

    objects.erase(0);
    if (appearance.colour == ColourBy::object) picture.caption = fmt::format("{} objects", objects.size());
    if (appearance.colour != ColourBy::phase) return;
    for (const auto& [label, particles] : count) {
        if (appearance.only_species && label != *appearance.only_species) continue;
        const auto name = appearance.names.find(label);
        const double share = 100.0 * static_cast<double>(particles) / static_cast<double>(packing.size());
        const std::string text = name != appearance.names.end() ? name->second : fmt::format("label {}", label);
        picture.legend.push_back({colours.at(label), fmt::format("{}  {:.1f} %", text, share)});
    }
}

}  // namespace tomodem
