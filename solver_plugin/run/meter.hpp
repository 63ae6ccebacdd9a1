#pragma once
#include <mpi.h>

#include <chrono>
#include <cstdint>

#include "solver_plugin/run/solver.hpp"

namespace tomodem {

/// What a computation costs from here on, on all processes. Every call of cost() is collective.
class Meter {
 public:
    explicit Meter(MPI_Comm communicator);
    /// Adds what earlier processes spent on the same run.
    void carry(double wall_seconds, double cpu_seconds);
    Cost cost(std::int64_t steps, std::int64_t neighbour_builds) const;

 private:
    MPI_Comm communicator_;
    double cpu_, earlier_wall_ = 0, earlier_cpu_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace tomodem
