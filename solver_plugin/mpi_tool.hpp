#pragma once
#include <mpi.h>
#include <time.h>

#include "core/cli.hpp"

namespace tomodem {

/// The highest status of all processes, or -1 if one of them does not come to its end within some seconds of a failure
/// here: it may wait for this one for ever.
inline int agreed_status(int status) {
    int highest = status, arrived = 0;
    MPI_Request request;
    MPI_Iallreduce(&status, &highest, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
    if (status == 0) {
        MPI_Wait(&request, MPI_STATUS_IGNORE);
        return highest;
    }
    for (int hundredths = 0; hundredths < 500; ++hundredths) {
        MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
        if (arrived) return highest;
        const timespec pause{0, 10'000'000};
        nanosleep(&pause, nullptr);
    }
    return -1;
}

/// The main() of a tool that runs under mpirun: only the first process speaks, and a failure of one ends all.
template <class Request>
int mpi_main(int argc, char** argv, cli::Usage (*usage)(Request&), void (*run)(const Request&)) {
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank != 0) cli::silence();
    const int status = cli::main(argc, argv, usage, run);
    const int all = agreed_status(status);
    if (all < 0) MPI_Abort(MPI_COMM_WORLD, status);
    MPI_Finalize();
    return all;
}

}  // namespace tomodem
