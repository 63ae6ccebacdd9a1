// NORTON: compression and tension, any rate sensitivity up to 1, whatever the time step (docs/norton.md).
#include "core/scene/laws/norton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/base/reporter.hpp"
#include "core/base/toml_reader.hpp"
#include "core/base/units.hpp"
#include "core/scene/expected_flow.hpp"
#include "core/scene/law.hpp"

namespace tomodem {
namespace {

using C = law::NortonConstants;

constexpr const char* inertia_key = "inertia_share";
constexpr const char* reference_key = "reference_rate";

constexpr double usual_inertia_share = 0.02;
/// m rate^2 / (K rate^M d): more makes no step longer that matters, and a jump of the rate would be lost in inertia.
constexpr double max_inertia = 1e-3;

/// Shares of m / (eta d) and of the cores' period that are stable: at 0.15 bursts of kinetic energy were seen.
constexpr double viscous_share = 0.1, elastic_share = 0.05;
/// Local rate over the lowest of the load that the viscosity of the time step is taken at.
constexpr double slow_share = 0.5;

/// What a period of a relaxation takes of the load's strain: its viscosity needs that long.
constexpr double strain_of_a_period = 0.003;

/// Strain of a quasi-static step; the planes' way in one over d, where other surfaces meet the particles and anywhere.
constexpr double quasi_static_strain = 8e-3, contact_way = 0.1, longest_way = 0.35;

/// Strength at reference_rate over the flow stress: beyond it the correction of the tractions, found once a step, lags
/// behind what it corrects (docs/norton.md): 1 % of the stress at 4, 9 % at 8 and 24 % at 10, in tension.
constexpr double most_elastic = 4;

/// Force balance that the evaluations were counted at.
constexpr double usual_imbalance = 1e-2;

struct Limits {
    double inertia, viscous, elastic;  ///< [-], s, s
};

double inertia_share(const Scene& scene) {
    return number_of(scene.law_accuracy, inertia_key).value_or(usual_inertia_share);
}

Limits limits(const Scene& scene, double height, const law::Norton& law) {
    const double d = 2 * scene.seed_radius, rate = scene.highest_rate();
    const double error = inertia_share(scene);
    Limits found{std::min(max_inertia, 12 * error * C::volume / std::max(1.0, height * height)), 0, 0};
    double softest = 1e300, most_viscous = 0, strongest = 0;
    for (const law::NortonMaterial& one : law.materials) {
        softest = std::min(softest, one.consistency * std::pow(rate, one.rate_sensitivity));
        most_viscous = std::max(most_viscous,
                                one.consistency * std::pow(slow_share * scene.lowest_rate(), one.rate_sensitivity - 1));
        strongest = std::max(strongest, one.strength);
    }
    const double mass = found.inertia * softest * d / (rate * rate);
    found.viscous = viscous_share * mass / (most_viscous * d);
    found.elastic = elastic_share * 2 * std::numbers::pi * std::sqrt(mass / (C::core_stiffness * strongest * d));
    return found;
}

/// Particles must not jump over what is not a plane: the planes' way in a step, strain H / 2, is shorter then.
bool meets_other_surfaces(const Scene& scene) {
    return !scene.walls.empty() || scene.objects_only_push;
}

double usual_strain_per_step(const Scene& scene, const Model& model) {
    double highest = 0;
    for (const LoadStep& step : scene.steps) highest = std::max(highest, step.strain);
    const double tallest = std::max(1.0, model.height) * std::exp(highest);
    return std::min(quasi_static_strain, 2 * (meets_other_surfaces(scene) ? contact_way : longest_way) / tallest);
}

/// Why the step has the strain that it has.
std::string reason_of(const Scene& scene, const Model& model) {
    if (scene.strain_per_step) return " (given)";
    if (model.strain_per_step == quasi_static_strain) return "";
    return meets_other_surfaces(scene)
               ? fmt::format(" (walls, or objects that push each other: the planes move by {:g} seed diameters)",
                             contact_way)
               : fmt::format(" (a tall sample: the planes move by {:g} seed diameters)", longest_way);
}

class NortonLaw final : public Law {
 public:
    NortonLaw()
        : Law({.name = "norton",
               .feature = "viscous_flow_and_pressure_of_the_density",
               .carries_tension = true,
               .measures_by_volume = true,
               .planes_pull = true,
               .starts_with_the_flow = true,
               .quasi_static = true,
               .self_contact = false,
               .damping = Damping::law,
               .max_energy_ratio = 1e-3,
               .max_force_balance = 1e-2,
               .max_heat = 10,
               .packing_density = 0.64,
               .keeps_density = true,
               .less_heat = inertia_key,
               .less_inertia = std::string("a smaller ") + inertia_key}) {}

    void read_phase(TomlReader& reader, Phase&) const override {
        for (const char* key : {"repulsive_stiffness", "natural_period", "stiffness_ratio", "greatest_attraction"})
            reader.refuse(key, fmt::format("{} belongs to the other laws: norton = {{ K = .., M = .. }} is all that "
                                           "law \"norton\" takes",
                                           key));
    }

