#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/simulation.hpp"

/// The macroscopic curves of a run.
namespace tomodem {

/// Points of a curve in averaging_strain.
inline constexpr int points_per_window = 10;

/// Points that a force is a mean over: a quasi-static one is what it is.
inline int window_points(const Scene& scene) {
    return scene.scheme == Scheme::quasi_static ? 1 : points_per_window;
}

/// Mean forces of planes and walls on the sample over some steps.
struct Forces {
    plugin::PlaneForces planes;
    std::vector<Vec3> walls;
    std::int64_t steps = 0;
};

/// Means of the forces over the last window of strain, point by point.
class ForceWindow {
 public:
    explicit ForceWindow(int points) : points_(static_cast<std::size_t>(points)) {}

    void add(Forces forces) {
        recent_.push_back(std::move(forces));
        if (recent_.size() > points_) recent_.pop_front();
    }
    bool filled() const { return !recent_.empty(); }
    Forces mean() const {
        Forces mean{{}, std::vector<Vec3>(recent_.front().walls.size(), Vec3::Zero()), 0};
        for (const Forces& forces : recent_) mean.steps += forces.steps;
        for (const Forces& forces : recent_) {
            const double share = static_cast<double>(forces.steps) / static_cast<double>(mean.steps);
            mean.planes.top += share * forces.planes.top;
            mean.planes.bottom += share * forces.planes.bottom;
            for (std::size_t k = 0; k < mean.walls.size(); ++k) mean.walls[k] += share * forces.walls[k];
        }
        return mean;
    }
    std::vector<double> numbers() const {
        std::vector<double> all;
        for (const Forces& forces : recent_) {
            all.insert(all.end(), {forces.planes.top, forces.planes.bottom, static_cast<double>(forces.planes.steps),
                                   static_cast<double>(forces.steps)});
            for (const Vec3& force : forces.walls) all.insert(all.end(), force.begin(), force.end());
        }
        return all;
    }
    void restore(const std::vector<double>& numbers, std::size_t walls) {
        recent_.clear();
        for (auto at = numbers.begin(); at != numbers.end();) {
            Forces forces{{at[0], at[1], static_cast<long>(at[2])}, {}, static_cast<std::int64_t>(at[3])};
            at += 4;
            for (std::size_t k = 0; k < walls; ++k, at += 3) forces.walls.emplace_back(at[0], at[1], at[2]);
            recent_.push_back(std::move(forces));
        }
    }

 private:
    std::size_t points_;
    std::deque<Forces> recent_;
};

struct Point {
    double strain, stress_true, stress_engineering, force_top, force_bottom, equilibrium_error, section, stress_virial;
};

/// @param forces           means over the window
/// @param section          at this strain [mm^2]
/// @param initial_section  [mm^2]
Point measure(double strain, const plugin::PlaneForces& forces, double section, double initial_section);

struct CurveValue {
    std::string name, unit;
    double value;
};

/// Everything that one point of the curves holds: without planes there is no stress.
/// @param evaluations  of all pair forces in the quasi-static step to this point
std::vector<CurveValue> curve_values(const Scene& scene, const Point& point, const std::vector<Vec3>& wall_forces,
                                     const plugin::Energies& energies, std::int64_t evaluations);

}  // namespace tomodem
