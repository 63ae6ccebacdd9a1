#include "solver_plugin/simulation/completes_soon.hpp"

#include <time.h>

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

}  // namespace tomodem
