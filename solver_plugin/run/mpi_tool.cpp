#include "solver_plugin/run/mpi_tool.hpp"

#include <mpi.h>
#include <time.h>

#include "core/packing/hdf5_file.hpp"

namespace tomodem {

bool completes_soon(MPI_Request& request) {
    constexpr int patience_hundredths = 500;
    int arrived = 0;
    for (int waited = 0; waited < patience_hundredths; ++waited) {
        MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
        if (arrived) return true;
        const timespec pause{0, 10'000'000};
        nanosleep(&pause, nullptr);
    }
    return false;
}

MpiTool::MpiTool(int& argc, char**& argv) {
    hdf5_lock();  // HDF5 that finds MPI running hooks itself into its end, and crashes there after a full disk
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    first_ = rank == 0;
}

int MpiTool::end(int status) {
    int highest = status;
    MPI_Request request;
    MPI_Iallreduce(&status, &highest, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
    if (status == 0)
        MPI_Wait(&request, MPI_STATUS_IGNORE);
    else if (!completes_soon(request))
        MPI_Abort(MPI_COMM_WORLD, status);
    MPI_Finalize();
    return highest;
}

}  // namespace tomodem
