#include "tools/mesh_recon/topology.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "core/packing/structure.hpp"

namespace tomodem::mesh_recon {
namespace {

using Centres = std::vector<std::int32_t>;
using Groups = std::vector<Centres>;

Groups parts_of(const FrameTopology& frame) {
    Groups groups(frame.parts.size());
    for (std::size_t i = 0; i < frame.part_of_centre.size(); ++i)
        if (frame.part_of_centre[i] >= 0) groups[frame.part_of_centre[i]].push_back(std::int32_t(i));
    return groups;
}

/// For each group of one frame, those of the other frame that continue it.
struct Links {
    std::vector<std::set<std::int32_t>> after_of, before_of;
};

Links link(const Groups& before, const Groups& after, double min_share) {
    std::map<std::int32_t, Centres> after_at;  // groups that a centre belongs to
    for (std::size_t b = 0; b < after.size(); ++b)
        for (const std::int32_t centre : after[b]) after_at[centre].push_back(std::int32_t(b));
    std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> shared;
    for (std::size_t a = 0; a < before.size(); ++a)
        for (const std::int32_t centre : before[a])
            if (const auto found = after_at.find(centre); found != after_at.end())
                for (const std::int32_t b : found->second) ++shared[{std::int32_t(a), b}];

    std::vector<std::pair<std::size_t, std::int32_t>> best_after(before.size(), {0, -1}),
        best_before(after.size(), {0, -1});
    for (const auto& [pair, count] : shared) {
        const auto [a, b] = pair;
        if (double(count) < min_share * double(std::min(before[a].size(), after[b].size()))) continue;
        if (count > best_after[a].first) best_after[a] = {count, b};
        if (count > best_before[b].first) best_before[b] = {count, a};
    }
    Links links{std::vector<std::set<std::int32_t>>(before.size()), std::vector<std::set<std::int32_t>>(after.size())};
    const auto join = [&](std::int32_t a, std::int32_t b) {
        links.after_of[a].insert(b);
        links.before_of[b].insert(a);
    };
    for (std::size_t a = 0; a < before.size(); ++a)
        if (best_after[a].second >= 0) join(std::int32_t(a), best_after[a].second);
    for (std::size_t b = 0; b < after.size(); ++b)
        if (best_before[b].second >= 0) join(best_before[b].second, std::int32_t(b));
    return links;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double radius(const Body& pore) {
    return std::cbrt(0.75 * pore.volume / std::numbers::pi);
}

/// A pore that grew or shrank by a whole layer has none of its particles around it any more: it lies where the other
/// one is, carried along with the particles around it.
void link_by_place(const FrameTopology& before, const FrameTopology& after, std::span<const Vec3> positions_before,
                   std::span<const Vec3> positions_after, Links& links) {
    struct Near {
        double distance = 1.0;  // in radii of the larger one
        std::int32_t other = -1;
    };
    std::vector<Near> after_of(before.pores.size()), before_of(after.pores.size());
    for (std::size_t a = 0; a < before.pores.size(); ++a) {
        Vec3 moved = before.pores[a].centre;
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> shift;
            for (const std::int32_t centre : before.centres_of_pore[a])
                shift.push_back(positions_after[centre][axis] - positions_before[centre][axis]);
            moved[axis] += median(std::move(shift));
        }
        for (std::size_t b = 0; b < after.pores.size(); ++b) {
            const Vec3 there = after.pores[b].centre;
            const double distance = std::min((there - moved).norm(), (there - before.pores[a].centre).norm()) /
                                    std::max(radius(before.pores[a]), radius(after.pores[b]));
            if (distance < after_of[a].distance) after_of[a] = {distance, std::int32_t(b)};
            if (distance < before_of[b].distance) before_of[b] = {distance, std::int32_t(a)};
        }
    }
    const auto join = [&](std::int32_t a, std::int32_t b) {
        links.after_of[a].insert(b);
        links.before_of[b].insert(a);
    };
    const Links sure = links;
    for (std::size_t a = 0; a < after_of.size(); ++a)
        if (sure.after_of[a].empty() && after_of[a].other >= 0) join(std::int32_t(a), after_of[a].other);
    for (std::size_t b = 0; b < before_of.size(); ++b)
        if (sure.before_of[b].empty() && before_of[b].other >= 0) join(before_of[b].other, std::int32_t(b));
}

Vec3 mean_of(const Centres& centres, std::span<const Vec3> positions) {
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t centre : centres) sum += positions[centre];
    return sum / double(centres.size());
}

/// Where two groups are nearest to each other: the mean over the pairs hardly farther apart than the nearest one.
Vec3 between(const Centres& first, const Centres& second, std::span<const Vec3> positions, double reach) {
    Centres common;
    std::set_intersection(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(common));
    if (!common.empty()) return mean_of(common, positions);
    std::vector<Vec3> points;
    for (const Centres* group : {&first, &second})
        for (const std::int32_t centre : *group) points.push_back(positions[centre]);
    for (const double cutoff : {reach, 2.0 * reach}) {
        const NeighbourTable neighbours(points, Box{}, cutoff);
        double nearest = std::numeric_limits<double>::infinity();
        const auto each_pair = [&](const auto& visit) {
            for (std::size_t i = 0; i < first.size(); ++i)
                for (const std::int32_t j : neighbours.of(i))
                    if (std::size_t(j) >= first.size()) visit(points[i], points[j], (points[j] - points[i]).norm());
        };
        each_pair([&](const Vec3&, const Vec3&, double distance) { nearest = std::min(nearest, distance); });
        if (!std::isfinite(nearest)) continue;
        Vec3 sum = Vec3::Zero();
        std::int64_t count = 0;
        each_pair([&](const Vec3& a, const Vec3& b, double distance) {
            if (distance > nearest + 0.25 * reach) return;
            sum += 0.5 * (a + b);
            ++count;
        });
        return sum / double(count);
    }
    return 0.5 * (mean_of(first, positions) + mean_of(second, positions));
}

/// One event for each of several groups but the largest, which meets or leaves all the larger ones.
void add_joins(Change change, const std::set<std::int32_t>& several, const std::vector<Body>& bodies,
               const Groups& groups, std::span<const Vec3> positions, double reach, Event event,
               std::vector<Event>& events) {
    if (several.size() < 2) return;
    Centres larger = groups[*several.begin()];  // sorted by volume
    for (auto it = std::next(several.begin()); it != several.end(); ++it) {
        event.change = change;
        event.volume = bodies[*it].volume;
        event.place = between(groups[*it], larger, positions, reach);
        events.push_back(event);
        Centres all;
        std::set_union(larger.begin(), larger.end(), groups[*it].begin(), groups[*it].end(), std::back_inserter(all));
        larger = std::move(all);
    }
}

std::vector<std::int32_t> list(const std::set<std::int32_t>& numbers) {
    return {numbers.begin(), numbers.end()};
}

bool mostly(const Centres& centres, const std::vector<bool>& flag) {
    const auto count = std::count_if(centres.begin(), centres.end(), [&](std::int32_t centre) { return flag[centre]; });
    return 2 * count >= std::int64_t(centres.size());
}

}  // namespace

