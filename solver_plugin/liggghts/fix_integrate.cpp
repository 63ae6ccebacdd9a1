#include "solver_plugin/liggghts/fix_integrate.hpp"

#include "solver_plugin/liggghts/law_pair.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

int FixIntegrate::setmask() {
    return FixConst::INITIAL_INTEGRATE | FixConst::FINAL_INTEGRATE;
}

void FixIntegrate::initial_integrate(int) {
    const bool first = update->ntimestep == update->firststep + 1;
    const double kick = first ? 0.5 * update->dt : update->dt;
    if (PackedParticles* const packed = LawPair::of(*lmp)->kernel().packed()) {
        if (atom->nlocal > 0)
            packed->integrate({atom->x[0], atom->v[0], atom->f[0], atom->rmass, atom->nlocal}, kick, update->dt);
        return;
    }
    for (int i = 0; i < atom->nlocal; ++i)
        for (int c = 0; c < 3; ++c) {
            atom->v[i][c] += kick / atom->rmass[i] * atom->f[i][c];
            atom->x[i][c] += update->dt * atom->v[i][c];
        }
}

void FixIntegrate::final_integrate() {
    if (update->ntimestep != update->laststep) return;
    for (int i = 0; i < atom->nlocal; ++i)
        for (int c = 0; c < 3; ++c) atom->v[i][c] += 0.5 * update->dt / atom->rmass[i] * atom->f[i][c];
}

}  // namespace tomodem::plugin
