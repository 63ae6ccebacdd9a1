#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/law/norton_law.hpp"
#include "core/law/pair.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

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
    double time_step;                ///< s
    std::vector<PhaseModel> phases;  ///< those that the sample contains, in the order of their labels
    bool trilin = false;             ///< bounded attraction
    /// NORTON's law; the pairs of the phases say stiffness and period of its cores.
    std::optional<law::Norton> norton = {};
    double radius_dispersion = 0;  ///< standard deviation over the mean
    bool between_objects = false;  ///< attraction only within an object
    bool self_contact = false;
    Lateral lateral = Lateral::free;  ///< periodic sides have the edges of the sample's box
    double healing_time = std::numeric_limits<double>::infinity();  ///< s

    /// Planes that pull must find particles to hold: faces are placed by layers, and the sample rests between them.
    bool planes_hold() const { return trilin || norton.has_value(); }
};

/// Chooses the time step and the constants of every phase that occurs in the sample.
///
/// A BILIN phase given by norton gets, at the scene's highest rate, the flow stress K rate^M and the chi of that M; on
/// the rate-insensitive plateau the natural period is the shortest stable one. A TRILIN phase gets the calibrated
/// constants of that law, at ten steps a natural period. NORTON's are those of norton_model().
///
/// @throws InvalidInput: a label that the scene does not name, a phase without particles, M out of reach, a time step
///         too long for a natural period (unstable), objects asked for that the sample does not tell apart,
///         lateral = "periodic" for a sample whose box is not
Model compile_model(const Scene& scene, const Packing& sample);

/// Of rest between planes that pull, for the faces to lie against them.
inline constexpr double seating_periods = 20;

/// Steps of a relaxation: `periods` of 20 steps; with NORTON each of them takes 0.003 of strain at the load's rate,
/// which its viscosity needs.
std::int64_t relaxation_steps(const Model& model, double periods);

}  // namespace tomodem
