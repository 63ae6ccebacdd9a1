#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <utility>

#include "core/surface/alpha_surface.hpp"

namespace tomodem {

SurfacePart surface_part(const TriangleMesh& mesh, const std::vector<std::int32_t>& number) {
    SurfacePart part;
    std::vector<std::int32_t> renumbered(mesh.vertices.size(), -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (number[t] < 0) continue;
        std::array<std::int32_t, 3> triangle = mesh.triangles[t];
        for (std::int32_t& v : triangle) {
            if (renumbered[v] < 0) {
                renumbered[v] = std::int32_t(part.mesh.vertices.size());
                part.mesh.vertices.push_back(mesh.vertices[v]);
            }
            v = renumbered[v];
        }
        part.mesh.triangles.push_back(triangle);
        part.number.push_back(number[t]);
    }
    return part;
}

SurfacePart body_surface(const AlphaSurface& surface) {
    return {surface.mesh, surface.body_of_triangle};
}

SurfacePart pore_surface(const AlphaSurface& surface) {
    SurfacePart part = surface_part(surface.mesh, surface.pore_of_triangle);
    for (auto& triangle : part.mesh.triangles) std::swap(triangle[1], triangle[2]);
    return part;
}

void correct_envelope(SurfacePart& part, const std::vector<Body>& bodies) {
    std::vector<Vec3>& vertices = part.mesh.vertices;
    std::vector<Vec3> normal(vertices.size(), Vec3::Zero());
    std::vector<std::int32_t> body(vertices.size(), 0);
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = part.mesh.triangles[t];
        const Vec3 across = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
        for (const std::int32_t v : {a, b, c}) normal[v] += across, body[v] = part.number[t];
    }
    for (Vec3& n : normal) n.normalize();
    // The volume is a cubic in the distance moved: det(p + n x) of every triangle.
    std::vector<std::array<double, 4>> cubic(bodies.size(), {0, 0, 0, 0});
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = part.mesh.triangles[t];
        const Vec3 origin = bodies[part.number[t]].centre;
        const Vec3 p = vertices[a] - origin, q = vertices[b] - origin, r = vertices[c] - origin;
        const Vec3 &u = normal[a], &v = normal[b], &w = normal[c];
        std::array<double, 4>& terms = cubic[part.number[t]];
        terms[0] += p.dot(q.cross(r)) / 6.0;
        terms[1] += (u.dot(q.cross(r)) + p.dot(v.cross(r)) + p.dot(q.cross(w))) / 6.0;
        terms[2] += (u.dot(v.cross(r)) + u.dot(q.cross(w)) + p.dot(v.cross(w))) / 6.0;
        terms[3] += u.dot(v.cross(w)) / 6.0;
    }
    std::vector<double> distance(bodies.size(), 0.0);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double wanted = bodies[i].corrected_volume;
        if (std::isnan(wanted)) continue;
        const auto& [k0, k1, k2, k3] = cubic[i];
        double x = 0.0;
        for (int turn = 0; turn < 50; ++turn) {
            const double slope = k1 + x * (2.0 * k2 + 3.0 * k3 * x);
            if (!(slope > 0.0)) break;
            const double step = (wanted - (k0 + x * (k1 + x * (k2 + x * k3)))) / slope;
            x += step;
            if (std::abs(step) < 1e-14 * std::cbrt(bodies[i].volume)) {
                distance[i] = x;
                break;
            }
        }
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] += distance[body[v]] * normal[v];
}

}  // namespace tomodem
