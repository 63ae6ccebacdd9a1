#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/packing/packing_file.hpp"

/// Whether the particles of a run are enough to carry its stress.
namespace tomodem::curves {

struct StressResolution {
    double particles_across = 0.0;     ///< of the parts of the solid in the first frame, as of cylinders (envelope.hpp)
    double particles_needed = 0.0;     ///< across, for a stress under the law of the run
    double plane_difference = 0.0;     ///< of the forces of the two planes [-]; not a number where it is not known
    std::int64_t particles_to_do = 0;  ///< in a sample fine enough, to two digits; 0: this one is

    /// The planes feel the same force to a tenth.
    bool in_equilibrium() const { return !(plane_difference > 0.1); }
    bool fine_enough() const { return particles_across >= particles_needed; }
    bool reliable() const { return in_equilibrium() && fine_enough(); }
};

/// In foams whose struts are 2.1 particles across NORTON's stress is the same as in finer ones within 8 %, at 1.4 most
/// samples fall apart. BILIN and TRILIN lose 50 % at 2.4, TRILIN still 18 % at 2.9: docs/trade.md, whose sizes are
/// those of the nodes, 2.1 times the struts.
/// @param plane_difference  over the strains where the stress is measured
StressResolution stress_resolution(const RunReader& run, double plane_difference);

}  // namespace tomodem::curves
