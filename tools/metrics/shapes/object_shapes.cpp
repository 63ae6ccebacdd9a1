#include "tools/metrics/shapes/object_shapes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/scene/scene.hpp"

namespace tomodem::shapes {

namespace {

bool at_boundary(const Packing& packing, const Object& object, const Vec3& low, const Vec3& high) {
    const double diameter = 2.0 * packing.seed_radius;
    for (const std::size_t i : object.members) {
        const Vec3& p = packing.position[i];
        if ((p - low).minCoeff() < diameter || (high - p).minCoeff() < diameter) return true;
    }
    return false;
}

/// All centres in one plane, which may lie askew.
bool flat(const Packing& packing, const Object& object) {
    const Ellipsoid ellipsoid = ellipsoid_of(second_moments(packing.position, object.members));
    return ellipsoid.semi_axis[2] <= 1e-6 * ellipsoid.semi_axis[0];
}

}  // namespace

ChosenObjects choose_objects(const Packing& packing, const ObjectChoice& choice) {
    std::map<std::int32_t, Object> objects;
    for (std::size_t i = 0; i < packing.object.size(); ++i) {
        const std::int32_t number = packing.object[i];
        if (number <= 0) continue;
        Object& object = objects.try_emplace(number, Object{number, packing.species[i], {}}).first->second;
        object.members.push_back(i);
    }
    if (objects.empty())
        throw InvalidInput("the sample has no objects; set 'objects = true' for their phase in the scene");

    Vec3 low = packing.box.origin, high = packing.box.origin + packing.box.edges;
    Vec3 min = packing.position.front(), max = min;
    for (const Vec3& p : packing.position) {
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
    }
    low = low.cwiseMax(min);
    high = high.cwiseMin(max);

    ChosenObjects result;
    std::size_t largest = 0;
    for (auto& [number, object] : objects) {
        largest = std::max(largest, object.members.size());
        if (object.members.size() < choice.min_particles || flat(packing, object)) {
            ++result.too_small;
            continue;
        }
        object.at_boundary = at_boundary(packing, object, low, high);
        if (choice.exclude_boundary && object.at_boundary)
            ++result.at_boundary;
        else
            result.used.push_back(std::move(object));
    }
    if (result.used.empty())
        throw InvalidInput(
            fmt::format("none of the {} objects can be measured: {} are too small or flat (the largest has {} "
                        "particles, --min-particles is {}), {} touch the boundary",
                        objects.size(), result.too_small, largest, choice.min_particles, result.at_boundary));
    return result;
}

int load_axis(const RunReader& run, const std::filesystem::path& file) {
    const std::string& scene = run.provenance().scene;
    return scene.empty() ? 2 : parse_stored_scene(scene, file.string()).axis;
}

Spread plain_spread(std::span<const double> values) {
    Spread spread;
    for (const double value : values) spread.mean += value / double(values.size());
    if (values.size() < 2) return spread;
    double squares = 0.0;
    for (const double value : values) squares += (value - spread.mean) * (value - spread.mean);
    spread.deviation = std::sqrt(squares / double(values.size() - 1));
    return spread;
}

Spread weighted_spread(std::span<const double> values, std::span<const double> weights) {
    Spread spread;
    double total = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        total += weights[i];
        spread.mean += weights[i] * values[i];
    }
    spread.mean /= total;
    if (values.size() < 2) return spread;
    for (std::size_t i = 0; i < values.size(); ++i)
        squares += weights[i] * (values[i] - spread.mean) * (values[i] - spread.mean);
    spread.deviation = std::sqrt(squares / total);
    return spread;
}

}  // namespace tomodem::shapes
