#pragma once
#include <mpi.h>

#include <chrono>
#include <cstdint>

#include "core/scene/model.hpp"
#include "solver_plugin/run/solver.hpp"
#include "solver_plugin/simulation/simulation.hpp"

/// Rest before a load, and the signals that end it or the load.
namespace tomodem::plugin {

/// A signal asks for the end of the run; thrown on every process.
struct Stopped {
    int signal;
};

/// Looks for signals between steps. What one process sees, all see.
class Watch {
 public:
    explicit Watch(MPI_Comm communicator) : communicator_(communicator) {}

    /// @throws Stopped
    std::int64_t next_piece(std::int64_t step);

 private:
    MPI_Comm communicator_;
    std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
    std::int64_t step_ = 0, piece_ = 16;
};

Simulation::Watch watching(Watch& watch, const Simulation& simulation);

/// For a given number of periods.
void rest_inside(Simulation& simulation, const Model& model, double periods, const Simulation::Watch& watch,
                 Reporter& reporter);

struct Rest {
    bool reached = false;
    double periods = 0, energy_ratio = 0, force_balance = 0;
};

/// Until the sample is at rest: looked at once a period. Warns when it is not after limits.max_periods.
Rest relax_inside(Simulation& simulation, const Model& model, const RestLimits& wanted, const Simulation::Watch& watch,
                  Reporter& reporter);

}  // namespace tomodem::plugin
