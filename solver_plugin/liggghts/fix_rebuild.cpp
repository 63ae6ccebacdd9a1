#include "solver_plugin/liggghts/fix_rebuild.hpp"

#include <algorithm>

namespace tomodem::plugin {

using namespace LAMMPS_NS;

int FixRebuild::setmask() {
    return FixConst::INITIAL_INTEGRATE | FixConst::POST_INTEGRATE;
}

void FixRebuild::initial_integrate(int) {
    if (neighbor->ago != 0) return;
    const auto values = 3 * static_cast<std::size_t>(atom->nlocal);
    built_at_.resize(values);
    if (values > 0) std::copy_n(atom->x[0], values, built_at_.begin());
}

void FixRebuild::post_integrate() {
    const double limit = 0.25 * neighbor->skin * neighbor->skin;
    const auto count = static_cast<std::size_t>(atom->nlocal);
    double farthest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double* const x = atom->x[i];
        const auto* const built = built_at_.data() + 3 * i;
        const double way[3] = {x[0] - built[0], x[1] - built[1], x[2] - built[2]};
        farthest = std::max(farthest, way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    }
    const int mine = farthest > limit ? 1 : 0;
    int any = 0;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (any != 0) next_reneighbor = update->ntimestep;
}

}  // namespace tomodem::plugin
