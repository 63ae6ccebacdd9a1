#include "core/surface/pore_search.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/packing/structure.hpp"
#include "core/surface/envelope.hpp"
#include "core/surface/filling.hpp"

namespace tomodem {
namespace {

/// Spacing of the points of a lid and distance of its two layers, in probe radii: no ball of the probe's radius passes.
constexpr double lid_spacing = 0.7;

/// Triangles of a surface, cut in two at their longest edge until none is longer than a spacing; neighbours share the
/// points of the edge between them.
class Subdivision {
 public:
    Subdivision(const TriangleMesh& mesh, const std::vector<Vec3>& normal, double spacing)
        : point(mesh.vertices), normal(normal), spacing_(spacing) {}

    void divide(const std::array<std::int32_t, 3>& triangle) {
        int longest = 0;
        double length = 0.0;
        for (int k = 0; k < 3; ++k)
            if (const double edge = (point[triangle[(k + 1) % 3]] - point[triangle[k]]).norm(); edge > length)
                longest = k, length = edge;
        if (length <= spacing_) return;
        const std::int32_t a = triangle[longest], b = triangle[(longest + 1) % 3], c = triangle[(longest + 2) % 3];
        const std::int32_t middle = middle_of(a, b);
        divide({a, middle, c});
        divide({middle, b, c});
    }

    std::vector<Vec3> point, normal;

 private:
    std::int32_t middle_of(std::int32_t a, std::int32_t b) {
        const auto [entry, added] = middle_.try_emplace(std::minmax(a, b), std::int32_t(point.size()));
        if (added) {
            point.push_back(0.5 * (point[a] + point[b]));
            normal.push_back((normal[a] + normal[b]).normalized());
        }
        return entry->second;
    }

    double spacing_;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle_;
};

struct Lid {
    std::vector<Vec3> points;    ///< on the surface, besides the centres
    std::vector<Vec3> covering;  ///< above it
};

Lid lay_lid(const AlphaSurface& rolled, double probe_radius) {
    const TriangleMesh& mesh = rolled.mesh;
    std::vector<Vec3> normal(mesh.vertices.size(), Vec3::Zero());
    std::vector<std::array<std::int32_t, 3>> outside;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (rolled.pore_of_triangle[t] >= 0) continue;
        outside.push_back(mesh.triangles[t]);
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 across = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        for (const std::int32_t v : {a, b, c}) normal[v] += across;
    }
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& triangle : outside)
        for (const std::int32_t v : triangle) used[v] = true;
    for (Vec3& n : normal) n.normalize();

    Subdivision fine(mesh, normal, lid_spacing * probe_radius);
    for (const auto& triangle : outside) fine.divide(triangle);
    Lid lid;
    for (std::size_t v = 0; v < fine.point.size(); ++v) {
        const bool added = v >= mesh.vertices.size();
        if (!added && !used[v]) continue;
        if (added) lid.points.push_back(fine.point[v]);
        lid.covering.push_back(fine.point[v] + lid_spacing * probe_radius * fine.normal[v]);
    }
    return lid;
}

/// Volume up to where the material ends: the walls lose the layer of envelope_bias(), the mouth nothing.
double corrected(const Pore& pore, double seed_radius, double inside_volume) {
    if (!(seed_radius > 0.0) || !(inside_volume > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    const double sphere = 4.0 / 3.0 * std::numbers::pi * std::pow(seed_radius, 3);
    const double across = 3.0 * pore.body.volume / (pore.body.area * seed_radius);
    const double bias = std::max(0.0, envelope_bias({seed_radius, sphere / inside_volume}, across));
    return std::max(0.0, pore.body.volume - bias * (pore.body.area - pore.mouth));
}

/// What the solid and the closed pores leave of the convex hull, to the pores with a mouth by their volumes.
void share_the_hull(const Filling& filling, Pores& pores) {
    if (!(filling.solid > 0.0)) return;
    double left = filling.hull - filling.solid, open = 0.0;
    for (const Pore& pore : pores.pores)
        if (pore.mouth > 0.0)
            open += pore.body.volume;
        else
            left -= pore.body.corrected_volume;
    for (Pore& pore : pores.pores)
        if (pore.mouth > 0.0) pore.body.corrected_volume = std::max(0.0, left) * pore.body.volume / open;
}

std::function<void(double)> share_of(const std::function<void(double)>& progress, double from, double to) {
    if (!progress) return {};
    return [=](double done) { progress(from + done * (to - from)); };
}

void require_lid(const PoreSearch& search) {
    if (search.lid_radius < 2.0 * search.probe_radius)
        throw InvalidInput(
            fmt::format("a lid of {:g} mm is too small for a probe of {:g} mm: give twice the probe's "
                        "radius or more",
                        search.lid_radius, search.probe_radius));
}

}  // namespace

double Pore::sphericity() const {
    // Of a smooth surface over the envelope through its centres, whatever the pore's size (docs/measures.md).
    constexpr double smooth = 0.87;
    return std::cbrt(std::numbers::pi) * std::pow(6.0 * body.volume, 2.0 / 3.0) / (smooth * body.area);
}

double Pores::volume() const {
    double sum = 0.0;
    for (auto pore = pores.rbegin(); pore != pores.rend(); ++pore) sum += pore->body.volume;
    return sum;
}

double Pores::corrected_volume() const {
    double sum = 0.0;
    for (auto pore = pores.rbegin(); pore != pores.rend(); ++pore) sum += pore->body.corrected_volume;
    return sum;
}

double Pores::mouth() const {
    double sum = 0.0;
    for (auto pore = pores.rbegin(); pore != pores.rend(); ++pore) sum += pore->mouth;
    return sum;
}

double default_lid_radius(std::span<const Vec3> centres, bool open_structure) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vec3& centre : centres) low = low.cwiseMin(centre), high = high.cwiseMax(centre);
    return open_structure ? 10.0 * (high - low).maxCoeff() : 0.5 * (high - low).minCoeff();
}