const char* name_of(Change change) {
    switch (change) {
        case Change::merge:
            return "merge";
        case Change::split:
            return "split";
        case Change::part_appeared:
            return "part_appeared";
        case Change::part_vanished:
            return "part_vanished";
        case Change::coalescence:
            return "coalescence";
        case Change::pore_split:
            return "pore_split";
        case Change::pore_opened:
            return "pore_opened";
        case Change::pore_closed:
            return "pore_closed";
        case Change::pore_breached:
            return "pore_breached";
        case Change::pore_sealed:
            return "pore_sealed";
    }
    return "";
}

FrameTopology frame_topology(AlphaSurface surface, const MinSizes& min) {
    FrameTopology frame;
    frame.b0 = std::int64_t(surface.bodies.size());
    frame.b2 = std::int64_t(surface.pores.size());
    frame.volume = surface.volume;
    std::vector<std::int32_t> kept(surface.bodies.size(), -1);
    for (std::size_t i = 0; i < surface.bodies.size(); ++i) {
        frame.b1 += surface.bodies[i].genus;
        if (surface.bodies[i].particles < min.particles) continue;
        kept[i] = std::int32_t(frame.parts.size());
        frame.parts.push_back(surface.bodies[i]);
    }
    frame.part_of_centre = std::move(surface.body_of_centre);
    for (std::int32_t& part : frame.part_of_centre)
        if (part >= 0) part = kept[part];
    for (std::size_t i = 0; i < surface.pores.size(); ++i) {
        const Body& pore = surface.pores[i];
        frame.pore_volume += pore.volume;
        const double size = std::isnan(pore.corrected_volume) ? pore.volume : pore.corrected_volume;
        if (size < min.pore * surface.inside_volume) continue;
        frame.pores.push_back(pore);
        frame.centres_of_pore.push_back(std::move(surface.centres_of_pore[i]));
    }
    frame.outside = std::move(surface.outside);
    return frame;
}

