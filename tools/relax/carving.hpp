#pragma once
#include <mpi.h>

#include <filesystem>

#include "core/volume_cli.hpp"
#include "solver_plugin/solver.hpp"
#include "tools/relax/carve.hpp"

namespace tomodem {

/// What `carve` is asked for.
struct CarveRequest {
    std::filesystem::path sample, scene, carved, table, pores;
    VolumeRequest volume;
    CarveOptions carve;
    double pore_error = 5, total_error = 2;  // %
    std::int64_t max_iterations = 30;
    RestLimits limits;
    bool resume = false;
};

/// Takes particles out and relaxes, in turns, until the pores have their volume; writes the sample, the tables and,
/// after each iteration, the state that `resume` goes on from. Collective.
/// @throws InvalidInput if the image does not fit the sample, a pore ends too large, or it takes too many iterations
void carve(const CarveRequest& request, MPI_Comm communicator);

}  // namespace tomodem
