#include "tools/render/cut.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/base/error.hpp"
#include "core/surface/pore_search.hpp"

namespace tomodem::render {
namespace {

constexpr std::size_t many_particles = 200000;
/// Places that are tried along an axis, between these shares of the sample's extent.
constexpr int places = 65;
constexpr double first_share = 0.1, last_share = 0.9;
/// An area that is so near to the largest is as good.
constexpr double as_good = 0.98;

/// Of the spheres around these centres, in the plane across the axis [mm^2].
double area_of_spheres(const std::vector<Vec3>& centres, double radius, int axis, double place) {
    double sum = 0.0;
    for (const Vec3& centre : centres)
        sum += std::max(0.0, radius * radius - (centre[axis] - place) * (centre[axis] - place));
    return std::numbers::pi * sum;
}

/// Inside closed surfaces, in the plane across the axis [mm^2]: the sum over the triangles that it cuts of the area
/// between the cut and the axis, each with the sign of its side (Green's theorem).
double area_inside(const TriangleMesh& mesh, int axis, double place) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double doubled = 0.0;
    for (const auto& triangle : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            // The corner that lies alone on its side; the cut goes through the two edges that end there.
            const Vec3& alone = mesh.vertices[triangle[k]];
            const Vec3& second = mesh.vertices[triangle[(k + 1) % 3]];
            const Vec3& third = mesh.vertices[triangle[(k + 2) % 3]];
            const bool above = alone[axis] > place;
            if ((second[axis] > place) == above || (third[axis] > place) == above) continue;
            const auto at = [&](const Vec3& other) {
                return Vec3(alone + (place - alone[axis]) / (other[axis] - alone[axis]) * (other - alone));
            };
            const Vec3 from = at(second), to = at(third);
            const double part = from[u] * to[v] - to[u] * from[v];
            doubled += above ? part : -part;
        }
    }
    return std::abs(doubled) / 2.0;
}

std::vector<Vec3> particles_of_features(const Packing& packing) {
    std::map<std::int32_t, std::size_t> count;
    for (const std::int32_t label : packing.species) ++count[label];
    const auto matrix =
        std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const bool objects =
        std::any_of(packing.object.begin(), packing.object.end(), [](std::int32_t number) { return number > 0; });
    std::vector<Vec3> found;
    for (std::size_t k = 0; k < packing.size(); ++k)
        if (objects ? packing.object[k] > 0 : packing.species[k] != matrix->first) found.push_back(packing.position[k]);
    return found;
}

/// Whether there is more void than solid in the box around the particles; in solid, spheres fill two thirds of the
/// space.
bool is_open(const Packing& packing) {
    constexpr double half_of_solid = 0.33;
    Vec3 low = packing.position.front(), high = low;
    for (const Vec3& centre : packing.position) low = low.cwiseMin(centre), high = high.cwiseMax(centre);
    const Vec3 edges = (high - low).array() + 2 * packing.seed_radius;
    const double spheres =
        4.0 / 3.0 * std::numbers::pi * std::pow(packing.seed_radius, 3) * static_cast<double>(packing.size());
    return spheres < half_of_solid * edges.prod();
}

/// Nothing where the packing is too small or too flat to have pores.
Pores pores_of(const Packing& packing, bool with_lid) {
    PoreSearch search{.probe_radius = default_probe_radius(packing.seed_radius), .seed_radius = packing.seed_radius};
    const double lid_radius = default_lid_radius(packing.position, false);
    if (with_lid && lid_radius >= 2.0 * search.probe_radius) search.lid_radius = lid_radius;
    try {
        return find_pores(packing.position, search);
    } catch (const InvalidInput&) {
        return {};
    }
}

}  // namespace

CutPlane best_cut(const Packing& packing) {
    std::vector<Vec3> features = particles_of_features(packing);
    double radius = packing.seed_radius;
    const bool many = packing.size() > many_particles;
    Pores pores;
    if (features.empty() && is_open(packing)) {
        features = packing.position;
        radius *= 3;  // the mean over three diameters: a layer of particles is no strut
    } else if (!many || features.empty()) {
        pores = pores_of(packing, !many);
    }

    struct Candidate {
        CutPlane plane;
        double from_middle, area;
    };
    std::vector<Candidate> candidates;
    for (const Cut cut : {Cut::y, Cut::x}) {
        const int axis = CutPlane{cut}.axis();
        const auto [low, high] =
            std::minmax_element(packing.position.begin(), packing.position.end(),
                                [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
        for (int k = 0; k < places; ++k) {
            const double share = first_share + (last_share - first_share) * k / (places - 1.0);
            const double place = (*low)[axis] + share * ((*high)[axis] - (*low)[axis]);
            candidates.push_back(
                {{cut, place},
                 std::abs(share - 0.5),
                 area_of_spheres(features, radius, axis, place) + area_inside(pores.surface.mesh, axis, place)});
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.from_middle < b.from_middle; });
    double largest = 0.0;
    for (const Candidate& one : candidates) largest = std::max(largest, one.area);
    return std::find_if(candidates.begin(), candidates.end(),
                        [&](const Candidate& one) { return one.area >= as_good * largest; })
        ->plane;
}

}  // namespace tomodem::render
