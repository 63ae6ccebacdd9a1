#include "solver_plugin/pairs/triangle_contacts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

constexpr int leaf_size = 4;

/// Share of the largest coordinate: ten times the round-off of single precision.
constexpr double touch_share = 1e-6;

/// A direction is level with a surface within this angle.
constexpr double level = 1e-9;

}  // namespace

// Regions of the triangle's plane one after the other: corners, edges, face (Ericson, Real-Time Collision Detection,
// 2005, section 5.1.5).
Vec3 closest_point(const Triangle& triangle, const Vec3& point) {
    const auto& [a, b, c] = triangle;
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 ap = point - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = point - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const Vec3 cp = point - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    // The foot of the perpendicular: exact along the normal, whatever the shape of the triangle.
    const Vec3 normal = ab.cross(ac).normalized();
    return point - normal.dot(ap) * normal;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
    double largest = 0;
    for (const Vec3& vertex : mesh.vertices) largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
    touch_ = touch_share * largest;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Triangle triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
        const Vec3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0];
        if (ab.cross(ac).norm() > 1e-12 * (ab.squaredNorm() + ac.squaredNorm())) triangles_.push_back(triangle);
    }
    if (triangles_.empty()) throw InvalidInput("the surface has no triangle with an area");
    order_.resize(triangles_.size());
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<int>(order_.size()));
}

int TriangleTree::build(int first, int count) {
    const int index = static_cast<int>(nodes_.size());
    Node node{Vec3::Constant(1e300), Vec3::Constant(-1e300), first, count, 0};
    for (int k = first; k < first + count; ++k)
        for (const Vec3& corner : triangles_[order_[k]]) {
            node.low = node.low.cwiseMin(corner);
            node.high = node.high.cwiseMax(corner);
        }
    nodes_.push_back(node);
    if (count <= leaf_size) return index;
    int axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const auto middle = [&](int k) { return triangles_[k][0][axis] + triangles_[k][1][axis] + triangles_[k][2][axis]; };
    std::nth_element(order_.begin() + first, order_.begin() + first + count / 2, order_.begin() + first + count,
                     [&](int i, int j) { return middle(i) < middle(j); });
    build(first, count / 2);
    nodes_[index].right = build(first + count / 2, count - count / 2);
    return index;
}

void TriangleTree::near(const Vec3& centre, double reach, std::vector<int>& found) const {
    std::array<int, 64> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int index = stack[--depth];
        const Node& node = nodes_[index];
        if ((centre - centre.cwiseMax(node.low).cwiseMin(node.high)).squaredNorm() >= reach * reach) continue;
        if (node.right != 0) {
            stack[depth++] = node.right;
            stack[depth++] = index + 1;
            continue;
        }
        for (int k = node.first; k < node.first + node.count; ++k)
            if ((centre - closest_point(triangles_[order_[k]], centre)).squaredNorm() < reach * reach)
                found.push_back(order_[k]);
    }
}

bool TriangleTree::is_minimum(const Foot& foot, const std::vector<Foot>& feet, const Vec3& centre) const {
    const Vec3 up = centre - foot.point;
    for (const Foot& other : feet) {
        const Triangle& triangle = triangles_[other.triangle];
        if (other.distance >= foot.distance) break;  // the nearest come first
        if ((closest_point(triangle, foot.point) - foot.point).norm() > touch_) continue;
        // This triangle holds the point too: the distance must not fall along it.
        for (const Vec3& corner : triangle) {
            const Vec3 along = corner - foot.point;
            if (up.dot(along) > level * foot.distance * along.norm()) return false;
        }
    }
    return true;
}

void TriangleTree::contacts(const std::vector<int>& candidates, const Vec3& centre, double reach,
                            std::vector<SurfaceContact>& contacts) const {
    contacts.clear();
    feet_.clear();
    for (int k : candidates) {
        const Vec3 point = closest_point(triangles_[k], centre);
        const double squared = (centre - point).squaredNorm();
        if (squared < reach * reach) feet_.push_back({k, point, std::sqrt(squared)});
    }
    // The nearest first, so that of points that are the same the nearest stays; ties in the order of the mesh.
    std::sort(feet_.begin(), feet_.end(), [](const Foot& a, const Foot& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
    });
    std::array<Vec3, 16> feet;
    for (const Foot& foot : feet_) {
        if (contacts.size() == feet.size()) break;
        const bool known = std::any_of(feet.begin(), feet.begin() + contacts.size(),
                                       [&](const Vec3& point) { return (point - foot.point).norm() <= touch_; });
        if (known || !is_minimum(foot, feet_, centre)) continue;
        feet[contacts.size()] = foot.point;
        if (foot.distance > 0) {
            contacts.push_back({(centre - foot.point) / foot.distance, foot.distance});
        } else {
            // A centre on the surface has no side: it leaves along the normal.
            const auto& [a, b, c] = triangles_[foot.triangle];
            contacts.push_back({(b - a).cross(c - a).normalized(), 0});
        }
    }
}

}  // namespace tomodem
