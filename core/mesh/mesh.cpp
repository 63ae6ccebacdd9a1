#include "core/mesh/mesh.hpp"

#include <Eigen/Geometry>

namespace tomodem {

double TriangleMesh::volume() const {
    if (vertices.empty()) return 0.0;
    const Vec3 apex = vertices.front();  // a point of the surface: a mesh far from the origin loses no digits
    double sum = 0.0;
    for (const auto& [a, b, c] : triangles)
        sum += (vertices[a] - apex).dot((vertices[b] - apex).cross(vertices[c] - apex));
    return sum / 6.0;
}

double TriangleMesh::area() const {
    double sum = 0.0;
    for (const auto& [a, b, c] : triangles) sum += (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).norm();
    return sum / 2.0;
}

}  // namespace tomodem
