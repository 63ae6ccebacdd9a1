#pragma once
#include <mpi.h>

namespace tomodem {

/// How a process that failed waits for the others: whether the request completes within five seconds.
bool completes_soon(MPI_Request& request);

}  // namespace tomodem
