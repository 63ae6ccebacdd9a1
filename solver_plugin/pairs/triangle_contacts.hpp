#pragma once
#include <array>
#include <vector>

#include "core/mesh/mesh.hpp"

/// Contacts of a sphere with a triangulated surface: pure geometry.
namespace tomodem {

using Triangle = std::array<Vec3, 3>;

/// Point of the triangle (inside, on an edge, or a corner) that is nearest to `point`.
Vec3 closest_point(const Triangle& triangle, const Vec3& point);

/// A local minimum of the distance from a centre to the surface.
struct SurfaceContact {
    Vec3 direction;  ///< unit vector from the surface to the centre
    double distance;
};

/// Triangles in a tree of boxes, for meshes of any size and any grading. Both sides of the surface count.
///
/// Triangles without area are left out: what they cover belongs to the edges of others.
class TriangleTree {
 public:
    /// @throws InvalidInput if no triangle has an area
    explicit TriangleTree(const TriangleMesh& mesh);

    /// Triangles nearer than `reach` to `centre`, appended to `found`.
    void near(const Vec3& centre, double reach, std::vector<int>& found) const;

    /// Every local minimum of the distance below `reach`, in `contacts` (what it held is lost).
    ///
    /// Two faces of a concave corner are two contacts; a convex edge or corner is one, and so is a point that several
    /// coplanar triangles share. Whether triangles meet is seen from their places alone: vertices need not be merged.
    ///
    /// @param candidates  triangles that hold at least those nearer than `reach`
    void contacts(const std::vector<int>& candidates, const Vec3& centre, double reach,
                  std::vector<SurfaceContact>& contacts) const;

    std::size_t size() const { return triangles_.size(); }

 private:
    struct Node {
        Vec3 low, high;
        int first, count;  ///< of order_; a leaf when `right` is 0
        int right;         ///< the left child follows its parent
    };
    struct Foot {
        int triangle;
        Vec3 point;
        double distance;
    };
    int build(int first, int count);
    /// @param feet  by increasing distance
    bool is_minimum(const Foot& foot, const std::vector<Foot>& feet, const Vec3& centre) const;

    std::vector<Triangle> triangles_;
    std::vector<int> order_;
    std::vector<Node> nodes_;
    double touch_ = 0;  ///< points nearer than this are the same: STL files hold single precision
    mutable std::vector<Foot> feet_;
};

}  // namespace tomodem
