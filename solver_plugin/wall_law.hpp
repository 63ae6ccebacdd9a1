#pragma once
#include <vector>

#include "core/law/pair.hpp"
#include "solver_plugin/liggghts.hpp"

namespace tomodem::plugin {

/// Force of a wall on particle i under the particle's own law, repulsion positive.
///
/// @param laws  by type, from 1, of a particle of the type's nominal radius
/// @param rate  of the distance, relative to the wall
inline double wall_force(const std::vector<law::Wall>& laws, const LAMMPS_NS::Atom& atom, int i, double distance,
                         double rate) {
    law::Wall law = laws[atom.type[i]];
    law.seed_distance *= atom.radius[i] / law.crown_distance;
    law.crown_distance = atom.radius[i];
    return law::wall_force(law, distance, rate);
}

}  // namespace tomodem::plugin
