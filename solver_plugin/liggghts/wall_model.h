// LIGGGHTS includes this file twice: once for the list of models, once for the models.
#ifdef NORMAL_MODEL
NORMAL_MODEL(TOMODEM_LAW, tomodem, 20)
#else
#ifndef TOMODEM_WALL_MODEL_H
#define TOMODEM_WALL_MODEL_H
#include "contact_models.h"
#include "normal_model_base.h"
#include "solver_plugin/liggghts/script_wall.hpp"

namespace LIGGGHTS {
namespace ContactModels {

/// Every law between a particle and a wall of `fix wall/gran`: that of the pair style, with the particle's own constants,
/// as a wall has no material. Pairs of particles do not come here: see law_pair.hpp.
template <>
class NormalModel<TOMODEM_LAW> : public NormalModelBase {
 public:
    NormalModel(LAMMPS_NS::LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* base)
        : NormalModelBase(lmp, setup, base) {}

    void registerSettings(Settings&) {}
    void postSettings(IContactHistorySetup*, ContactModelBase*) {}
    void connectToProperties(PropertyRegistry&) {}
    double stressStrainExponent() { return 1.0; }

    void surfacesIntersect(SurfacesIntersectData& contact, ForceData& on_i, ForceData& on_j) {
        const double force =
            tomodem::plugin::script_wall_force(*lmp, contact.i, contact.r, contact.en, contact.vn);
        contact.Fn = force;
        for (int axis = 0; axis < 3; ++axis) {
            on_i.delta_F[axis] = force * contact.en[axis];
            on_j.delta_F[axis] = -force * contact.en[axis];
        }
    }
    void surfacesClose(SurfacesCloseData&, ForceData&, ForceData&) {}
    void beginPass(SurfacesIntersectData&, ForceData&, ForceData&) {}
    void endPass(SurfacesIntersectData&, ForceData&, ForceData&) {}
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
