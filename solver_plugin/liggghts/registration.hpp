#pragma once
#include <cstdint>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace tomodem::plugin {

/// Makes `pair_style gran model bilin|trilin` and `fix wall/gran model bilin|trilin` known to every LIGGGHTS of this
/// process. Once, before the first LAMMPS object.
void register_laws();

/// Makes `fix ID all tomodem/planes` and `fix contact all tomodem/contact` known to one LIGGGHTS.
void register_fixes(LAMMPS_NS::LAMMPS& lmp);

/// LIGGGHTS' number of the combination: normal model of ours, everything else off.
std::int64_t law_hashcode(bool trilin);

}  // namespace tomodem::plugin
