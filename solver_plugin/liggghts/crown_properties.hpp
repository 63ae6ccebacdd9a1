#pragma once
#include "core/law/pair.hpp"
#include "global_properties.h"
#include "property_registry.h"

/// The constants of BILIN and TRILIN as an input script of LIGGGHTS gives them, by `fix property/global`.
///
/// repulsiveStiffness, attractiveStiffness: peratomtypepair [force/length]; greatestAttraction (TRILIN only):
/// peratomtypepair [force]; seedToCrown: scalar, r_s / r_c. The radius of a LIGGGHTS particle is its crown radius.
namespace tomodem::plugin {

class CrownProperties {
 public:
    /// @param caller  named in LIGGGHTS' error when a property is missing
    void connect(PropertyRegistry& registry, bool bounded, const char* caller) {
        matrix<&make<repulsive>>(registry, repulsive, repulsive_stiffness_, caller);
        matrix<&make<attractive>>(registry, attractive, attractive_stiffness_, caller);
        if (bounded) matrix<&make<greatest>>(registry, greatest, greatest_attraction_, caller);
        registry.registerProperty("seedToCrown", &make_seed_to_crown);
        registry.connect("seedToCrown", seed_to_crown_, caller);
    }
    double seed_to_crown() const { return seed_to_crown_; }
    /// Law of a pair of types whose radii add up to `crown`.
    law::Pair pair(int a, int b, double crown) const {
        law::Pair law{crown * seed_to_crown_, crown, repulsive_stiffness_[a][b], attractive_stiffness_[a][b]};
        if (greatest_attraction_ != nullptr) law.greatest_attraction = greatest_attraction_[a][b];
        return law;
    }

 private:
    static constexpr char repulsive[] = "repulsiveStiffness", attractive[] = "attractiveStiffness",
                          greatest[] = "greatestAttraction";

    template <const char* name>
    static MatrixProperty* make(PropertyRegistry& registry, const char* caller, bool) {
        return MODEL_PARAMS::createPerTypePairProperty(registry, name, caller);
    }
    static ScalarProperty* make_seed_to_crown(PropertyRegistry& registry, const char* caller, bool) {
        return MODEL_PARAMS::createScalarProperty(registry, "seedToCrown", caller);
    }
    template <auto creator>
    static void matrix(PropertyRegistry& registry, const char* name, double**& values, const char* caller) {
        registry.registerProperty(name, creator);
        registry.connect(name, values, caller);
    }

    double** repulsive_stiffness_ = nullptr;
    double** attractive_stiffness_ = nullptr;
    double** greatest_attraction_ = nullptr;
    double seed_to_crown_ = 0.0;
};

}  // namespace tomodem::plugin