void Pores::leave_out_below(double min_volume) {
    const auto first_out =
        std::find_if(pores.begin(), pores.end(), [&](const Pore& pore) { return pore.body.volume < min_volume; });
    const auto kept = std::int32_t(first_out - pores.begin());
    pores.erase(first_out, pores.end());
    std::vector<std::int32_t> number = surface.number;
    for (std::int32_t& n : number)
        if (n >= kept) n = -1;
    surface = surface_part(surface.mesh, number);
}

std::vector<std::int64_t> lasting_numbers(const Pores& now, const Pores& before,
                                          const std::vector<std::int64_t>& numbers_before, std::int64_t& next) {
    constexpr double min_shared = 0.2;
    std::vector<bool> taken(before.pores.size(), false);
    std::vector<std::int64_t> numbers;
    std::vector<std::int32_t> common;
    for (const Pore& pore : now.pores) {
        double best = min_shared;
        std::size_t partner = before.pores.size();
        for (std::size_t k = 0; k < before.pores.size(); ++k) {
            if (taken[k]) continue;
            const std::vector<std::int32_t>& other = before.pores[k].around;
            common.clear();
            std::set_intersection(pore.around.begin(), pore.around.end(), other.begin(), other.end(),
                                  std::back_inserter(common));
            const double shared = double(common.size()) / double(std::min(pore.around.size(), other.size()));
            if (shared > best) best = shared, partner = k;
        }
        if (partner < before.pores.size()) taken[partner] = true;
        numbers.push_back(partner < before.pores.size() ? numbers_before[partner] : next++);
    }
    return numbers;
}

Pores find_pores(std::span<const Vec3> centres, const PoreSearch& search) {
    const bool lids = search.lid_radius > 0.0;
    std::vector<Vec3> points(centres.begin(), centres.end());
    std::vector<bool> on_lid(centres.size(), false);
    if (lids) {
        require_lid(search);
        const AlphaSurface rolled = alpha_surface(
            centres, {.probe_radius = search.lid_radius, .progress = share_of(search.progress, 0.0, 0.5)});
        const Lid lid = lay_lid(rolled, search.probe_radius);
        for (std::size_t i = 0; i < centres.size(); ++i) on_lid[i] = rolled.outside[i];
        points.insert(points.end(), lid.points.begin(), lid.points.end());
        points.insert(points.end(), lid.covering.begin(), lid.covering.end());
    }
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = search.probe_radius,
                                                        .progress = share_of(search.progress, lids ? 0.5 : 0.0, 1.0),
                                                        .seed_radius = search.seed_radius,
                                                        .auxiliary = points.size() - centres.size()});
    Pores result;
    for (std::size_t k = 0; k < surface.pores.size(); ++k) {
        Pore& pore = result.pores.emplace_back(Pore{surface.pores[k]});
        const auto& around = surface.centres_of_pore[k];
        pore.around.assign(around.begin(),
                           std::lower_bound(around.begin(), around.end(), std::int32_t(centres.size())));
        pore.body.particles = std::int64_t(pore.around.size());
    }
    on_lid.resize(points.size(), true);
    for (std::size_t t = 0; lids && t < surface.mesh.triangles.size(); ++t) {
        const std::int32_t k = surface.pore_of_triangle[t];
        if (k < 0) continue;
        int of_lid = 0, at_lid = 0;
        for (const std::int32_t vertex : surface.mesh.triangles[t]) {
            const std::int32_t point = surface.centre_of_vertex[vertex];
            of_lid += point >= std::int32_t(centres.size());
            at_lid += point >= 0 && on_lid[point];
        }
        if (of_lid == 0) continue;
        const auto& [a, b, c] = surface.mesh.triangles[t];
        const Vec3& origin = surface.mesh.vertices[a];
        const double area = (surface.mesh.vertices[b] - origin).cross(surface.mesh.vertices[c] - origin).norm() / 2.0;
        result.pores[k].mouth += area * at_lid / 3.0;  // those at the rim lean on the wall
    }
    const Filling filling = search.seed_radius > 0.0 ? filling_of(centres, search.seed_radius) : Filling();
    const double particle = filling.particle > 0.0 ? filling.particle : surface.inside_volume;
    for (Pore& pore : result.pores) pore.body.corrected_volume = corrected(pore, search.seed_radius, particle);
    result.surface = pore_surface(surface);
    result.solid = double(centres.size()) * particle;
    if (search.open_structure) share_the_hull(filling, result);
    return result;
}

