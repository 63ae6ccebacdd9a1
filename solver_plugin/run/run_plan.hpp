#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/load_path.hpp"
#include "core/scene/scene.hpp"

/// Everything that happens in a run, known beforehand: hence the same however often it is interrupted.
namespace tomodem {

/// A point of the curves, and what is done there.
struct PlannedPoint {
    std::size_t segment;
    std::int64_t from, to;  ///< steps of its segment
    double travelled;       ///< path in strain
    bool frame = false;     ///< written behind it
    bool sampled = false;   ///< stresses are, on the way to it
    bool rest = false;      ///< the solver is set up anew behind it
};

std::vector<PlannedPoint> plan_points(const Scene& scene, const std::vector<LoadSegment>& segments);

/// Where stresses are sampled among the steps to a point: anywhere in each of equal parts, since the particles swing in
/// step with each other, which equal distances would miss.
std::vector<std::int64_t> sample_steps(std::int64_t steps, std::size_t point);

}  // namespace tomodem
