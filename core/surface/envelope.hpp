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

/// Particles across the parts of a solid, as if they were cylinders: the diameter of a cylinder of this envelope, of a
/// probe of one diameter. The envelope runs 0.65 r_s inside the surface and has 1.15 times its area; a strut of 0.95,
/// 1.4, 2.1 and 2.9 particles, cut out of a random packing, gives 0.97, 1.4, 2.1 and 2.8.
/// @param volume, area  of the envelope [mm^3, mm^2]
inline double particles_across(double volume, double area, double seed_radius) {
    return 0.65 + 1.15 * (area > 0.0 ? 4.0 * volume / (area * 2.0 * seed_radius) : 0.0);
}

}  // namespace tomodem
