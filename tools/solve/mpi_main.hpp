#pragma once
#include "core/cli/cli.hpp"
#include "solver_plugin/run/mpi_session.hpp"

namespace tomodem {

/// The main() of a tool that runs under mpirun (solve, relax, carve): the first process alone reports, and a failure of
/// one ends all.
template <class Request>
int mpi_main(int argc, char** argv, cli::Usage (*usage)(Request&), void (*run)(const Request&, cli::Tool&)) {
    MpiSession mpi(argc, argv);
    return mpi.end(cli::main(argc, argv, usage, run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}

}  // namespace tomodem
