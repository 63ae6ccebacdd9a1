#pragma once
#include "core/scene/scene.hpp"

/// Values that are possible and that nobody means: a wrong unit, a strain in per cent.
namespace tomodem {

inline constexpr double max_usual_flow_stress = 1e10;   ///< Pa: ten times that of the strongest steels
inline constexpr double max_usual_seed_modulus = 1e12;  ///< Pa: k_rep / 2 r_s, with which BILIN flows at 15 GPa
inline constexpr double max_usual_strain = 3;           ///< true strain: 5 % of the height is left, or 20 times it
inline constexpr double min_usual_rate = 1e-12;         ///< 1/s: 1 % in 300 years
inline constexpr double max_usual_rate = 1e6;           ///< 1/s: beyond impacts of projectiles
inline constexpr double max_usual_hardening = 50;       ///< strength over that at the start, and its inverse
inline constexpr double min_usual_sample_seed_radius = 1e-6;  ///< mm: 1 nm, below the voxels of any tomograph
inline constexpr double max_usual_sample_seed_radius = 100;   ///< mm

/// @throws InvalidInput with the line, what may be meant instead, and how to insist (unusual_values = true)
void refuse_unusual_values(const Scene& scene);

/// The same for the size of a sample's particles, unless the scene insists.
void refuse_unusual_size(const Scene& scene, const Packing& sample);

}  // namespace tomodem
