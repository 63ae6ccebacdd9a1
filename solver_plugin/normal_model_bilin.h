// LIGGGHTS includes this file twice: once for the list of models, once for the model.
#ifdef NORMAL_MODEL
NORMAL_MODEL(TOMODEM_BILIN, bilin, 20)
#else
#ifndef TOMODEM_NORMAL_MODEL_BILIN_H
#define TOMODEM_NORMAL_MODEL_BILIN_H
#include "contact_models.h"
#include "core/law/bilin.hpp"
#include "normal_model_base.h"
#include "solver_plugin/bilin_properties.hpp"

namespace LIGGGHTS {
namespace ContactModels {

/// BILIN between a particle and a wall of `fix wall/gran`. Pairs of particles do not come here: see bilin_pair.hpp.
template <>
class NormalModel<TOMODEM_BILIN> : public NormalModelBase {
 public:
    NormalModel(LAMMPS_NS::LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* base)
        : NormalModelBase(lmp, setup, base) {}

    void registerSettings(Settings&) {}
    void postSettings(IContactHistorySetup*, ContactModelBase*) {}
    void connectToProperties(PropertyRegistry& registry) { properties_.connect(registry, "model bilin"); }
    double stressStrainExponent() { return 1.0; }

    void surfacesIntersect(SurfacesIntersectData& contact, ForceData& on_i, ForceData& on_j) {
        // A wall has no material: the particle's own constants are used.
        const int type = contact.itype;
        const tomodem::law::Bilin law{contact.radi * properties_.seed_to_crown, contact.radi,
                                      properties_.repulsive_stiffness[type][type],
                                      properties_.attractive_stiffness[type][type]};
        const double force = tomodem::law::bilin_force(law, contact.r, contact.vn);
        contact.Fn = force;
        for (int axis = 0; axis < 3; ++axis) {
            on_i.delta_F[axis] = force * contact.en[axis];
            on_j.delta_F[axis] = -force * contact.en[axis];
        }
    }
    void surfacesClose(SurfacesCloseData&, ForceData&, ForceData&) {}
    void beginPass(SurfacesIntersectData&, ForceData&, ForceData&) {}
    void endPass(SurfacesIntersectData&, ForceData&, ForceData&) {}

 private:
    tomodem::plugin::BilinProperties properties_;
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
