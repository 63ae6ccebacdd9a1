#pragma once
#include <mpi.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/load_path.hpp"
#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"
#include "solver_plugin/simulation/checkpoint.hpp"

/// A new load from the end of a run: docs/running.md.
namespace tomodem {

/// What a run keeps of its end beside the state of the solver, in the sample's own lengths.
struct EndOfRun {
    double strain = 0;                                ///< true strain between the planes, as their motion counts it
    double total_strain = 0;                          ///< true strain since the sample was undeformed
    double rate = 0;                                  ///< signed [1/s]
    double time_step = 0;                             ///< of the last step [s]
    double height = 0;                                ///< Model::height
    double section = 0;                               ///< mm^2
    double kinetic_energy = 0, potential_energy = 0;  ///< nJ
    std::vector<double> window;                       ///< ForceWindow::numbers()

    void save(Checkpoint& checkpoint) const;
    static EndOfRun restored(const Checkpoint& checkpoint);
};

/// The end of a run, as the beginning of another.
struct Continuation {
    std::filesystem::path run;
    std::size_t last_frame = 0;
    Scene scene;            ///< of that run
    Packing sample;         ///< at its end; the box has followed the deformation
    FoundCheckpoint state;  ///< of this process
    EndOfRun end;

    bool has_planes() const { return state.checkpoint.numbers.contains("solver_planes"); }
    /// How long the sample was under load [s].
    double time() const;
    /// Where the planes go on; they begin anew where either load is by walls alone.
    LoadBegin begin(const Scene& next) const;
};

/// Collective.
/// @throws InvalidInput if it is no run, is unfinished, or does not hold its end
Continuation read_continuation(const std::filesystem::path& run, MPI_Comm communicator);

/// @throws InvalidInput with the two values, if the scene is not one in which that run can continue: other phases, law,
///         sizes, axis or sides
void check_continuation(const Continuation& before, const Scene& next);

/// Constants of the material that are others than before, one line each. Both scenes have the same labels.
std::vector<std::string> changes(const Scene& before, const Scene& next);

/// What a relaxed sample means under a scene that may not be the one that it was relaxed under: where law, crown or
/// radii are others it is not at rest (`relaxed` becomes false). Says so, or what else has changed.
/// @param relaxed_under  text of that scene, as the sample's file holds it; empty: not known
/// @return               changes() that the rest of the sample outlasts
std::vector<std::string> check_rest(Packing& sample, const std::string& relaxed_under, const Scene& scene,
                                    Reporter& reporter);

/// The constants of a run, which are those of its beginning where it continues another.
/// @param before  null: it begins with a sample
Model model_of(const Scene& scene, const Packing& sample, const Continuation* before);

/// Makes the state that of a simulation of this model: its steps may have another length, planes that the scene does
/// not have go.
void prepare(Continuation& before, const Scene& next, const Model& model);

}  // namespace tomodem
