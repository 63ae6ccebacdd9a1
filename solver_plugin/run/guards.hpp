#pragma once
#include <string>

#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/simulation.hpp"

/// What ends a run that has gone wrong, or does not let it begin: docs/running.md.
namespace tomodem {

/// Kinetic or elastic energy over N k_rep r_s^2, with the stiffest phase, in the sample's lengths.
double reduced_energy(const plugin::Simulation& simulation, double energy, const Model& model);

/// @param when  for the message
/// @throws InvalidInput if particles are lost or the packing flies apart
void refuse_runaway(const plugin::Simulation& simulation, double kinetic_energy, const Model& model,
                    const std::string& when);

/// A viscous law (NORTON) weakens where it is hot and cannot cool it any more.
/// @throws InvalidInput if the kinetic energy over that of the flow is above the law's max_heat
void refuse_heat(const plugin::Simulation& simulation, double kinetic_energy, const Model& model,
                 const std::string& when);

/// What only a run under load can do.
/// @throws InvalidInput if planes have passed more than a thousandth of the particles, or seeds overlap deeply
void refuse_collapse(const plugin::Simulation& simulation, double elastic_energy, const Model& model,
                     const std::string& when);

/// The planes must not jump over particles, nor walls in the long steps of a quasi-static run: warns, or throws
/// InvalidInput.
void check_plane_speed(const Scene& scene, const Model& model, const Packing& sample, Reporter& reporter);

}  // namespace tomodem
