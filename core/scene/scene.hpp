#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/calibration.hpp"
#include "core/scene/law.hpp"

/// What a sample is made of and what is done to it, as the user wrote it (docs/scene.md).
namespace tomodem {

inline constexpr double pascal_per_megapascal = 1e6;

/// Norton flow law sigma = K rate^M.
struct Norton {
    double consistency = 0.0;          ///< K [MPa.s^M]
    double rate_sensitivity = 0.0;     ///< M [-]
    double stress(double rate) const;  ///< [MPa] at a strain rate [1/s]
};

/// Numbers that one law alone has keys for, by key, in the units of the solver.
using LawNumbers = std::map<std::string, double, std::less<>>;

std::optional<double> number_of(const LawNumbers& numbers, std::string_view key);

/// Change of a material's strength in time: flow stress over the one at the start of the calibration.
///
/// Either a table, linear between its points and constant beyond them, or crystallisation:
/// amplitude exp(rate (t + offset) + exponent) + base (thesis section 13.1).
struct Hardening {
    std::vector<std::array<double, 2>> table;  ///< {time [s], factor}
    double amplitude = 0, rate = 0, exponent = 0, base = 1, offset = 0;
    double factor(double time) const;
};

/// One label of the image and how it deforms: either `norton`, or stiffness and natural period given.
struct Phase {
    std::string name;
    std::int32_t label = 0;
    const Law* law = nullptr;  ///< never null in a scene that was read
    std::optional<Norton> norton;
    std::optional<double> repulsive_stiffness;  ///< k_rep [uN/mm]
    std::optional<double> natural_period;       ///< t0 [s]
    double stiffness_ratio = 10.0;              ///< k_rep / k_att [-]
    LawNumbers law_numbers;                     ///< of [phase.NAME]
    std::optional<Hardening> hardening;
    bool objects = false;   ///< the sample must distinguish the connected components
    std::int64_t line = 0;  ///< in the scene file, for errors
};

/// A stretch up to a target true strain.
struct LoadStep {
    double strain = 0.0;  ///< target true strain, negative in compression
    std::vector<double>
        rate;  ///< its magnitude [1/s, 1/s^2, ...]: coefficients of a polynomial of the time in the step
    std::int64_t line = 0;
};

/// Smooth start of a flow: the rate rises over `strain`, and the particles are accelerated with it (docs/method.md).
struct Initiation {
    double strain = 0.0;
    bool affine = true;  ///< the particles are accelerated with the flow, not by the planes alone
    double noise = 0.0;  ///< random velocity over the affine velocity of two touching particles [-]
};

/// What the sides across the loading axis are: free surfaces, or periodic with no mean stress across them, or periodic
/// at constant volume.
enum class Lateral { free, periodic, isochoric };

/// How a run finds the motion of its particles.
enum class Scheme {
    explicit_steps,  ///< forces accelerate masses, in steps that are short enough to be stable
    quasi_static     ///< each step of strain is solved for the velocities at which the forces balance; there is no mass
};

/// Why a key is refused in a scene whose steps are quasi-static.
std::string of_explicit_steps(const std::string& key);

/// A rigid triangulated surface with a prescribed translation; a sensor of the force on it.
struct Wall {
    std::string name;
    std::filesystem::path surface;            ///< mesh file, relative paths already from the scene's folder
    double unit = 1.0;                        ///< length unit of the file [mm]
    std::array<double, 3> velocity{0, 0, 0};  ///< mm/s in the sample's axes and lengths
    double start = 0.0;                       ///< s since the loading began
    double stop = std::numeric_limits<double>::infinity();  ///< s
    std::int64_t line = 0;
};

struct Scene {
    std::filesystem::path path;
    std::string text;  ///< of the file, and of its calibration file if it names one

    bool unusual_values = false;  ///< accepted: core/scene/unusual_values.hpp

    double seed_radius = 0.5;  ///< r_s [mm] that the constants are meant for; a sample of another size is scaled to it
    double crown_radius = 0.75;    ///< r_c [mm]
    double radius_dispersion = 0;  ///< standard deviation of the radii over their mean [-]
    std::vector<Phase> phases;     ///< at least one, all of one law

    bool self_contact = false;
    double healing_time = std::numeric_limits<double>::infinity();  ///< s
    bool objects_only_push = false;  ///< particles of different objects do not attract each other

    int axis = 2;                        ///< 0, 1, 2 for x, y, z
    std::vector<LoadStep> steps;         ///< empty when `duration` is given
    std::optional<double> duration;      ///< s; walls alone load the sample, there are no planes
    std::optional<double> nominal_rate;  ///< 1/s, with `duration`: what constants, time step and curve points go by
    std::optional<Initiation> initiation;
    Lateral lateral = Lateral::free;
    std::int64_t load_line = 0;
    std::vector<Wall> walls;

    std::optional<double> time_step;         ///< s; chosen from strain_per_step when not given
    std::optional<double> strain_per_step;   ///< as given: step_strain() is what counts
    Scheme scheme = Scheme::explicit_steps;  ///< quasi-static under law NORTON, unless the scene says otherwise
    double max_imbalance = 1e-2;             ///< quasi-static: Model::imbalance
    LawNumbers law_accuracy;                 ///< of [accuracy]
    std::optional<Calibration> calibration;  ///< of the scene's own: [accuracy] calibration, or a table [calibration]
    std::filesystem::path calibration_file;  ///< where it was read from; empty where the scene's text holds it
    double averaging_strain = 0.01;          ///< window of the forces [-]
    std::int64_t frames = 30;                ///< frames after the initial one, equally spaced in strain

    bool write_velocity = false;  ///< of each particle, in every frame
    bool write_stress = false;    ///< of each particle, mean over the averaging window before each frame

    const Law& law() const { return *phases.front().law; }
    const Phase& phase(std::int32_t label) const;  ///< @throws InvalidInput if no phase has it
    /// The scene's own calibration, or the one that ships.
    const Calibration& flow_table() const { return calibration ? *calibration : shipped_calibration(); }
    /// Largest strain in one time step [-], the knob of speed against accuracy: as given, or the law's own.
    double step_strain() const { return strain_per_step.value_or(law().traits().strain_per_step); }
    double highest_rate() const;
    /// The lowest of the steps' rates, where they begin.
    double lowest_rate() const;
    /// Sum of |change of strain| over the steps; nominal rate times duration where there are none.
    double path_length() const;
};

/// @throws InvalidInput with the line: syntax, unknown key, missing key, wrong type or range, a string quantity without
///         unit, two phases of one label or of two laws, BILIN under tension, values that no material or press has
Scene read_scene(const std::filesystem::path& path);

/// As read_scene, for a text in memory; `name` stands for the file in errors.
///
/// A calibration file is read, and its text added to the scene's: what is stored repeats the run without that file.
/// So is the scheme that the law chose.
Scene parse_scene(const std::string& text, const std::string& name);

/// As parse_scene, for the text that a run file holds: it has been accepted once, so keys of earlier versions are
/// known by their old names, and neither unusual values nor self-contact under NORTON are refused. Where it says no
/// scheme, its run was made in explicit steps, the default then.
Scene parse_stored_scene(const std::string& text, const std::string& name);

}  // namespace tomodem
