#include "tools/metrics/object_volumes.hpp"

#include "core/error.hpp"
#include "tools/mesh_recon/alpha_surface.hpp"

namespace tomodem {

const char* name_of(ShareOf share) {
    return share == ShareOf::own ? "own" : share == ShareOf::others ? "others" : "box";
}

std::vector<ObjectVolume> object_volumes(std::span<const Vec3> position, std::span<const Object> objects,
                                         double seed_radius, double box_share) {
    std::vector<double> own(objects.size(), 0.0);
    double inside = 0.0, particles = 0.0;
    for (std::size_t k = 0; k < objects.size(); ++k) {
        std::vector<Vec3> centres;
        for (const std::size_t i : objects[k].members) centres.push_back(position[i]);
        try {
            own[k] = alpha_surface(centres, {.probe_radius = default_probe_radius(seed_radius)}).inside_volume;
        } catch (const InvalidInput&) {  // in one plane, or far apart
        }
        if (own[k] == 0.0) continue;
        inside += own[k] * double(centres.size());
        particles += double(centres.size());
    }
    std::vector<ObjectVolume> volumes;
    for (std::size_t k = 0; k < objects.size(); ++k) {
        const double count = double(objects[k].members.size());
        if (own[k] > 0.0)
            volumes.push_back({count * own[k], ShareOf::own});
        else if (particles > 0.0)
            volumes.push_back({count * inside / particles, ShareOf::others});
        else
            volumes.push_back({count * box_share, ShareOf::box});
    }
    return volumes;
}

}  // namespace tomodem
