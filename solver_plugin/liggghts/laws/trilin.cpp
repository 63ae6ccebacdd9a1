// TRILIN inside LIGGGHTS.
#include "solver_plugin/liggghts/laws/crown_solver_law.hpp"

namespace tomodem::plugin {

std::unique_ptr<SolverLaw> make_trilin() {
    return std::make_unique<CrownSolverLaw>(trilin_law(), CrownSolverLaw::Attraction::bounded);
}

}  // namespace tomodem::plugin
