#pragma once
#include "global_properties.h"
#include "property_registry.h"

/// The constants of BILIN as LIGGGHTS knows them: `fix property/global`, set by `solve` or by an input script.
///
/// repulsiveStiffness, attractiveStiffness: peratomtypepair [force/length]; seedToCrown: scalar, r_s / r_c. The radius
/// of a LIGGGHTS particle is its crown radius.
namespace tomodem::plugin {

struct BilinProperties {
    double** repulsive_stiffness = nullptr;
    double** attractive_stiffness = nullptr;
    double seed_to_crown = 0.0;

    /// @param caller  named in LIGGGHTS' error when a property is missing
    void connect(PropertyRegistry& registry, const char* caller) {
        registry.registerProperty("repulsiveStiffness", &make_repulsive_stiffness);
        registry.registerProperty("attractiveStiffness", &make_attractive_stiffness);
        registry.registerProperty("seedToCrown", &make_seed_to_crown);
        registry.connect("repulsiveStiffness", repulsive_stiffness, caller);
        registry.connect("attractiveStiffness", attractive_stiffness, caller);
        registry.connect("seedToCrown", seed_to_crown, caller);
    }

 private:
    static MatrixProperty* make_repulsive_stiffness(PropertyRegistry& registry, const char* caller, bool) {
        return MODEL_PARAMS::createPerTypePairProperty(registry, "repulsiveStiffness", caller);
    }
    static MatrixProperty* make_attractive_stiffness(PropertyRegistry& registry, const char* caller, bool) {
        return MODEL_PARAMS::createPerTypePairProperty(registry, "attractiveStiffness", caller);
    }
    static ScalarProperty* make_seed_to_crown(PropertyRegistry& registry, const char* caller, bool) {
        return MODEL_PARAMS::createScalarProperty(registry, "seedToCrown", caller);
    }
};

}  // namespace tomodem::plugin
