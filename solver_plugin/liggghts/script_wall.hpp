#pragma once

// NOLINTNEXTLINE(readability-identifier-naming): the name is LIGGGHTS'.
namespace LAMMPS_NS {
class LAMMPS;
}

namespace tomodem::plugin {

/// Force of a wall of `fix wall/gran` on a particle, as LawPair::wall_force() of that LIGGGHTS.
double script_wall_force(LAMMPS_NS::LAMMPS& lmp, int i, double distance, const double* normal, double rate);

}  // namespace tomodem::plugin
