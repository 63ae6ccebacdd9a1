#pragma once
#include "global_properties.h"
#include "property_registry.h"

/// Numbers of an input script of LIGGGHTS, `fix ID all property/global NAME ...`: one, one a type, or one a pair of
/// types. `values` point into LIGGGHTS, indexed by the types from 1.
namespace tomodem::plugin::script {

template <const char* name>
void connect_scalar(PropertyRegistry& registry, double& value, const char* caller) {
    registry.registerProperty(
        name, +[](PropertyRegistry& of, const char* by, bool) -> ScalarProperty* {
            return MODEL_PARAMS::createScalarProperty(of, name, by);
        });
    registry.connect(name, value, caller);
}

template <const char* name>
void connect_types(PropertyRegistry& registry, double*& values, const char* caller) {
    registry.registerProperty(
        name, +[](PropertyRegistry& of, const char* by, bool) -> VectorProperty* {
            return MODEL_PARAMS::createPerTypeProperty(of, name, by);
        });
    registry.connect(name, values, caller);
}

template <const char* name>
void connect_pairs(PropertyRegistry& registry, double**& values, const char* caller) {
    registry.registerProperty(
        name, +[](PropertyRegistry& of, const char* by, bool) -> MatrixProperty* {
            return MODEL_PARAMS::createPerTypePairProperty(of, name, by);
        });
    registry.connect(name, values, caller);
}

}  // namespace tomodem::plugin::script
