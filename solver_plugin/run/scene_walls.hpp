#pragma once
#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem {

/// Reads the surfaces of the scene's walls and stands them around the sample.
/// @throws InvalidInput naming the wall's line: unreadable, or inside the sample where there must be room
enum class WallsInside { refused, allowed };  ///< of the sample, as they are later in a run
void place_walls(plugin::Simulation& simulation, const Scene& scene, WallsInside inside_sample);

}  // namespace tomodem
