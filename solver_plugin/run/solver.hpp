#pragma once
#include <mpi.h>

#include <cstdint>
#include <filesystem>

#include "core/base/provenance.hpp"
#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"

/// The solver's public face: what `solve` and `relax` are made of. Every call is collective over the communicator.
namespace tomodem {

/// What a computation cost.
struct Cost {
    std::int64_t steps = 0;
    double wall_seconds = 0.0;
    double cpu_seconds = 0.0;     ///< all processes
    std::int64_t peak_bytes = 0;  ///< all processes
    std::int64_t neighbour_builds = 0;
    /// Of all pair forces in quasi-static steps, those of the load alone in a run that relaxed its sample first; 0:
    /// each step took one.
    std::int64_t evaluations = 0;
    int processes = 1;
};

/// When a free sample is at rest (docs/relaxation.md), and how long that is waited for.
struct RestLimits {
    /// Kinetic energy over that of the overlapping seeds, and at most over 0.003 N k_rep r_s^2, which BILIN has at
    /// rest.
    double energy_ratio = 0;
    /// Net force on a particle (root mean square) over the sum of its pair forces (mean over the particles).
    double force_balance = 0;
    double max_periods = 1000;  ///< then it ends all the same, with a warning
};

/// Beyond them no geometry changes by more than 2e-4. A viscous sample (NORTON) creeps to rest, and moves no more to
/// speak of much earlier.
RestLimits default_rest_limits(const Model& model);

/// Periods until a dense sample of BILIN, filled at D = 0.65, is at rest within the default limits: to foresee the
/// cost.
double expected_relaxation_periods(std::int64_t particles);

struct Relaxation {
    Packing sample;                   ///< at rest, `relaxed`; complete on the first process only
    bool at_rest = false;             ///< within the limits
    double periods = 0;               ///< natural periods until then
    double energy_ratio = 0;          ///< at the end [-]
    double force_balance = 0;         ///< at the end [-]
    double residual_energy = 0.0;     ///< kinetic energy at the end over N k_rep r_s^2 [-]
    double largest_displacement = 0;  ///< over the seed radius [-]
    Cost cost;
};

/// Lets the free sample come to rest under its law (thesis section 5.3), in natural periods of 20 time steps, the same
/// for every particle, with a viscous drag.
/// @param limits  zeros in it stand for those of default_rest_limits()
/// @throws InvalidInput if the scene does not fit the sample, particles are lost, or a signal stops it
Relaxation come_to_rest(const Packing& sample, const Scene& scene, const RestLimits& limits, MPI_Comm communicator,
                        Reporter& reporter = silent_reporter());

struct RunResult {
    Cost cost;
    double time_step = 0.0;  ///< Model::time_step [s]
    double final_strain = 0.0;
    double final_stress = 0.0;          ///< true stress at the end [Pa], tension positive
    double mean_equilibrium_error = 0;  ///< over the second half of the strain path [-]
    std::int64_t particles = 0;
    std::int64_t particles_lost = 0;
    double predicted_wall_seconds = 0;  ///< after the first seconds of the run; 0: it was over before
};

/// How a run is protected against its end: docs/running.md.
struct RunControl {
    bool resume = false;             ///< resume from RUN.checkpoint where there is one
    double checkpoint_minutes = 10;  ///< of wall time between two checkpoints; 0: none, nor at signals
};

struct Continuation;

/// Relaxes the sample if it is not, presses it as the scene says, and writes frames and curves to an H5MD file.
///
/// Curves have a point every tenth of averaging_strain; each force is a mean over the last averaging_strain. A
/// quasi-static run has a point at every step, of the forces there.
/// The true stress uses A = A0 H0 / H with A0 the section of the sample's box (docs/method.md).
///
/// While it runs, the run is in RUN.partial, readable at any moment, and RUN.checkpoint is what a later process resumes
/// from: written from time to time, when SIGTERM, SIGINT or SIGUSR1 stops the run, and when a guard does.
///
/// @throws InvalidInput if the scene does not fit the sample, particles are lost, or the packing heats up and falls
/// apart; if a signal stops it; if the checkpoint to resume from belongs to other inputs
/// @param sample  given away: its memory is free once the solver has the particles
/// @param before  an earlier run that ended with this sample, its scene accepted by check_continuation(): velocities,
///                contacts, hardening and planes go on; strain and time of the new run begin at zero. Its particles are
///                taken
RunResult solve(Packing sample, const Scene& scene, const std::filesystem::path& run_file, const Provenance& provenance,
                MPI_Comm communicator, const RunControl& control = {}, Reporter& reporter = silent_reporter(),
                Continuation* before = nullptr);

/// Whether the run file is there already, complete, from the same inputs and version.
bool is_complete(const std::filesystem::path& run_file, const Provenance& provenance);

}  // namespace tomodem
