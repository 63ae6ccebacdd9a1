#include "solver_plugin/run/run_curves.hpp"

#include <fmt/format.h>

#include <cmath>

namespace tomodem {

using plugin::PlaneForces;

Point measure(double strain, const PlaneForces& forces, double section, double initial_section) {
    Point point{};
    point.strain = strain;
    point.force_top = forces.top;
    // The sample pushes or pulls the two planes in opposite directions; with the sign of the axis they add up to zero.
    point.force_bottom = -forces.bottom;
    const double force = (forces.top + forces.bottom) / 2;
    const double magnitude = (std::abs(forces.top) + std::abs(forces.bottom)) / 2;
    point.section = section;
    point.stress_true = force / point.section;
    point.stress_engineering = force / initial_section;
    point.equilibrium_error = magnitude > 0 ? std::abs(point.force_top + point.force_bottom) / magnitude : 0;
    return point;
}

std::vector<CurveValue> curve_values(const Scene& scene, const Point& point, const std::vector<Vec3>& wall_forces,
                                     const plugin::Energies& energies, std::int64_t evaluations) {
    std::vector<CurveValue> all{{"strain", "", point.strain}};
    if (!scene.steps.empty())
        all.insert(all.end(), {{"stress_true", "Pa", point.stress_true},
                               {"stress_engineering", "Pa", point.stress_engineering},
                               {"force_top", "uN", point.force_top},
                               {"force_bottom", "uN", point.force_bottom},
                               {"equilibrium_error", "", point.equilibrium_error},
                               {"section", "mm^2", point.section}});
    if (!scene.steps.empty() && scene.law().traits().measures_by_volume)
        all.push_back({"stress_virial", "Pa", point.stress_virial});
    all.insert(all.end(), {{"kinetic_energy", "nJ", energies.kinetic}, {"potential_energy", "nJ", energies.seeds}});
    if (scene.scheme == Scheme::quasi_static) all.push_back({"evaluations", "", static_cast<double>(evaluations)});
    for (std::size_t k = 0; k < scene.walls.size(); ++k)
        for (int axis = 0; axis < 3; ++axis)
            all.push_back(
                {fmt::format("wall_{}_force_{}", scene.walls[k].name, "xyz"[axis]), "uN", wall_forces[k][axis]});
    return all;
}

}  // namespace tomodem
