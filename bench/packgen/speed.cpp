// bench_packgen [PARTICLES ...]: time of a packing on one and two threads, and with the baseline instruction set.
//
// The runs of a row follow one another within a minute and are compared to each other only, as machines are noisy. A
// CPU time much below threads x time shows that the machine was busy, not that the work does not scale.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "tools/packgen/compaction.hpp"
#include "tools/packgen/contact_force.hpp"

using namespace tomodem::packgen;

namespace {

struct Cost {
    double seconds, cpu_seconds;
    long steps;
};

Cost measured(long particles, double density, int threads, InstructionSet instructions) {
    use_instruction_set(instructions);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    const CompactedPacking made = compact({.particles = particles, .density = density, .threads = threads});
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC, static_cast<long>(made.steps)};
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<long> sizes{5000, 50000};
    if (argc > 1) sizes.clear();
    for (int k = 1; k < argc; ++k) sizes.push_back(std::atol(argv[k]));
    std::printf("%9s %7s %6s | %28s | %28s | %17s | %15s\n", "particles", "density", "steps", "1 thread: s, cpu s, 1/s",
                "2 threads: s, cpu s, 1/s", "2 threads/1: time", "SSE2/best: cpu");
    for (const long particles : sizes) {
        for (const double density : {0.65, 0.74}) {
            const Cost one = measured(particles, density, 1, InstructionSet::best);
            const Cost two = measured(particles, density, 2, InstructionSet::best);
            const Cost baseline = measured(particles, density, 1, InstructionSet::baseline);
            const double count = static_cast<double>(particles);
            std::printf("%9ld %7.2f %6ld | %8.2f %8.2f %10.0f | %8.2f %8.2f %10.0f | %17.2f | %15.2f\n", particles,
                        density, one.steps, one.seconds, one.cpu_seconds, count / one.seconds, two.seconds,
                        two.cpu_seconds, count / two.seconds, two.seconds / one.seconds,
                        baseline.cpu_seconds / one.cpu_seconds);
            std::fflush(stdout);
        }
    }
    return 0;
}
