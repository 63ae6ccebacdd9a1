#pragma once
#include <mpi.h>

#include "core/cli.hpp"

namespace tomodem {

/// The main() of a tool that runs under mpirun: only the first process speaks, and a failure of one ends all.
template <class Request>
int mpi_main(int argc, char** argv, cli::Usage (*usage)(Request&), void (*run)(const Request&)) {
    MPI_Init(&argc, &argv);
    int rank = 0, processes = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &processes);
    if (rank != 0) cli::silence();
    const int status = cli::main(argc, argv, usage, run);
    if (status != 0 && processes > 1) MPI_Abort(MPI_COMM_WORLD, status);
    MPI_Finalize();
    return status;
}

}  // namespace tomodem
