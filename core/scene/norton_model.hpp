#pragma once
#include "core/scene/model.hpp"

namespace tomodem {

/// NORTON's constants for a scene and a sample (docs/norton.md).
///
/// One mass for every particle: what keeps the inertial share of the stress, n m rate^2 H^2 / 12 over K rate^M at the
/// highest rate, within equilibrium_error (0.02 where the scene has none) for the softest phase. The time step is the
/// longest stable one: a tenth of m / (eta d) at half the lowest rate, or a twentieth of the cores' period.
///
/// @throws InvalidInput if the time step given is longer
void add_norton(const Scene& scene, const Packing& sample, Model& model);

/// What set the time step, in words.
std::string norton_time_step_reason(const Scene& scene, const Packing& sample, const Model& model);

}  // namespace tomodem
