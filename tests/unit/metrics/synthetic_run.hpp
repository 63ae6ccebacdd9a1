#pragma once
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <vector>

#include "core/packing/packing_file.hpp"

/// Run files with an answer known beforehand.
namespace tomodem::synthetic {

/// Centres of a cubic lattice inside an ellipsoid of these semi-axes around `centre`.
inline std::vector<Vec3> ellipsoid(const Vec3& semi_axes, double spacing, const Vec3& centre = Vec3::Zero()) {
    std::vector<Vec3> points;
    const Eigen::Vector3i half = (semi_axes / spacing).array().ceil().matrix().cast<int>();
    for (int k = -half.z(); k <= half.z(); ++k)
        for (int j = -half.y(); j <= half.y(); ++j)
            for (int i = -half.x(); i <= half.x(); ++i) {
                const Vec3 p = spacing * Vec3(i + 0.1, j + 0.2, k + 0.3);  // symmetric to no plane
                if (p.cwiseQuotient(semi_axes).squaredNorm() < 1.0) points.push_back(centre + p);
            }
    return points;
}

/// Centres of a cubic lattice with cells + 1 points on an edge.
inline std::vector<Vec3> cube(int cells, double spacing, const Vec3& origin = Vec3::Zero()) {
    std::vector<Vec3> points;
    for (int k = 0; k <= cells; ++k)
        for (int j = 0; j <= cells; ++j)
            for (int i = 0; i <= cells; ++i) points.push_back(origin + spacing * Vec3(i, j, k));
    return points;
}

/// A sample of one phase in a box that these centres leave a diameter of room.
inline Packing sample(std::vector<Vec3> centres, double seed_radius = 0.5) {
    Packing packing;
    packing.seed_radius = seed_radius;
    Vec3 low = centres.front(), high = low;
    for (const Vec3& p : centres) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    packing.box.origin = low - Vec3::Constant(2.0 * seed_radius);
    packing.box.edges = high - low + Vec3::Constant(4.0 * seed_radius);
    packing.position = std::move(centres);
    packing.species.assign(packing.size(), 1);
    for (std::size_t i = 0; i < packing.size(); ++i) packing.id.push_back(std::int64_t(i) + 1);
    return packing;
}

/// Appends centres as an object of its own.
inline void add_object(Packing& packing, const std::vector<Vec3>& centres, std::int32_t number) {
    packing.object.resize(packing.size(), 0);
    for (const Vec3& p : centres) {
        packing.position.push_back(p);
        packing.species.push_back(2);
        packing.object.push_back(number);
        packing.id.push_back(std::int64_t(packing.size()));
    }
}

/// Isochoric stretch to a true strain along z.
inline std::vector<Vec3> deformed(const std::vector<Vec3>& positions, double strain) {
    const Vec3 stretch(std::exp(-0.5 * strain), std::exp(-0.5 * strain), std::exp(strain));
    std::vector<Vec3> result;
    for (const Vec3& p : positions) result.push_back(p.cwiseProduct(stretch));
    return result;
}

struct Loading {
    double rate = 1e-3;    ///< 1/s, the strain is -rate * time
    double strain = 0.35;  ///< |strain| at the end
    int points = 351, frames = 8;
    std::function<double(double)> stress_true = [](double) { return -1e8; };  ///< Pa, of the (negative) strain
    double equilibrium_error = 0.0;                                           ///< of every point
    double volume_factor = 1.0;                                               ///< at the last frame
};

/// A compression of the packing, every curve as the solver writes it.
inline void write_run(const Packing& packing, const std::filesystem::path& path, const Loading& loading) {
    RunWriter writer(packing, path, {.tool = "test", .version = "0", .command_line = "", .scene = "", .inputs = {}});
    const double section = packing.box.edges.x() * packing.box.edges.y();
    for (int i = 0; i < loading.points; ++i) {
        const double share = double(i) / (loading.points - 1);
        const double strain = -loading.strain * share, time = loading.strain / loading.rate * share;
        const double stress = loading.stress_true(strain), force = stress * section * std::exp(-strain);
        const auto add = [&](const char* name, const char* unit, double value) {
            writer.add_observable(name, unit, i, time, value);
        };
        add("strain", "", strain);
        add("stress_true", "Pa", stress);
        add("stress_engineering", "Pa", stress * std::exp(-strain));
        add("force_top", "uN", force * (1.0 + 0.5 * loading.equilibrium_error));
        add("force_bottom", "uN", -force * (1.0 - 0.5 * loading.equilibrium_error));
        add("equilibrium_error", "", loading.equilibrium_error);
    }
    for (int i = 0; i < loading.frames; ++i) {
        const double share = double(i) / (loading.frames - 1);
        std::vector<Vec3> positions = deformed(packing.position, -loading.strain * share);
        for (Vec3& p : positions) p *= std::cbrt(1.0 + share * (loading.volume_factor - 1.0));
        writer.add_frame({i, loading.strain / loading.rate * share, std::move(positions)});
    }
    writer.commit();
}

}  // namespace tomodem::synthetic
