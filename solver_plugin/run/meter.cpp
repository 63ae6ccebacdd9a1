#include "solver_plugin/run/meter.hpp"

#include <sys/resource.h>

namespace tomodem {
namespace {

rusage own_usage() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage;
}

double own_cpu() {
    const rusage usage = own_usage();
    return usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

}  // namespace

Meter::Meter(MPI_Comm communicator) : communicator_(communicator), cpu_(own_cpu()) {}

void Meter::carry(double wall_seconds, double cpu_seconds) {
    earlier_wall_ = wall_seconds;
    earlier_cpu_ = cpu_seconds;
}

Cost Meter::cost(std::int64_t steps, std::int64_t neighbour_builds) const {
    Cost cost;
    cost.steps = steps;
    cost.neighbour_builds = neighbour_builds;
    cost.wall_seconds =
        earlier_wall_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double mine[2] = {own_cpu() - cpu_, own_usage().ru_maxrss * 1024.0};
    double all[2];
    MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, communicator_);
    cost.cpu_seconds = earlier_cpu_ + all[0];
    cost.peak_bytes = static_cast<std::int64_t>(all[1]);
    MPI_Comm_size(communicator_, &cost.processes);
    return cost;
}

}  // namespace tomodem