double probe_difference(std::span<const Vec3> centres, double small_probe, double large_probe) {
    if (!(large_probe > small_probe))
        throw InvalidInput(fmt::format("the large probe ({:g} mm) is not larger than the small one ({:g} mm)",
                                       large_probe, small_probe));
    return alpha_surface(centres, {.probe_radius = large_probe}).volume -
           alpha_surface(centres, {.probe_radius = small_probe}).volume;
}

std::vector<Vec3> outward_vectors(std::span<const Vec3> centres, double reach, int threads) {
    const NeighbourTable neighbours(centres, Box{Vec3::Zero(), Vec3::Ones()}, reach, threads);
    std::vector<Vec3> outward(centres.size(), Vec3::Zero());
    for (std::size_t i = 0; i < centres.size(); ++i)
        for (const std::int32_t j : neighbours.of(i)) outward[i] -= centres[j] - centres[i];
    return outward;
}

Pores pores_by_outward_vectors(std::span<const Vec3> centres, std::span<const Vec3> outward, double min_outward,
                               const PoreSearch& search) {
    require_lid(search);
    const AlphaSurface rolled = alpha_surface(centres, {.probe_radius = search.lid_radius,
                                                        .progress = share_of(search.progress, 0.0, 0.7),
                                                        .seed_radius = search.seed_radius});
    std::vector<bool> exterior = rolled.outside;
    const NeighbourTable neighbours(centres, Box{Vec3::Zero(), Vec3::Ones()}, 2.0 * search.probe_radius);
    for (std::size_t i = 0; i < centres.size(); ++i)
        if (rolled.outside[i])
            for (const std::int32_t j : neighbours.of(i)) exterior[j] = true;

    Pores result;
    result.solid = double(centres.size()) * rolled.inside_volume;
    std::vector<Vec3> walls;
    std::vector<std::int32_t> centre_of_wall;
    for (std::size_t i = 0; i < centres.size(); ++i)
        if (outward[i].norm() > min_outward && !exterior[i]) {
            walls.push_back(centres[i]);
            centre_of_wall.push_back(std::int32_t(i));
        }
    AlphaSurface surface;
    try {
        surface = alpha_surface(walls,
                                {.probe_radius = search.probe_radius, .progress = share_of(search.progress, 0.7, 1.0)});
    } catch (const InvalidInput&) {
        return result;  // too few particles, or too far apart
    }
    // The outer surface of each body: what lies within it is all its own.
    std::vector<std::int32_t> body_of_outer(surface.mesh.triangles.size(), -1);
    for (std::size_t t = 0; t < body_of_outer.size(); ++t)
        if (surface.pore_of_triangle[t] < 0) body_of_outer[t] = surface.body_of_triangle[t];
    std::vector<Pore> within;
    for (const Body& body : surface.bodies) {
        Pore& pore = within.emplace_back(Pore{body});
        pore.body.volume = pore.body.area = 0.0;
        pore.body.corrected_volume = std::numeric_limits<double>::quiet_NaN();
    }
    for (std::size_t t = 0; t < body_of_outer.size(); ++t) {
        if (body_of_outer[t] < 0) continue;
        Body& body = within[body_of_outer[t]].body;
        const auto& [a, b, c] = surface.mesh.triangles[t];
        const auto& at = surface.mesh.vertices;
        const Vec3 across = (at[b] - at[a]).cross(at[c] - at[a]);
        body.volume += (at[a] - body.centre).dot(across) / 6.0;
        body.area += across.norm() / 2.0;
    }
    for (std::size_t i = 0; i < walls.size(); ++i)
        if (surface.body_of_centre[i] >= 0) within[surface.body_of_centre[i]].around.push_back(centre_of_wall[i]);
    std::vector<std::int32_t> order(within.size()), place(within.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t a, std::int32_t b) { return within[a].body.volume > within[b].body.volume; });
    for (std::size_t k = 0; k < order.size(); ++k) {
        place[order[k]] = std::int32_t(k);
        result.pores.push_back(within[order[k]]);
    }
    for (std::int32_t& number : body_of_outer)
        if (number >= 0) number = place[number];
    result.surface = surface_part(surface.mesh, body_of_outer);
    return result;
}

}  // namespace tomodem