    void check_phase(const TomlReader& reader, const Phase& phase) const override {
        if (!phase.norton) reader.fail(fmt::format("[phase.{}] needs norton = {{ K = .., M = .. }}", phase.name));
    }

    void read_accuracy(TomlReader& reader, Scene& scene) const override {
        const bool quasi_static = scene.scheme == Scheme::quasi_static;
        reader.refuse(
            "equilibrium_error",
            fmt::format("equilibrium_error is called {} now: how much of the stress may be inertia", inertia_key));
        reader.refuse("max_equilibrium_error", "max_equilibrium_error belongs to law \"bilin\"");
        if (const auto share = reader.optional_positive(inertia_key)) {
            if (quasi_static)
                reader.fail(reader.get(inertia_key),
                            of_explicit_steps(inertia_key) +
                                " (strain_per_step sets a quasi-static step, max_imbalance its force balance)");
            if (scene.time_step || reader.find("strain_per_step") != nullptr)
                reader.fail(reader.get(inertia_key),
                            fmt::format("{} chooses the time step: remove time_step and strain_per_step", inertia_key));
            scene.law_accuracy[inertia_key] = *share;
        }
        if (const toml::node* node = reader.find("strain_per_step"); node != nullptr && !quasi_static)
            reader.fail(*node, fmt::format("scheme = \"explicit\" of law \"norton\" chooses the time step by {}; give "
                                           "that, or time_step, or remove scheme",
                                           inertia_key));
        if (const auto rate = reader.optional_positive(reference_key, units::rate))
            scene.law_accuracy[reference_key] = *rate;
    }

    void check_scene(TomlReader& root, const Scene& scene) const override {
        if (const toml::node* node = root.find("crown_radius");
            node != nullptr && std::abs(scene.crown_radius / scene.seed_radius - C::crown) > 1e-9)
            root.fail(*node, "law \"norton\" is made for a crown_radius of 1.5 seed radii");
        if (scene.radius_dispersion > 0)
            root.fail(root.get("radius_dispersion"), "law \"norton\" is made for equal radii");
    }

    std::shared_ptr<const CalibrationWindow> read_calibration(TomlReader& reader) const override {
        NortonCalibration found;
        found.flow = reader.positive("flow");
        found.sensitivity = reader.range("sensitivity");
        found.rate_ratio = reader.number("rate_ratio", 1);
        found.error = read_errors(reader);
        read_window(reader, found, false);
        return std::make_shared<const NortonCalibration>(std::move(found));
    }

    /// One mass for every particle: what keeps the inertial share of the stress, n m rate^2 H^2 / 12 over K rate^M at
    /// the highest rate, within its bound for the softest phase. The time step is the longest stable one: a tenth of m
    /// / (eta d) at half the lowest rate, or a twentieth of the cores' period. Quasi-static steps have no mass and no
    /// such limit: the masses only make energies that the guards of a run can judge.
    void compile(const Scene& scene, const Packing& sample, Model& model) const override {
        if (!sample.radius.empty())
            throw InvalidInput(fmt::format(
                "scene '{}': law \"norton\" is made for equal radii but the particles of the sample have radii "
                "of their own; make the brick without --dispersion",
                scene.path.string()));
        const auto constants = std::make_shared<NortonModel>();
        law::Norton& law = constants->norton;
        const double d = 2 * scene.seed_radius, rate = scene.highest_rate();
        law.seed_diameter = d;
        law.flow_rate = rate;
        law.min_rate = C::rate_floor * scene.lowest_rate();
        const NortonCalibration& calibration = *scene.flow_table().find<NortonCalibration>();
        const std::optional<double> given = number_of(scene.law_accuracy, reference_key);
        const double reference = given.value_or(rate);
        law.strength_follows = !given;
        double softest = 1e300;
        for (const PhaseModel& phase : model.phases) {
            const Norton& wanted = *scene.phase(phase.label).norton;
            const double consistency = wanted.consistency * pascal_per_megapascal / calibration.flow;
            law.materials.push_back(
                {consistency, wanted.rate_sensitivity, consistency * std::pow(reference, wanted.rate_sensitivity)});
            softest = std::min(softest, consistency * std::pow(rate, wanted.rate_sensitivity));
        }
        const Limits found = limits(scene, model.height, law);
        const double longest = std::min(found.viscous, found.elastic);
        model.scheme = scene.scheme;
        if (model.scheme == Scheme::quasi_static) {
            model.strain_per_step = scene.strain_per_step.value_or(usual_strain_per_step(scene, model));
            model.imbalance = scene.max_imbalance;
            model.time_step = model.strain_per_step / rate;
        } else {
            model.time_step = scene.time_step.value_or(longest);
        }
        if (model.scheme == Scheme::explicit_steps && model.time_step > longest * (1 + 1e-9))
            throw InvalidInput(
                fmt::format("scene '{}': time_step {:g} s is longer than law \"norton\" is stable with, "
                            "{:.3g} s here; take a smaller one, or none",
                            scene.path.string(), model.time_step, longest));
        const double inertia = model.scheme == Scheme::quasi_static ? max_inertia : found.inertia;
        const double mass = inertia * softest * d / (rate * rate);
        for (std::size_t k = 0; k < model.phases.size(); ++k) {
            PhaseModel& phase = model.phases[k];
            const double stiffness = C::core_stiffness * law.materials[k].strength * d;
            phase.pair = {C::core * d, C::crown * d, stiffness, 0};
            phase.mass = mass;
            phase.natural_period = 2 * std::numbers::pi * std::sqrt(mass / stiffness);
            phase.chi = 0;
        }
        model.constants = constants;
    }

