#pragma once
#include <Eigen/Dense>
#include <random>
#include <vector>

#include "core/law/norton_law.hpp"
#include "solver_plugin/norton/four.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

using Eigen::Vector3d;

inline constexpr double diameter = 0.8, rate = 1e-3;

/// Particles at random, none nearer than 0.6 diameters, of two materials and, where asked for, two objects.
struct Cloud {
    std::vector<double> position, velocity, radius;
    std::vector<int> type;
    std::vector<std::int32_t> id, object;

    explicit Cloud(int count, double edge = 3.2) {
        std::mt19937_64 random(3);
        std::uniform_real_distribution<double> place(0, edge), speed(-rate, rate);
        while (static_cast<int>(type.size()) < count) {
            const Vector3d point(place(random), place(random), place(random));
            bool free = true;
            for (std::size_t j = 0; j < type.size(); ++j) free = free && (point - at(j)).norm() > 0.6 * diameter;
            if (!free) continue;
            position.insert(position.end(), point.begin(), point.end());
            type.push_back(point[0] > edge / 2 ? 2 : 1);
            id.push_back(static_cast<std::int32_t>(id.size()) + 1);
            object.push_back(point[1] > edge / 2 ? 2 : 1);
            for (int c = 0; c < 3; ++c) velocity.push_back(speed(random));
        }
        radius.assign(type.size(), 0.75 * diameter);
    }
    Vector3d at(std::size_t i) const { return Vector3d(position.data() + 3 * i); }
    Vector3d speed(std::size_t i) const { return Vector3d(velocity.data() + 3 * i); }
    int count() const { return static_cast<int>(type.size()); }
    ParticleView view(bool objects = false) const {
        return {position.data(), velocity.data(), radius.data(), type.data(),
                id.data(),       count(),         count(),       objects ? object.data() : nullptr};
    }
    std::vector<Four> fours() const {
        std::vector<Four> all;
        for (int i = 0; i < count(); ++i)
            all.push_back(Four{static_cast<float>(velocity[3 * i]), static_cast<float>(velocity[3 * i + 1]),
                               static_cast<float>(velocity[3 * i + 2]), 0});
        return all;
    }
};

inline law::Norton norton() {
    return {.seed_diameter = diameter,
            .min_rate = 0.1 * rate,
            .flow_rate = rate,
            .materials = {{3e7, 0.3, 2e6}, {9e7, 0.5, 4e6}}};
}

inline Vector3d vector(Four four) {
    return {four[0], four[1], four[2]};
}

/// A wall below and another above, near to what is there.
inline std::vector<NearWall> walls_at(const Cloud& cloud) {
    std::vector<NearWall> walls;
    for (int i = 0; i < cloud.count(); ++i)
        for (const double side : {1.0, -1.0})
            if (const double distance = side > 0 ? cloud.at(i)[2] + 0.3 : 3.3 - cloud.at(i)[2];
                distance < 1.25 * diameter)
                walls.push_back({i, side > 0 ? 0 : 1, {0, 0, side}, distance, 0.3 * rate});
    return walls;
}

}  // namespace tomodem::plugin
