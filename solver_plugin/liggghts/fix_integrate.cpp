#include "solver_plugin/liggghts/fix_integrate.hpp"

#include <algorithm>
#include <array>

#include "solver_plugin/liggghts/lateral_box.hpp"
#include "solver_plugin/liggghts/law_pair.hpp"
#include "solver_plugin/liggghts/planes.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

int FixIntegrate::setmask() {
    return FixConst::INITIAL_INTEGRATE | FixConst::FINAL_INTEGRATE;
}

/// Moves the particles with the velocities that the kernel has found, in parts if it asks for them. Then the velocities
/// are carried on as those of a uniform flow: the next search begins there.
void FixIntegrate::follow(LawPair& pair) {
    PairKernel& kernel = pair.kernel();
    const int planes = modify->find_fix("planes"), sides = modify->find_fix("sides");
    double left = update->dt;
    for (;;) {
        const double part = std::min(left, kernel.interval());
        std::array<double, 3> growth{0, 0, 0};
        if (planes >= 0 && kernel.keeps_time())
            growth = static_cast<const FixPlanes*>(modify->fix[planes])->growth(left, part);
        for (int i = 0; i < atom->nlocal; ++i)
            for (int c = 0; c < 3; ++c) {
                atom->x[i][c] += part * atom->v[i][c];
                atom->v[i][c] *= 1 + growth[c];
            }
        if (sides >= 0) static_cast<FixLateralBox*>(modify->fix[sides])->move(part);
        left -= part;
        if (!kernel.keeps_time() || left <= 1e-9 * update->dt) return;
        pair.solve_from(-left);
    }
}

void FixIntegrate::initial_integrate(int) {
    LawPair& pair = *LawPair::of(*lmp);
    if (pair.kernel().finds_velocities()) {
        follow(pair);
        return;
    }
    const bool first = update->ntimestep == update->firststep + 1;
    const double kick = first ? 0.5 * update->dt : update->dt;
    if (PackedParticles* const packed = pair.kernel().packed()) {
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
    if (update->ntimestep != update->laststep || LawPair::of(*lmp)->kernel().finds_velocities()) return;
    for (int i = 0; i < atom->nlocal; ++i)
        for (int c = 0; c < 3; ++c) atom->v[i][c] += 0.5 * update->dt / atom->rmass[i] * atom->f[i][c];
}

}  // namespace tomodem::plugin
