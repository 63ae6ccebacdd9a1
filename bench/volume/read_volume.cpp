// Reads a volume as every tool does and prints what it cost: one process, so that its peak memory is that of reading.
//
// usage: bench_read_volume VOLUME [THRESHOLD]
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/volume/volume.hpp"

int main(int argc, char** argv) {
    using namespace tomodem;
    if (argc < 2) return 2;
    VolumeOptions options;
    options.voxel_size = Vec3(1e-3, 1e-3, 0);
    if (argc > 2) options.thresholds = {std::stod(argv[2])};
    const auto start = std::chrono::steady_clock::now();
    const int threads = std::max(1u, std::thread::hardware_concurrency());
    const LabelVolume volume = read_image(argv[1], options, threads, silent_reporter()).volume;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rusage own{};
    getrusage(RUSAGE_SELF, &own);
    const VoxelIndex size = volume.size();
    const double voxels = double(size[0]) * size[1] * size[2];
    fmt::print("{:.0f} million voxels/s, {:.2f} s, peak {:.2f} GB, labels {:.2f} GB ({:.2f} bytes a voxel)\n",
               voxels / seconds / 1e6, seconds, 1024e-9 * static_cast<double>(own.ru_maxrss),
               1e-9 * static_cast<double>(volume.memory()), static_cast<double>(volume.memory()) / voxels);
}
