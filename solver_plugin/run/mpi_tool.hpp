#pragma once
#include <mpi.h>

#include "core/cli/cli.hpp"

namespace tomodem {

/// MPI of a tool, from its beginning to its end.
class MpiTool {
 public:
    MpiTool(int& argc, char**& argv);
    bool first() const { return first_; }
    /// Ends MPI. @return the highest status of all processes
    /// Where one failed and another does not come to its end within some seconds, all are ended: that one would wait
    /// for ever.
    int end(int status);

 private:
    bool first_;
};

/// The main() of a tool that runs under mpirun: only the first process speaks, and a failure of one ends all.
template <class Request>
int mpi_main(int argc, char** argv, cli::Usage (*usage)(Request&), void (*run)(const Request&, cli::Tool&)) {
    MpiTool mpi(argc, argv);
    return mpi.end(cli::main(argc, argv, usage, run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}

}  // namespace tomodem
