// bench_envelope BRICK.h5 [LARGEST]: volumes of shapes cut out of a periodic random packing against the truth.
//
// A ball, a cube and a ring (3:1) of 300 to LARGEST (1e5) particles, at random places and turned at random; a pore is
// the ball taken out of a ball of twice its radius. Prints the error of the envelope and of the corrected volume in
// percent, mean and standard deviation, and how many of the bodies have the right genus and number of shells.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "core/packing/packing_file.hpp"
#include "core/surface/alpha_surface.hpp"

using namespace tomodem;

namespace {

struct Shape {
    const char* name;
    double unit_volume, reach;  // of the shape of size 1
    std::int64_t genus;
    bool pore;
    std::function<bool(const Vec3&)> inside;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: bench_envelope BRICK.h5 [LARGEST]\n"), 2;
    const Packing brick = read_packing(argv[1]);
    const double largest = argc > 2 ? std::atof(argv[2]) : 1e5;
    const Vec3 edges = brick.box.edges;
    const double number_density = double(brick.size()) / brick.box.volume();
    const double pi = std::numbers::pi;
    const std::vector<Shape> shapes{
        {"sphere", 4.0 / 3.0 * pi, 1.0, 0, false, [](const Vec3& p) { return p.squaredNorm() < 1.0; }},
        {"cube", 1.0, 0.87, 0, false, [](const Vec3& p) { return p.cwiseAbs().maxCoeff() < 0.5; }},
        {"torus", 2.0 * pi * pi / 9.0, 1.34, 1, false,
         [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1.0, p.z()) < 1.0 / 3.0; }},
        {"pore", 4.0 / 3.0 * pi, 2.0, 0, true,
         [](const Vec3& p) { return p.squaredNorm() >= 1.0 && p.squaredNorm() < 4.0; }}};
    std::mt19937_64 random(1);
    std::printf("D %.2f\n%-8s %10s %20s %20s %10s\n", brick.density(), "shape", "particles", "envelope %",
                "corrected %", "topology");
    for (const Shape& shape : shapes)
        for (const double wanted : {300.0, 1e3, 3e3, 1e4, 3e4, 1e5}) {
            if (wanted > largest) continue;
            // A pore is named by the number of particles that would fill it.
            const double size = std::cbrt(wanted / number_density / shape.unit_volume);
            const double truth = shape.unit_volume * size * size * size;
            const int places = wanted > 2e4 ? 4 : 12;
            double sum[2] = {}, squares[2] = {};
            int right = 0;
            for (int place = 0; place < places; ++place) {
                std::uniform_real_distribution<double> uniform(0.0, 1.0);
                std::normal_distribution<double> normal;
                const Vec3 middle(uniform(random), uniform(random), uniform(random));
                const Eigen::Quaterniond turn =
                    Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
                const Vec3 centre = middle.cwiseProduct(edges);
                const double reach = shape.reach * size;
                std::vector<Vec3> centres;
                Eigen::Vector3i low, high;
                for (int c = 0; c < 3; ++c) {
                    low[c] = int(std::floor((centre[c] - reach) / edges[c]));
                    high[c] = int(std::floor((centre[c] + reach) / edges[c]));
                }
                for (int k = low.z(); k <= high.z(); ++k)
                    for (int j = low.y(); j <= high.y(); ++j)
                        for (int i = low.x(); i <= high.x(); ++i)
                            for (const Vec3& p : brick.position) {
                                const Vec3 at = p - brick.box.origin + edges.cwiseProduct(Vec3(i, j, k)) - centre;
                                if (shape.inside(turn * at / size)) centres.push_back(at);
                            }
                const AlphaSurface surface =
                    alpha_surface(centres, {.probe_radius = default_probe_radius(brick.seed_radius),
                                            .progress = {},
                                            .seed_radius = brick.seed_radius});
                const Body none{};
                const Body& body = !shape.pore             ? surface.bodies.front()
                                   : surface.pores.empty() ? none
                                                           : surface.pores.front();
                const double errors[2] = {body.volume / truth - 1.0, body.corrected_volume / truth - 1.0};
                for (int m = 0; m < 2; ++m) sum[m] += errors[m], squares[m] += errors[m] * errors[m];
                right += body.genus == shape.genus && body.shells == 1 && surface.bodies.size() == 1 &&
                         surface.pores.size() == std::size_t(shape.pore);
            }
            std::printf("%-8s %10.0f", shape.name, wanted);
            for (int m = 0; m < 2; ++m) {
                const double mean = sum[m] / places;
                std::printf("    %+7.2f +- %5.2f", 100.0 * mean,
                            100.0 * std::sqrt(std::max(0.0, squares[m] / places - mean * mean)));
            }
            std::printf("   %5d/%d\n", right, places);
            std::fflush(stdout);
        }
    return 0;
}