std::vector<Event> events_between(const FrameTopology& before, const FrameTopology& after,
                                  std::span<const Vec3> positions_before, std::span<const Vec3> positions_after,
                                  double reach) {
    std::vector<Event> events;
    const Groups parts_before = parts_of(before), parts_after = parts_of(after);
    const Links parts = link(parts_before, parts_after, 0.5);
    Links pores = link(before.centres_of_pore, after.centres_of_pore, 0.3);
    link_by_place(before, after, positions_before, positions_after, pores);

    for (std::size_t b = 0; b < parts_after.size(); ++b)
        add_joins(Change::merge, parts.before_of[b], before.parts, parts_before, positions_after, reach,
                  {.change = {}, .before = list(parts.before_of[b]), .after = {std::int32_t(b)}}, events);
    for (std::size_t a = 0; a < parts_before.size(); ++a)  // where they still held together
        add_joins(Change::split, parts.after_of[a], after.parts, parts_after, positions_before, reach,
                  {.change = {}, .before = {std::int32_t(a)}, .after = list(parts.after_of[a])}, events);
    for (std::size_t b = 0; b < parts_after.size(); ++b)
        if (parts.before_of[b].empty())
            events.push_back(
                {Change::part_appeared, after.parts[b].centre, after.parts[b].volume, {}, {std::int32_t(b)}});
    for (std::size_t a = 0; a < parts_before.size(); ++a)
        if (parts.after_of[a].empty())
            events.push_back(
                {Change::part_vanished, before.parts[a].centre, before.parts[a].volume, {std::int32_t(a)}, {}});

    for (std::size_t b = 0; b < after.pores.size(); ++b)
        add_joins(Change::coalescence, pores.before_of[b], before.pores, before.centres_of_pore, positions_after, reach,
                  {.change = {}, .before = list(pores.before_of[b]), .after = {std::int32_t(b)}}, events);
    for (std::size_t a = 0; a < before.pores.size(); ++a)
        add_joins(Change::pore_split, pores.after_of[a], after.pores, after.centres_of_pore, positions_before, reach,
                  {.change = {}, .before = {std::int32_t(a)}, .after = list(pores.after_of[a])}, events);
    for (std::size_t b = 0; b < after.pores.size(); ++b) {
        if (!pores.before_of[b].empty()) continue;
        const bool was_outside = mostly(after.centres_of_pore[b], before.outside);
        events.push_back({was_outside ? Change::pore_sealed : Change::pore_opened,
                          after.pores[b].centre,
                          after.pores[b].volume,
                          {},
                          {std::int32_t(b)}});
    }
    for (std::size_t a = 0; a < before.pores.size(); ++a) {
        if (!pores.after_of[a].empty()) continue;
        const bool is_outside = mostly(before.centres_of_pore[a], after.outside);
        events.push_back({is_outside ? Change::pore_breached : Change::pore_closed,
                          before.pores[a].centre,
                          before.pores[a].volume,
                          {std::int32_t(a)},
                          {}});
    }
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.change < b.change; });
    return events;
}

}  // namespace tomodem::mesh_recon
