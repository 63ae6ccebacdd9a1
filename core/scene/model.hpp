#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/law/pair.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

/// What the model of one law holds and no other's: a law derives its own.
struct LawConstants {
    virtual ~LawConstants() = default;
};

/// Constants of one phase in the solver's lengths (those of the scene, where the seed radius is scene.seed_radius).
struct PhaseModel {
    std::int32_t label;
    law::Pair pair;         ///< between two particles of this phase
    double natural_period;  ///< t0 [s]
    double mass;            ///< k_rep t0^2 / (4 pi^2) [g]
    double chi;             ///< rate t0^2 / time_step at the highest rate [-]
    std::optional<Hardening> hardening = {};
};

/// A scene compiled for a sample: everything the solver needs besides the positions.
struct Model {
    double seed_radius;              ///< mm, in the scene's lengths
    double crown_radius;             ///< mm
    double time_step;                ///< s; quasi-static: of a step at the highest rate
    std::vector<PhaseModel> phases;  ///< those that the sample contains, in the order of their labels
    const Law* law = &bilin_law();
    Scheme scheme = Scheme::explicit_steps;
    double strain_per_step = 0;  ///< quasi-static: of the load, each segment with a time step of its own [-]
    double imbalance = 0;  ///< quasi-static: net force over viscous force on the particles that a solution may have
    double height = 0;     ///< of the sample that the constants are chosen for, centre to centre, in seed diameters
    std::shared_ptr<const LawConstants> constants = {};  ///< what the law keeps beside those of the phases
    double radius_dispersion = 0;                        ///< standard deviation over the mean
    bool objects_only_push = false;                      ///< attraction only within an object
    bool self_contact = false;
    Lateral lateral = Lateral::free;  ///< periodic sides have the edges of the sample's box
    double healing_time = std::numeric_limits<double>::infinity();  ///< s
};

/// Chooses the time step and the constants of every phase that occurs in the sample, as the scene's law does it
/// (Law::compile).
///
/// @throws InvalidInput: a label that the scene does not name, a phase without particles, M out of reach, a time step
///         too long for a natural period (unstable), objects asked for that the sample does not distinguish,
///         lateral = "periodic" for a sample whose box is not; a name that belongs to another label in the sample
/// @param height  Model::height instead of that of the sample: a run that continues keeps that of its beginning
Model compile_model(const Scene& scene, const Packing& sample, std::optional<double> height = {});

/// A name that sample and scene both know must be of the same label in both: swapped labels give wrong numbers in
/// silence.
/// @throws InvalidInput naming both
void check_names(const Scene& scene, const Packing& sample);

/// Phases that have another name in the sample, one line each: a question of words, or a wrong label.
std::vector<std::string> other_names(const Scene& scene, const Packing& sample);

/// Of the forces of the two planes: above, the curves say more of inertia than of the material.
inline constexpr double large_equilibrium_error = 0.1;

/// Of rest between planes that pull, for the faces to lie against them.
inline constexpr double seating_periods = 20;

/// Time steps of one period of a relaxation, of a law that does not ask for others: all particles swing with it.
inline constexpr double relaxation_steps_per_period = 20;

/// Steps of a relaxation of so many periods.
std::int64_t relaxation_steps(const Model& model, double periods);

}  // namespace tomodem
