#include "tools/phantom/fibres.hpp"

namespace tomodem::phantom {

std::vector<Strut> fibre_struts(const Vec3& edges, std::int64_t count, double out_of_plane, Random& random) {
    std::vector<Strut> fibres;
    for (std::int64_t i = 0; i < count; ++i) {
        Vec3 through;
        for (int axis = 0; axis < 3; ++axis) through[axis] = random.uniform(0, edges[axis]);
        Vec3 along = random.direction();
        along[2] *= out_of_plane;
        along *= edges.norm() / along.norm();
        fibres.push_back({through - along, through + along});
    }
    return fibres;
}

}  // namespace tomodem::phantom
