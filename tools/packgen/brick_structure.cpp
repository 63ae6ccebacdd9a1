#include "tools/packgen/brick_structure.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::packgen {
namespace {

constexpr double longest_distance = 5.0, shell = 0.02;  // of g(r), over d
constexpr double first_shell_ends = 1.1, second_shell_begins = 1.7, usual_minimum = 1.4;
constexpr double reach_of_order = 1.7;  // over d: 14 neighbours and more

/// Points of a box and of copies of it along periodic edges that are too short for a cutoff.
struct Tiled {
    Box box;
    std::vector<Vec3> points;
};

Tiled tiled(const Packing& packing, double cutoff) {
    Tiled tiled{packing.box, packing.position};
    for (int axis = 0; axis < 3; ++axis) {
        const double edge = packing.box.edges[axis];
        if (!packing.box.periodic[axis]) continue;
        const auto copies = static_cast<int>(std::ceil(2.0 * cutoff / edge));
        const std::size_t once = tiled.points.size();
        for (int copy = 1; copy < copies; ++copy)
            for (std::size_t i = 0; i < once; ++i) {
                tiled.points.push_back(tiled.points[i]);
                tiled.points.back()[axis] += copy * edge;
            }
        tiled.box.edges[axis] *= std::max(copies, 1);
    }
    return tiled;
}

/// Where the centres of the mean sphere can be.
Box reachable(const Packing& packing) {
    Box box = packing.box;
    for (int axis = 0; axis < 3; ++axis)
        if (!box.periodic[axis]) {
            box.origin[axis] += packing.seed_radius;
            box.edges[axis] -= 2.0 * packing.seed_radius;
        }
    return box;
}

}  // namespace

BrickStructure structure_of(const Packing& packing, int threads) {
    BrickStructure result;
    const double d = 2.0 * packing.seed_radius;
    result.contacts = contact_statistics(packing, OpenFaces::walls, threads);
    const Box region = reachable(packing);
    const double reach = std::min(longest_distance * d, longest_reach(region));
    const auto shells = static_cast<std::size_t>(std::floor(reach / (shell * d) * (1.0 + 1e-12)));
    if (shells > 0 && packing.size() > 1)
        result.distribution =
            radial_distribution(packing.position, region, static_cast<double>(shells) * shell * d, shells, threads);
    result.bond_cutoff = result.distribution.reach() > second_shell_begins * d
                             ? first_minimum(result.distribution, first_shell_ends * d, second_shell_begins * d)
                             : usual_minimum * d;

    const Tiled tile = tiled(packing, reach_of_order * d);
    const NeighbourTable neighbours(tile.points, tile.box, reach_of_order * d, threads);
    const double particles = static_cast<double>(tile.points.size());
    for (const Order order : common_neighbour_analysis(neighbours, threads)) {
        result.fcc += order == Order::fcc;
        result.hcp += order == Order::hcp;
        result.bcc += order == Order::bcc;
        result.icosahedral += order == Order::icosahedral;
    }
    for (double* share : {&result.fcc, &result.hcp, &result.bcc, &result.icosahedral}) *share /= particles;
    const BondOrder bonds = bond_order(neighbours, result.bond_cutoff, solid_like_product, threads);
    for (const double q6 : bonds.q6) result.mean_q6 += q6 / particles;
    for (const std::int32_t connections : bonds.connections)
        result.solid_like += connections >= solid_like_connections ? 1.0 / particles : 0.0;
    result.global_q6 = bonds.global_q6;
    return result;
}

}  // namespace tomodem::packgen
