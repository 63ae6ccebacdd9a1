#pragma once
#include <string>

#include "core/packing/packing.hpp"

namespace tomodem::fields {

/// Neighbourhood of the local fields where none is given: three seed radii, up to the second neighbours.
inline double default_field_radius(double seed_radius) {
    return 3.0 * seed_radius;
}

/// @throws InvalidInput naming --radius, if the centres lie closer together than it: every particle would see all
/// others
void require_smaller_than_sample(double radius, const Packing& packing);

}  // namespace tomodem::fields
