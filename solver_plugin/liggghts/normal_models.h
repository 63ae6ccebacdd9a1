// LIGGGHTS includes this file twice: once for the list of models, once for the models.
#ifdef NORMAL_MODEL
NORMAL_MODEL(TOMODEM_BILIN, bilin, 20)
NORMAL_MODEL(TOMODEM_TRILIN, trilin, 21)
#else
#ifndef TOMODEM_NORMAL_MODELS_H
#define TOMODEM_NORMAL_MODELS_H
#include "contact_models.h"
#include "normal_model_base.h"
#include "solver_plugin/liggghts/crown_properties.hpp"

namespace LIGGGHTS {
namespace ContactModels {

/// BILIN or TRILIN between a particle and a wall of `fix wall/gran`. Pairs of particles do not come here: see
/// crown_pair.hpp.
template <bool trilin>
class TomodemWallModel : public NormalModelBase {
 public:
    TomodemWallModel(LAMMPS_NS::LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* base)
        : NormalModelBase(lmp, setup, base) {}

    void registerSettings(Settings&) {}
    void postSettings(IContactHistorySetup*, ContactModelBase*) {}
    void connectToProperties(PropertyRegistry& registry) {
        properties_.connect(registry, trilin, trilin ? "model trilin" : "model bilin");
    }
    double stressStrainExponent() { return 1.0; }

    void surfacesIntersect(SurfacesIntersectData& contact, ForceData& on_i, ForceData& on_j) {
        // A wall has no material: the particle's own constants are used.
        const tomodem::law::Pair own = properties_.pair(contact.itype, contact.itype, 2 * contact.radi);
        const double force = tomodem::law::wall_force(tomodem::law::against_wall(own), contact.r, contact.vn);
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
    tomodem::plugin::CrownProperties properties_;
};

template <>
class NormalModel<TOMODEM_BILIN> : public TomodemWallModel<false> {
 public:
    using TomodemWallModel<false>::TomodemWallModel;
};
template <>
class NormalModel<TOMODEM_TRILIN> : public TomodemWallModel<true> {
 public:
    using TomodemWallModel<true>::TomodemWallModel;
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
