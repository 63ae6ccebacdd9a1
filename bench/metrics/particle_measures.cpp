// bench_particle_measures [PARTICLES]: time and memory of the measures of particles, one frame, in memory.
//
// The sample is bcc at D = 0.68, every centre moved at random by a tenth of a diameter, in a free block; the deformed
// one is compressed by 0.3 and moved again. Each measure is timed on one thread and on all; memory is what its own
// process has at most.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/packing/structure.hpp"
#include "tools/metrics/fields/control.hpp"
#include "tools/metrics/fields/local_strain_fit.hpp"
#include "tools/metrics/fields/space_average.hpp"

using namespace tomodem;
using namespace tomodem::fields;

namespace {

Packing shaken_lattice(std::size_t count) {
    const double edge = 2.0 / std::sqrt(3.0);
    const int cells = int(std::ceil(std::cbrt(double(count) / 2.0)));
    std::mt19937_64 generator(1);
    std::normal_distribution<double> shake(0.0, 0.1);
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box.edges = Vec3::Constant(edge * cells);
    for (int k = 0; k < cells; ++k)
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                for (const double shift : {0.0, 0.5}) {
                    if (packing.position.size() == count) continue;
                    const Vec3 moved(shake(generator), shake(generator), shake(generator));
                    packing.position.push_back(edge * Vec3(i + shift, j + shift, k + shift) + moved);
                    packing.species.push_back(1 + i % 2);
                    packing.id.push_back(std::int64_t(packing.id.size()) + 1);
                }
    return packing;
}

/// In a process of its own, whose time and memory are those of the measure and, of the memory, the sample.
void measure(const char* name, int threads, const std::function<void(int)>& work) {
    std::fflush(stdout);
    int channel[2];
    if (pipe(channel) != 0) std::exit(1);
    const pid_t child = fork();
    if (child == 0) {
        const auto start = std::chrono::steady_clock::now();
        work(threads);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (write(channel[1], &seconds, sizeof seconds) != sizeof seconds) _exit(1);
        _exit(0);
    }
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    double seconds = 0.0;
    if (status != 0 || read(channel[0], &seconds, sizeof seconds) != sizeof seconds) std::exit(1);
    close(channel[0]);
    close(channel[1]);
    const auto time = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    std::printf("%-34s %d %8.2f s %8.2f s of CPU %8.0f MB\n", name, threads, seconds,
                time(usage.ru_utime) + time(usage.ru_stime), double(usage.ru_maxrss) / 1024.0);
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 500'000;
    const Packing packing = shaken_lattice(count);
    std::mt19937_64 generator(2);
    std::normal_distribution<double> shake(0.0, 0.1);
    std::vector<Vec3> present;
    std::vector<double> stress;
    for (const Vec3& p : packing.position) {
        present.push_back(p.cwiseProduct(Vec3(std::exp(0.15), std::exp(0.15), std::exp(-0.3))) +
                          Vec3(shake(generator), shake(generator), shake(generator)));
        for (int k = 0; k < 6; ++k) stress.push_back(1e8 * shake(generator));
    }
    std::printf("%zu particles; what the sample itself takes is in the memory\n", packing.size());

    const Box& box = packing.box;
    const int all = int(std::thread::hardware_concurrency());
    for (const int threads : {1, all}) {
        measure("contacts", threads, [&](int n) { contact_detail(packing, 1.0, OpenFaces::free, n); });
        measure("contacts within crowns", threads, [&](int n) { contact_detail(packing, 1.5, OpenFaces::free, n); });
        measure("common neighbours and surface", threads, [&](int n) {
            const NeighbourTable near(packing.position, box, 1.7, n);
            common_neighbour_analysis(near, n);
            surface_points(near, n);
        });
        for (const double radius : {1.5, 3.0}) {
            const std::string reach = radius == 1.5 ? " 3 r_s" : " 6 r_s";
            measure(("stress, ball" + reach).c_str(), threads, [&](int n) {
                averaged_in_space(packing.position, box, stress, 6, {.kernel = Kernel::ball, .radius = radius}, n);
            });
            measure(("stress, Gaussian" + reach).c_str(), threads, [&](int n) {
                averaged_in_space(packing.position, box, stress, 6, {.kernel = Kernel::gaussian, .radius = radius}, n);
            });
            measure(("strain" + reach).c_str(), threads,
                    [&](int n) { local_strain(packing.position, box, present, box, radius, 1.0, {}, n); });
        }
    }
    measure("density (alpha shape)", 1, [&](int) { deformed_density(packing); });
}
