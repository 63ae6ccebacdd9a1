// bench_alpha_surface [PARTICLES | PACKING.h5]: time and memory of alpha_surface against CGAL's Alpha_shape_3.
//
// Without a packing: a lattice at the density of a packing (D = 0.68, bcc), every centre moved at random.
#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
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
#include <utility>
#include <vector>

#include "core/packing/packing_file.hpp"
#include "core/surface/alpha_surface.hpp"

using namespace tomodem;

namespace {

std::vector<Vec3> shaken_lattice(std::size_t count) {
    const double edge = 2.0 / std::sqrt(3.0);  // touching spheres of diameter 1
    const int cells = int(std::ceil(std::cbrt(double(count) / 2.0)));
    std::mt19937 generator(1);
    std::normal_distribution<double> shake(0.0, 0.1);
    std::vector<Vec3> points;
    for (int k = 0; k < cells; ++k)
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                for (const double shift : {0.0, 0.5}) {
                    if (points.size() == count) return points;
                    const Vec3 moved(shake(generator), shake(generator), shake(generator));
                    points.push_back(edge * Vec3(i + shift, j + shift, k + shift) + moved);
                }
    return points;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_3<CGAL::Alpha_shape_vertex_base_3<Kernel>,
                                                       CGAL::Alpha_shape_cell_base_3<Kernel>>;
using Shape = CGAL::Alpha_shape_3<CGAL::Delaunay_triangulation_3<Kernel, Structure>>;

double volume_by_alpha_shape_3(const std::vector<Vec3>& centres, double probe_radius, Shape::Mode mode) {
    std::vector<Kernel::Point_3> points;
    for (const Vec3& c : centres) points.emplace_back(c.x(), c.y(), c.z());
    const Shape shape(points.begin(), points.end(), probe_radius * probe_radius, mode);
    double volume = 0.0;
    for (auto cell : shape.finite_cell_handles())
        if (shape.classify(cell) == Shape::INTERIOR) volume += shape.tetrahedron(cell).volume();
    return volume;
}

struct Cost {
    double seconds, bytes, volume;
};

/// In a process of its own, whose peak memory is that of the method alone (above that of the points).
Cost measured(const std::function<double()>& method) {
    int pipe_ends[2];
    if (pipe(pipe_ends) != 0) std::exit(1);
    const pid_t child = fork();
    if (child == 0) {
        rusage before{}, after{};
        getrusage(RUSAGE_SELF, &before);
        const auto start = std::chrono::steady_clock::now();
        const double volume = method();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        getrusage(RUSAGE_SELF, &after);
        const Cost cost{seconds, 1024.0 * double(after.ru_maxrss - before.ru_maxrss), volume};
        _exit(write(pipe_ends[1], &cost, sizeof cost) == ssize_t(sizeof cost) ? 0 : 1);
    }
    close(pipe_ends[1]);
    Cost cost{};
    const bool complete = read(pipe_ends[0], &cost, sizeof cost) == ssize_t(sizeof cost);
    close(pipe_ends[0]);
    waitpid(child, nullptr, 0);
    if (!complete) {
        std::fprintf(stderr, "bench_alpha_surface: a method did not finish\n");
        std::exit(1);
    }
    return cost;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "500000";
    std::vector<Vec3> centres;
    double probe_radius = default_probe_radius(0.5);
    if (what.ends_with(".h5")) {
        const Packing packing = read_packing(what);
        centres = packing.position;
        probe_radius = default_probe_radius(packing.seed_radius);
    } else {
        centres = shaken_lattice(std::stoul(what));
    }
    const Cost ours = measured([&] { return alpha_surface(centres, {.probe_radius = probe_radius}).volume; });
    std::printf("%zu particles, probe radius %g mm\n", centres.size(), probe_radius);
    std::printf("%-28s %8s %10s %14s %8s %8s\n", "", "time/s", "memory/MB", "volume/mm^3", "x time", "x memory");
    const auto row = [&](const char* name, const Cost& cost) {
        std::printf("%-28s %8.2f %10.0f %14.3f %8.1f %8.1f\n", name, cost.seconds, cost.bytes / 1e6, cost.volume,
                    cost.seconds / ours.seconds, cost.bytes / ours.bytes);
        std::fflush(stdout);
    };
    row("alpha_surface", ours);
    const auto theirs = [&](const char* name, Shape::Mode mode) {
        row(name, measured([&] { return volume_by_alpha_shape_3(centres, probe_radius, mode); }));
    };
    theirs("Alpha_shape_3, regularized", Shape::REGULARIZED);
    theirs("Alpha_shape_3, general", Shape::GENERAL);
    return 0;
}
