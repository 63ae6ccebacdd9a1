#pragma once
#include <cstdint>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace tomodem::plugin {

/// Makes `pair_style gran model bilin` and `fix wall/gran model bilin` known to every LIGGGHTS of this process.
/// Once, before the first LAMMPS object.
void register_laws();

/// Makes `fix ID all tomodem/planes` known to one LIGGGHTS.
void register_fixes(LAMMPS_NS::LAMMPS& lmp);

/// LIGGGHTS' number of the combination: normal bilin, everything else off.
std::int64_t bilin_hashcode();

}  // namespace tomodem::plugin
