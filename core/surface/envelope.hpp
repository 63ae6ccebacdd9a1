#pragma once

/// Where the material ends beyond the outermost centres.
namespace tomodem {

/// What the centres belong to.
struct Matter {
    double seed_radius;  ///< [mm]
    double density;      ///< D, between the pores
};

/// Distance of the envelope of the centres around a pore, by a probe of one diameter, from the edge of the material
/// [mm]. Calibrated on random packings out of which a sphere was cut, where the edge is the sphere:
/// bench/relax/measure.cpp.
/// @param across  6 volumes over the surface of the envelope, in particles: a sphere's diameter
inline double envelope_bias(const Matter& matter, double across) {
    return (0.648 - 0.59 * (matter.density - 0.64) - 1.03 / across) * matter.seed_radius;
}

}  // namespace tomodem
