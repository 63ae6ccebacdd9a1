#include "tools/metrics/shapes/ellipsoid.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace tomodem::shapes {

Vec3 mean_of(std::span<const Vec3> centres, std::span<const std::size_t> members) {
    Vec3 mean = Vec3::Zero();
    for (const std::size_t i : members) mean += centres[i] / double(members.size());
    return mean;
}

Mat3 second_moments(std::span<const Vec3> centres, std::span<const std::size_t> members) {
    const Vec3 mean = mean_of(centres, members);
    const double count = double(members.size());
    Mat3 moments = Mat3::Zero();
    for (const std::size_t i : members) moments += (centres[i] - mean) * (centres[i] - mean).transpose() / count;
    return moments;
}

double shape_factor(const Mat3& second_moments, int axis) {
    const Vec3 root = second_moments.diagonal().cwiseSqrt();
    return root[axis] / (0.5 * (root[(axis + 1) % 3] + root[(axis + 2) % 3]));
}

Ellipsoid ellipsoid_of(const Mat3& second_moments) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(second_moments);
    Ellipsoid ellipsoid;
    for (int k = 0; k < 3; ++k) {
        ellipsoid.semi_axis[k] = std::sqrt(std::max(0.0, 5.0 * solver.eigenvalues()[2 - k]));
        Vec3 direction = solver.eigenvectors().col(2 - k).normalized();
        int largest = 0;
        direction.cwiseAbs().maxCoeff(&largest);
        ellipsoid.direction[k] = direction[largest] < 0.0 ? Vec3(-direction) : direction;
    }
    return ellipsoid;
}

double own_shape_factor(const Ellipsoid& ellipsoid, int axis) {
    int nearest = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(ellipsoid.direction[k][axis]) > std::abs(ellipsoid.direction[nearest][axis])) nearest = k;
    return ellipsoid.semi_axis[nearest] /
           (0.5 * (ellipsoid.semi_axis[(nearest + 1) % 3] + ellipsoid.semi_axis[(nearest + 2) % 3]));
}

void follow(Ellipsoid& ellipsoid, const Ellipsoid& before) {
    std::array<int, 3> order{0, 1, 2}, best = order;
    double best_sum = -1.0;
    do {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) sum += std::abs(ellipsoid.direction[k].dot(before.direction[order[k]]));
        if (sum > best_sum + 1e-12) {
            best_sum = sum;
            best = order;
        }
    } while (std::next_permutation(order.begin(), order.end()));
    for (int k = 0; k < 3; ++k) {
        ellipsoid.follows[k] = before.follows[best[k]];
        if (ellipsoid.direction[k].dot(before.direction[best[k]]) < 0.0) ellipsoid.direction[k] *= -1.0;
    }
}

double axis_angle(const Vec3& direction, const Vec3& other) {
    return std::atan2(direction.cross(other).norm(), std::abs(direction.dot(other))) * 180.0 / std::numbers::pi;
}

Shape shape_of(const Vec3& centre, double volume, const Mat3& second_moments, int axis) {
    const Ellipsoid ellipsoid = ellipsoid_of(second_moments);
    return {centre, volume, ellipsoid, shape_factor(second_moments, axis), own_shape_factor(ellipsoid, axis)};
}

namespace {

constexpr std::array axis_name{"a", "b", "c"};
constexpr std::array coordinate{"x", "y", "z"};

/// Calls visit(name, unit, value) for each number of a shape.
template <class Visit>
void for_each_number(const Shape& shape, const Visit& visit) {
    for (int i = 0; i < 3; ++i) visit(fmt::format("centre_{}", coordinate[i]), "mm", shape.centre[i]);
    visit("volume", "mm^3", shape.volume);
    for (int k = 0; k < 3; ++k) visit(fmt::format("semi_axis_{}", axis_name[k]), "mm", shape.ellipsoid.semi_axis[k]);
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
            visit(fmt::format("direction_{}_{}", axis_name[k], coordinate[i]), "-", shape.ellipsoid.direction[k][i]);
    visit("shape_factor", "-", shape.shape_factor);
    visit("own_shape_factor", "-", shape.own_shape_factor);
}

}  // namespace

std::vector<std::string> shape_columns() {
    std::vector<std::string> columns;
    for_each_number({}, [&](const std::string& name, const char* unit, double) {
        columns.push_back(fmt::format("{} [{}]", name, unit));
    });
    return columns;
}

void append_cells(const Shape& shape, std::vector<Table::Cell>& row) {
    for_each_number(shape, [&](const std::string&, const char*, double value) { row.emplace_back(value); });
}

void append_json(const Shape& shape, nlohmann::ordered_json& object) {
    for_each_number(shape, [&](const std::string& name, const char*, double value) { object[name] = value; });
}

}  // namespace tomodem::shapes
