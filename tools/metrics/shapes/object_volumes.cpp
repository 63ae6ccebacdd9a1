#include "tools/metrics/shapes/object_volumes.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace tomodem::shapes {
namespace {

/// Volume and number of the particles that are at least so deep inside.
struct Inside {
    std::array<double, deepest_centre + 1> volume{};
    std::array<double, deepest_centre + 1> particles{};

    void add(double share, int depth) {
        for (int d = 0; d <= depth; ++d) {
            volume[d] += share;
            particles[d] += 1.0;
        }
    }
    /// Mean share of the deepest that are enough: 50, and 0.3 of all inside. 0: there are not so many.
    double mean() const {
        const double enough = std::max(50.0, 0.3 * particles[1]);
        for (int d = deepest_centre; d > 0; --d)
            if (particles[d] >= enough) return volume[d] / particles[d];
        return 0.0;
    }
};

/// Next to a void the shares are too small, and next to those they are too.
constexpr int min_depth = 2;

}  // namespace

AlphaSurface surface_of_all(std::span<const Vec3> position, double seed_radius) {
    return alpha_surface(position, {.probe_radius = default_probe_radius(seed_radius), .seed_radius = seed_radius});
}

const char* name_of(ShareOf share) {
    switch (share) {
        case ShareOf::all:
            return "all";
        case ShareOf::inside:
            return "inside";
        case ShareOf::species:
            return "species";
        case ShareOf::box:
            break;
    }
    return "box";
}

std::vector<ObjectVolume> object_volumes(const AlphaSurface& surface, std::span<const Object> objects,
                                         double box_share) {
    std::vector<Inside> own(objects.size());
    std::map<std::int32_t, Inside> of_species;
    for (std::size_t k = 0; k < objects.size() && !surface.share.empty(); ++k)
        for (const std::size_t i : objects[k].members) {
            own[k].add(surface.share[i], surface.depth[i]);
            of_species[objects[k].species].add(surface.share[i], surface.depth[i]);
        }
    std::vector<ObjectVolume> volumes;
    for (std::size_t k = 0; k < objects.size(); ++k) {
        const double count = double(objects[k].members.size());
        if (own[k].particles[min_depth] == count)
            volumes.push_back({own[k].volume[min_depth], ShareOf::all});
        else if (own[k].particles[min_depth] >= 50 && own[k].mean() > 0.0)
            volumes.push_back({count * own[k].mean(), ShareOf::inside});
        else if (const double mean = of_species[objects[k].species].mean(); mean > 0.0)
            volumes.push_back({count * mean, ShareOf::species});
        else
            volumes.push_back({count * box_share, ShareOf::box});
    }
    return volumes;
}

}  // namespace tomodem::shapes
