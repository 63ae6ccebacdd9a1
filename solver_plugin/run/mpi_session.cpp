#include "solver_plugin/run/mpi_session.hpp"

#include <mpi.h>

#include "core/packing/hdf5_file.hpp"
#include "solver_plugin/simulation/completes_soon.hpp"

namespace tomodem {

MpiSession::MpiSession(int& argc, char**& argv) {
    hdf5_lock();  // HDF5 that finds MPI running hooks itself into its end, and crashes there after a full disk
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    first_ = rank == 0;
}

int MpiSession::end(int status) {
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
