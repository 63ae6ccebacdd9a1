#pragma once
#include <vector>

#include "core/law/pair.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/crown_pair.hpp"

namespace tomodem::plugin {

/// Force of a wall on particle i along the wall's normal under the particle's own law, repulsion positive.
///
/// @param laws    by type, from 1, of a particle of the type's nominal radius; NORTON looks at the pair style instead
/// @param normal  unit vector from the wall to the particle
/// @param rate    of the distance, relative to the wall
inline double wall_force(const std::vector<law::Wall>& laws, LAMMPS_NS::LAMMPS& lmp, int i, double distance,
                         const double* normal, double rate) {
    const LAMMPS_NS::Atom& atom = *lmp.atom;
    if (const NortonPairs* const norton = CrownPair::of(lmp)->norton()) {
        double other = 0;
        for (int c = 0; c < 3; ++c) other += normal[c] * atom.f[i][c];
        return law::norton_wall_force(norton->law(), norton->state(i).strength(), distance, rate, other,
                                      lmp.update->dt / atom.rmass[i]);
    }
    law::Wall law = laws[atom.type[i]];
    law.seed_distance *= atom.radius[i] / law.crown_distance;
    law.crown_distance = atom.radius[i];
    return law::wall_force(law, distance, rate);
}

}  // namespace tomodem::plugin
