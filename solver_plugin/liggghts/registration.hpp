#pragma once
#include <cstdint>

// NOLINTNEXTLINE(readability-identifier-naming): the name is LIGGGHTS'.
namespace LAMMPS_NS {
class LAMMPS;
}

namespace tomodem {
class Law;
}

namespace tomodem::plugin {

/// Makes `pair_style gran model NAME` and `fix wall/gran model NAME` of every law known to every LIGGGHTS of this
/// process. Once, before the first LAMMPS object.
void register_laws();

/// Makes the fixes of tomodem (`fix ID all tomodem/...`) known to one LIGGGHTS.
void register_fixes(LAMMPS_NS::LAMMPS& lmp);

/// LIGGGHTS' number of the combination: normal model of ours, everything else off.
std::int64_t law_hashcode(const Law& law);

}  // namespace tomodem::plugin
