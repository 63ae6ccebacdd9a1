#include "solver_plugin/run/scene_walls.hpp"

#include <fmt/format.h>

#include <string_view>

#include "core/base/error.hpp"
#include "core/mesh/mesh.hpp"

namespace tomodem {

void place_walls(plugin::Simulation& simulation, const Scene& scene, WallsInside inside_sample) {
    for (const Wall& wall : scene.walls) {
        const auto refuse = [&](const std::string& what) {
            throw InvalidInput(
                fmt::format("scene '{}' line {}: wall '{}': {}", scene.path.string(), wall.line, wall.name, what));
        };
        try {
            TriangleMesh mesh = read_mesh(wall.surface);
            for (Vec3& vertex : mesh.vertices) vertex *= wall.unit;
            if (const std::int64_t inside = simulation.place_wall(mesh, wall);
                inside > 0 && inside_sample == WallsInside::refused)
                refuse(
                    fmt::format("its surface stands inside the sample: {} particles are nearer than half a seed "
                                "radius; move it, or check its unit",
                                inside));
        } catch (const InvalidInput& error) {
            if (std::string_view(error.what()).starts_with("scene '")) throw;
            refuse(error.what());
        }
    }
}

}  // namespace tomodem
