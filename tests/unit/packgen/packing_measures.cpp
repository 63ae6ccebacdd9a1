#include "tests/unit/packgen/packing_measures.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace tomodem::packgen {

std::vector<Pair> pairs_within(const Packing& packing, double reach) {
    std::vector<Pair> pairs;
    const double edge = packing.box.edges[0], diameter = 2.0 * packing.seed_radius;
    for (std::size_t i = 0; i < packing.size(); ++i) {
        for (std::size_t j = i + 1; j < packing.size(); ++j) {
            Vec3 l = packing.position[j] - packing.position[i];
            for (int k = 0; k < 3; ++k) l[k] -= edge * std::nearbyint(l[k] / edge);
            const double squared = l.squaredNorm() / (diameter * diameter);
            if (squared < reach * reach) pairs.push_back({i, j, l.normalized(), std::sqrt(squared)});
        }
    }
    return pairs;
}

std::vector<double> radial_distribution(const Packing& packing, double reach, std::size_t shells) {
    std::vector<double> g(shells, 0.0);
    const double width = reach / static_cast<double>(shells), particles = static_cast<double>(packing.size());
    for (const Pair& pair : pairs_within(packing, reach)) g[static_cast<std::size_t>(pair.distance / width)] += 2.0;
    const double number_density = (particles - 1.0) / packing.box.volume() * std::pow(2.0 * packing.seed_radius, 3);
    for (std::size_t k = 0; k < shells; ++k) {
        const double inner = static_cast<double>(k) * width, outer = inner + width;
        g[k] /=
            particles * number_density * 4.0 / 3.0 * std::numbers::pi * (outer * outer * outer - inner * inner * inner);
    }
    return g;
}

Eigen::Matrix3d fabric(const std::vector<Pair>& pairs) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Pair& pair : pairs) sum += pair.direction * pair.direction.transpose();
    return sum / static_cast<double>(pairs.size());
}

double global_q6(const std::vector<Pair>& pairs) {
    double squared = 0.0;
    for (unsigned m = 0; m <= 6; ++m) {
        std::complex<double> sum = 0.0;
        for (const Pair& pair : pairs) {
            const double theta = std::acos(pair.direction.z());
            const double phi = std::atan2(pair.direction.y(), pair.direction.x());
            sum += std::sph_legendre(6, m, theta) * std::polar(1.0, m * phi);
        }
        squared += (m == 0 ? 1.0 : 2.0) * std::norm(sum / static_cast<double>(pairs.size()));
    }
    return std::sqrt(4.0 * std::numbers::pi / 13.0 * squared);
}

double number_variance(const Packing& packing, int cells) {
    std::vector<double> count(static_cast<std::size_t>(cells * cells * cells), 0.0);
    for (const Vec3& p : packing.position) {
        const Eigen::Vector3i c = (p / packing.box.edges[0] * cells).array().floor().cast<int>();
        ++count[static_cast<std::size_t>((c.z() * cells + c.y()) * cells + c.x())];
    }
    const double mean = static_cast<double>(packing.size()) / static_cast<double>(count.size());
    double variance = 0.0;
    for (const double n : count) variance += (n - mean) * (n - mean);
    return variance / static_cast<double>(count.size()) / mean;
}

Packing fcc(int cells) {
    Packing packing;
    packing.box = {Vec3::Zero(), Vec3::Constant(cells * std::numbers::sqrt2), {true, true, true}};
    packing.seed_radius = 0.5;
    for (int x = 0; x < cells; ++x)
        for (int y = 0; y < cells; ++y)
            for (int z = 0; z < cells; ++z)
                for (const Vec3& atom : {Vec3(0, 0, 0), Vec3(.5, .5, 0), Vec3(.5, 0, .5), Vec3(0, .5, .5)})
                    packing.position.push_back((Vec3(x, y, z) + atom) * std::numbers::sqrt2);
    return packing;
}

}  // namespace tomodem::packgen