    const CalibrationWindow& expect(const Scene& scene, const Phase& phase, const PhaseModel&, const Model&,
                                    ExpectedFlow& found) const override {
        const NortonCalibration& table = *scene.flow_table().find<NortonCalibration>();
        const double highest = scene.highest_rate(), sensitivity = phase.norton->rate_sensitivity;
        found.rate = {highest / table.rate_ratio, highest};
        found.packings = error_of(table.error, loads_of(scene), found);
        if (below(scene.lowest_rate(), found.rate[0]))
            found.outside.push_back(
                fmt::format("the rate falls to {:g} /s, measured from {:g} to {:g} /s of the same constants",
                            scene.lowest_rate(), found.rate[0], found.rate[1]));
        if (below(sensitivity, table.sensitivity[0]) || below(table.sensitivity[1], sensitivity))
            found.outside.push_back(fmt::format("M = {:g}, measured with {:g} to {:g}", sensitivity,
                                                table.sensitivity[0], table.sensitivity[1]));
        return table;
    }

    std::string time_step_reason(const Scene& scene, const Model& model) const override {
        if (scene.time_step) return "given in [accuracy]";
        if (model.scheme == Scheme::quasi_static)
            return fmt::format(
                "a strain of {:.3g} in a step{} at the highest rate, whatever the stability: the velocities "
                "are solved for to a force balance of {:g}",
                model.strain_per_step, reason_of(scene, model), model.imbalance);
        const Limits found = limits(scene, model.height, norton_of(model));
        const std::string inertia =
            found.inertia < max_inertia
                ? fmt::format("inertia of {:g} of the stress at this height", inertia_share(scene))
                : fmt::format("the largest mass, {:g} K rate^M d / rate^2", max_inertia);
        return found.viscous < found.elastic
                   ? fmt::format("viscous stability at half the lowest rate, with {}", inertia)
                   : fmt::format("the period of the elastic cores, with {}", inertia);
    }

    void warn(const Scene& scene, const Model& model, Reporter& reporter) const override {
        if (model.scheme == Scheme::explicit_steps && inertia_share(scene) > large_equilibrium_error)
            reporter.warn(fmt::format("{} = {:g} lets inertia carry that share of the load: take {:g}, the default",
                                      inertia_key, inertia_share(scene), usual_inertia_share));
        const std::optional<double> reference = number_of(scene.law_accuracy, reference_key);
        for (const Phase& phase : scene.phases) {
            if (!reference || !phase.norton) continue;
            const double ratio = std::pow(*reference / scene.lowest_rate(), phase.norton->rate_sensitivity);
            if (ratio > most_elastic)
                reporter.warn(fmt::format(
                    "{} = {:g} /s makes the elastic parts of phase {} {:.0f} times its flow stress at {:g} /s: beyond "
                    "{:g} the stress is unreliable; leave {} out, and they follow the load's rate",
                    reference_key, *reference, phase.name, ratio, scene.lowest_rate(), most_elastic, reference_key));
        }
    }

    /// Quasi-static steps take a whole period each.
    double relaxation_time_step(const Model& model) const override {
        if (model.scheme == Scheme::explicit_steps) return model.time_step;
        return strain_of_a_period / norton_of(model).flow_rate;
    }

    /// Measured in compressions of 2,000 to 50,000 particles, M = 0.03 to 1, 2e-3 to 2e-2 of strain in a step, balances
    /// of 1e-3 to 3e-2 (docs/norton.md): neither the number nor M matters. Pulling takes four fifths of it.
    double evaluations(const Model& model, double steps) const override {
        if (model.scheme == Scheme::explicit_steps) return steps;
        const double of_a_step = norton_of(model).materials.size() > 1 ? 17.0 : 14.8;
        return (40 + of_a_step * steps * std::pow(model.strain_per_step / quasi_static_strain, 0.18)) *
               std::pow(usual_imbalance / model.imbalance, 0.3);
    }

    double evaluations_at_rest(const Model& model) const override {
        return model.scheme == Scheme::explicit_steps ? 1 : 12;
    }

    double steps_of_a_relaxation_period(const Model& model) const override {
        if (model.scheme == Scheme::quasi_static) return 1;
        return strain_of_a_period / (norton_of(model).flow_rate * model.time_step);
    }
};

}  // namespace

const law::Norton& norton_of(const Model& model) {
    return static_cast<const NortonModel&>(*model.constants).norton;
}

const Law& norton_law() {
    static const NortonLaw law;
    return law;
}

}  // namespace tomodem
