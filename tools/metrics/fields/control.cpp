#include "tools/metrics/fields/control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/surface/alpha_surface.hpp"

namespace tomodem::fields {
using namespace curves;

double stiffness_level(double stiffness, double stress, double diameter) {
    return stiffness / (stress * diameter);
}

double inertial_number(double rate, double mass, double stress, double diameter) {
    return rate * std::sqrt(mass / (stress * diameter));
}

double kinetic_number(double kinetic, double stress, double diameter) {
    return kinetic / (stress * diameter * diameter * diameter);
}

std::vector<PhaseConstants> phase_constants(const RunFrames& frames) {
    if (!frames.scene())
        throw InvalidInput(
            "the file holds no scene, which gives the stiffness and mass of its particles; give a file written by "
            "relax "
            "or solve");
    const Scene& scene = *frames.scene();
    Packing sample = frames.packing();
    sample.box = frames.box(0);
    const Model model = compile_model(scene, sample);
    // Forces, in the solver's lengths, are larger by the square of the scale.
    const double scale = scene.seed_radius / sample.seed_radius;
    std::vector<PhaseConstants> constants;
    for (const PhaseModel& phase : model.phases)
        constants.push_back({phase.label, phase.pair.repulsive_stiffness / scale, phase.mass / scale, phase.chi,
                             scene.highest_rate(), phase.hardening});
    return constants;
}

ControlCurves::ControlCurves(const std::filesystem::path& run, double averaging_strain) {
    const StrainCurves raw =
        read_strain_curves(run, {{"stress_true", "Pa"}, {"kinetic_energy", "nJ"}, {"potential_energy", "nJ"}});
    points = averaged_over_strain(raw, averaging_strain);
    points.time = raw.time;
    points.strain = raw.strain;
    // The solver has averaged the forces already, not the energies.
    points.value["stress_true"] = raw.value.at("stress_true");
    rate.resize(raw.time.size());
    for (std::size_t i = 1; i < raw.time.size(); ++i) {
        const double duration = raw.time[i] - raw.time[i - 1];
        rate[i] = duration > 0.0 ? std::abs(raw.strain[i] - raw.strain[i - 1]) / duration : rate[i - 1];
    }
    rate[0] = rate[1];
}

ControlNumbers ControlCurves::at(double time, const std::vector<PhaseConstants>& phases, std::size_t particles,
                                 double diameter) const {
    const auto value = [&](const std::string& name) {
        return PiecewiseLinear(points.time, points.value.at(name)).at(time);
    };
    ControlNumbers result;
    result.stress = std::abs(value("stress_true"));
    result.rate = PiecewiseLinear(points.time, rate).at(time);
    for (const PhaseConstants& phase : phases) {
        const double strength = phase.hardening ? phase.hardening->factor(time) : 1.0;
        ControlNumbers::OfPhase numbers{
            phase.label, strength * phase.stiffness, strength * phase.mass, phase.chi_at(result.rate), {}, {}};
        if (result.stress > 0.0) {
            numbers.stiffness_level = stiffness_level(numbers.stiffness, result.stress, diameter);
            numbers.inertial_number = inertial_number(result.rate, numbers.mass, result.stress, diameter);
            if (!result.min_stiffness_level || *numbers.stiffness_level < *result.min_stiffness_level)
                result.min_stiffness_level = numbers.stiffness_level;
            if (!result.max_inertial_number || *numbers.inertial_number > *result.max_inertial_number)
                result.max_inertial_number = numbers.inertial_number;
        }
        result.phases.push_back(numbers);
    }
    const double kinetic = value("kinetic_energy"), elastic = value("potential_energy");
    if (result.stress > 0.0)
        result.kinetic_number = kinetic_number(kinetic / double(particles), result.stress, diameter);
    if (elastic > 0.0) result.kinetic_over_elastic = kinetic / elastic;
    return result;
}

double flow_energy(const std::vector<Vec3>& positions, const std::vector<std::int32_t>& species, int axis, double rate,
                   const std::vector<PhaseConstants>& phases, double time) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : positions) centre += p / double(positions.size());
    double energy = 0.0;
    for (const PhaseConstants& phase : phases) {
        const double mass = (phase.hardening ? phase.hardening->factor(time) : 1.0) * phase.mass;
        double squares = 0.0;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            if (species[i] != phase.label) continue;
            Vec3 velocity = -0.5 * rate * (positions[i] - centre);
            velocity[axis] *= -2.0;
            squares += velocity.squaredNorm();
        }
        energy += 0.5 * mass * squares;
    }
    return energy;
}

std::optional<Density> deformed_density(const Packing& packing) {
    // Cut off at periodic sides: those that crossed one do not stick out.
    std::vector<Vec3> centres = packing.position;
    for (Vec3& p : centres)
        for (int axis = 0; axis < 3; ++axis)
            if (packing.box.periodic[axis])
                p[axis] -= packing.box.edges[axis] *
                           std::floor((p[axis] - packing.box.origin[axis]) / packing.box.edges[axis]);
    const AlphaSurface surface = alpha_surface(centres, {.probe_radius = default_probe_radius(packing.seed_radius),
                                                         .progress = {},
                                                         .seed_radius = packing.seed_radius});
    Density result;
    double spheres = 0.0;
    for (std::size_t i = 0; i < packing.size(); ++i) {
        const std::int32_t body = surface.body_of_centre[i];
        if (body < 0 || !std::isfinite(surface.bodies[std::size_t(body)].corrected_volume)) continue;
        spheres += 4.0 / 3.0 * std::numbers::pi * std::pow(packing.radius_of(i), 3);
    }
    for (const Body& body : surface.bodies)
        if (std::isfinite(body.corrected_volume)) result.volume += body.corrected_volume;
    if (!(result.volume > 0.0)) return std::nullopt;
    result.density = spheres / result.volume;
    return result;
}

}  // namespace tomodem::fields
