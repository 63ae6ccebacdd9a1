#pragma once
#include <mpi.h>

#include <filesystem>
#include <string>

#include "core/base/provenance.hpp"
#include "core/base/reporter.hpp"
#include "core/volume/volume.hpp"
#include "solver_plugin/run/solver.hpp"
#include "tools/relax/carve.hpp"

namespace tomodem::relax {

/// What `carve` is asked for.
struct CarveRequest {
    std::filesystem::path sample, scene, carved, table, pores;
    std::string image;     ///< see open_volume
    VolumeOptions volume;  ///< how it is read
    CarveOptions carve;
    double pore_error = 5, total_error = 2;  // %
    std::int64_t max_iterations = 30;
    RestLimits limits;
    bool resume = false;
};

/// Takes particles out and relaxes, in turns, until the pores have their volume; writes the sample, the tables and,
/// after each iteration, the state that `resume` starts from. Collective.
/// @throws InvalidInput if the image does not fit the sample, a pore ends too large, or it takes too many iterations
/// @param threads  for the image and what looks at it, on the first process
void carve(const CarveRequest& request, const Provenance& provenance, int threads, MPI_Comm communicator,
           Reporter& reporter);

}  // namespace tomodem::relax
