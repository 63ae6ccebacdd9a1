#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/scene/model.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/fields/run_frames.hpp"

/// The dimensionless numbers that say in which regime a packing flows (thesis section 8.6).
namespace tomodem::fields {

/// k / (P d), eq. 8.15: about one over the relative overlap of the particles.
double stiffness_level(double stiffness, double stress, double diameter);

/// rate sqrt(m / (P d)), eq. 8.18: the time that the stress takes to move a particle over that of the flow.
double inertial_number(double rate, double mass, double stress, double diameter);

/// E_k / (P d^3), eq. 8.20. @param kinetic  mean kinetic energy of a particle
double kinetic_number(double kinetic, double stress, double diameter);

/// Constants of a phase in the lengths of the sample.
struct PhaseConstants {
    std::int32_t label = 0;
    double stiffness = 0.0;  ///< k_rep [uN/mm]
    double mass = 0.0;       ///< of a particle [g]
    double chi = 0.0;        ///< rate t0^2 / time_step at the scene's highest rate; 0 for law NORTON
    double highest_rate = 0.0;
    std::optional<Hardening> hardening;

    double chi_at(double rate) const { return chi * rate / highest_rate; }
};

/// @throws InvalidInput if the file was made without a scene, or the scene does not fit the particles
std::vector<PhaseConstants> phase_constants(const RunFrames& frames);

/// The numbers of a whole sample at one moment; those that divide by a stress or energy of zero do not exist.
struct ControlNumbers {
    struct OfPhase {
        std::int32_t label = 0;
        double stiffness = 0.0, mass = 0.0, chi = 0.0;
        std::optional<double> stiffness_level, inertial_number;
    };
    double stress = 0.0;  ///< P = |true stress| [Pa]
    double rate = 0.0;    ///< |strain rate| [1/s]
    std::vector<OfPhase> phases;
    std::optional<double> min_stiffness_level, max_inertial_number;  ///< over the phases
    std::optional<double> kinetic_number;                            ///< Q
    std::optional<double> kinetic_over_elastic;                      ///< E_k / E_p
};

/// The curves that the numbers are made of; energies are those of all particles [nJ].
struct ControlCurves {
    /// @throws InvalidInput naming the curve that the run lacks
    ControlCurves(const std::filesystem::path& run, double averaging_strain);

    curves::StrainCurves points;  ///< averaged over strain; time and strain of each point as they were
    std::vector<double> rate;     ///< |strain rate| over the stretch that ends at each point [1/s]

    /// Everything at a time, linear between the points.
    ControlNumbers at(double time, const std::vector<PhaseConstants>& phases, std::size_t particles,
                      double diameter) const;
};

/// Kinetic energy of the flow itself, of particles that follow the uniform isochoric deformation about the middle of
/// the sample [nJ].
double flow_energy(const std::vector<Vec3>& positions, const std::vector<std::int32_t>& species, int axis, double rate,
                   const std::vector<PhaseConstants>& phases, double time);

/// Volume of the spheres over that of the matter they make up.
struct Density {
    double density = 0.0;  ///< D [-]
    double volume = 0.0;   ///< mm^3, of the parts that were measured: corrected alpha shape, docs/measures.md
};

/// None where too few particles lie inside the matter to measure their volume.
/// @throws InvalidInput as alpha_surface
std::optional<Density> deformed_density(const Packing& packing);

}  // namespace tomodem::fields
