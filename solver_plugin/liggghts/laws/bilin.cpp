// BILIN inside LIGGGHTS.
#include "solver_plugin/liggghts/laws/crown_solver_law.hpp"

namespace tomodem::plugin {

std::unique_ptr<SolverLaw> make_bilin() {
    return std::make_unique<CrownSolverLaw>(bilin_law(), CrownSolverLaw::Attraction::unbounded);
}

}  // namespace tomodem::plugin
