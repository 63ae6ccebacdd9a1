#include "solver_plugin/pairs/triangle_contacts.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace tomodem {
namespace {

constexpr double tight = 1e-13;

/// n x n squares of two triangles over [0, edge]^2 in the plane spanned by u and v.
TriangleMesh plate(int n, double edge, const Vec3& u = Vec3::UnitX(), const Vec3& v = Vec3::UnitY()) {
    TriangleMesh mesh;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) mesh.vertices.push_back(edge / n * (i * u + j * v));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j, b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
    const auto offset = static_cast<std::int32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const auto& [p, q, r] : b.triangles) a.triangles.push_back({p + offset, q + offset, r + offset});
    return a;
}

std::vector<SurfaceContact> contacts_of(const TriangleMesh& mesh, const Vec3& centre, double reach) {
    const TriangleTree tree(mesh);
    std::vector<int> near;
    tree.near(centre, reach, near);
    std::vector<SurfaceContact> contacts;
    tree.contacts(near, centre, reach, contacts);
    return contacts;
}

TEST(ClosestPoint, IsNeverFartherThanAnyOtherPointOfTheTriangle) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(-1, 1), share(0, 1);
    const auto point = [&] { return Vec3(place(random), place(random), place(random)); };
    for (int trial = 0; trial < 300; ++trial) {
        const Triangle triangle{point(), point(), point()};
        const Vec3 centre = 2 * point(), nearest = closest_point(triangle, centre);
        for (int k = 0; k < 100; ++k) {
            double s = share(random), t = share(random);
            if (s + t > 1) s = 1 - s, t = 1 - t;
            const Vec3 other = triangle[0] + s * (triangle[1] - triangle[0]) + t * (triangle[2] - triangle[0]);
            EXPECT_LE((nearest - centre).norm(), (other - centre).norm() + tight);
        }
    }
}

TEST(TriangleTree, FindsWhatAnExhaustiveSearchFinds) {
    std::mt19937_64 random(9);
    std::normal_distribution<double> place(0, 3), size(0, 0.5);
    TriangleMesh mesh;
    for (int k = 0; k < 500; ++k) {
        const Vec3 middle(place(random), place(random), place(random));
        for (int corner = 0; corner < 3; ++corner)
            mesh.vertices.push_back(middle + Vec3(size(random), size(random), size(random)));
        mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    const TriangleTree tree(mesh);
    ASSERT_EQ(tree.size(), 500u);
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 centre(place(random), place(random), place(random));
        std::vector<int> found, expected;
        tree.near(centre, 1.0, found);
        for (int k = 0; k < 500; ++k) {
            const Triangle triangle{mesh.vertices[3 * k], mesh.vertices[3 * k + 1], mesh.vertices[3 * k + 2]};
            if ((closest_point(triangle, centre) - centre).norm() < 1.0) expected.push_back(k);
        }
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
    }
}

TEST(SurfaceContacts, OfAPlaneOfManyTrianglesAreOneAnywhere) {
    const TriangleMesh mesh = plate(10, 10);
    // Over a face, an edge between squares, a diagonal, a vertex; and a hair beside each.
    for (const Vec3& foot :
         {Vec3(4.7, 4.2, 0), Vec3(5, 4.3, 0), Vec3(4.5, 4.5, 0), Vec3(5, 5, 0), Vec3(5, 5 - 1e-15, 0),
          Vec3(5 + 1e-13, 4.3, 0), Vec3(4.5, 4.5 + 1e-11, 0), Vec3(5 + 1e-9, 5 - 1e-8, 0)})
        for (double height : {0.3, -0.3, 0.7}) {
            const auto contacts = contacts_of(mesh, foot + Vec3(0, 0, height), 0.75);
            ASSERT_EQ(contacts.size(), 1u) << foot.transpose();
            EXPECT_NEAR(contacts[0].distance, std::abs(height), tight);
            EXPECT_NEAR(contacts[0].direction.z(), std::copysign(1, height), tight);
        }
}

TEST(SurfaceContacts, AreTheSameForAPlaneInSinglePrecisionTiltedAtRandom) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> share(0.2, 0.8);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    TriangleMesh mesh = plate(12, 10);
    for (Vec3& vertex : mesh.vertices) vertex = (turn * vertex).cast<float>().cast<double>();
    const TriangleTree tree(mesh);
    std::vector<SurfaceContact> contacts;
    for (int trial = 0; trial < 2000; ++trial) {
        Vec3 foot(10 * share(random), 10 * share(random), 0);
        if (trial % 2) foot.x() = std::round(1.2 * foot.x()) / 1.2;  // over the edges too
        if (trial % 4 == 3) foot.y() = std::round(1.2 * foot.y()) / 1.2;
        std::vector<int> near;
        const Vec3 centre = turn * (foot + Vec3(0, 0, 0.5));
        tree.near(centre, 0.75, near);
        tree.contacts(near, centre, 0.75, contacts);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_NEAR(contacts[0].distance, 0.5, 1e-5);
    }
}

TEST(SurfaceContacts, OfAConcaveCornerAreItsTwoFaces) {
    const TriangleMesh corner = joined(plate(5, 10), plate(5, 10, Vec3::UnitY(), Vec3::UnitZ()));  // z = 0 and x = 0
    const auto contacts = contacts_of(corner, Vec3(0.4, 5.1, 0.6), 0.75);
    ASSERT_EQ(contacts.size(), 2u);
    EXPECT_NEAR(contacts[0].distance, 0.4, tight);
    EXPECT_NEAR(contacts[0].direction.x(), 1, tight);
    EXPECT_NEAR(contacts[1].distance, 0.6, tight);
    EXPECT_NEAR(contacts[1].direction.z(), 1, tight);
}

TEST(SurfaceContacts, OfAConvexEdgeAreOneAtTheEdge) {
    const TriangleMesh corner = joined(plate(5, 10), plate(5, 10, Vec3::UnitY(), Vec3::UnitZ()));
    const Vec3 centre(-0.3, 5.1, -0.4);
    const auto contacts = contacts_of(corner, centre, 0.75);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts[0].distance, 0.5, tight);
    EXPECT_NEAR((contacts[0].direction - Vec3(-0.6, 0, -0.8)).norm(), 0, tight);
}

TEST(SurfaceContacts, OfABoxsCornerAreOneOutsideAndThreeInside) {
    TriangleMesh corner = joined(plate(4, 10), plate(4, 10, Vec3::UnitY(), Vec3::UnitZ()));
    corner = joined(corner, plate(4, 10, Vec3::UnitZ(), Vec3::UnitX()));
    const auto outside = contacts_of(corner, Vec3(-0.2, -0.3, -0.6), 0.75);
    ASSERT_EQ(outside.size(), 1u);
    EXPECT_NEAR(outside[0].distance, 0.7, tight);
    const auto inside = contacts_of(corner, Vec3(0.2, 0.3, 0.6), 0.75);
    ASSERT_EQ(inside.size(), 3u);
    EXPECT_NEAR(inside[0].distance + inside[1].distance + inside[2].distance, 1.1, tight);
}

TEST(SurfaceContacts, DoNotNeedMatchingTriangles) {
    // A coarse square beside fine ones: vertices of the fine lie on the edge of the coarse.
    TriangleMesh coarse = plate(1, 10);
    for (Vec3& vertex : coarse.vertices) vertex.x() -= 10;
    const TriangleMesh mesh = joined(plate(10, 10), coarse);
    for (double x : {-0.2, -1e-12, 0.0, 1e-12, 0.2})
        for (double y : {4.0, 4.5}) {
            const auto contacts = contacts_of(mesh, Vec3(x, y, 0.4), 0.75);
            ASSERT_EQ(contacts.size(), 1u) << x << ' ' << y;
            EXPECT_NEAR(contacts[0].distance, 0.4, tight);
        }
}

TEST(SurfaceContacts, OfATriangulatedBallAreOneWithinTheFacetsError) {
    // Rings of latitude; the vertices lie on the sphere, a facet at most sagitta inside.
    const double radius = 5;
    const int rings = 60, sectors = 120;
    TriangleMesh ball;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * j / sectors;
            ball.vertices.push_back(
                radius * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
        }
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            const int a = i * sectors + j, b = i * sectors + (j + 1) % sectors;
            ball.triangles.push_back({a, a + sectors, b + sectors});
            ball.triangles.push_back({a, b + sectors, b});
        }
    const double facet = std::numbers::pi * radius / rings, sagitta = 2 * facet * facet / (8 * radius);
    const TriangleTree tree(ball);
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<SurfaceContact> contacts;
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
        std::vector<int> near;
        tree.near((radius + 0.5) * direction, 0.75, near);
        tree.contacts(near, (radius + 0.5) * direction, 0.75, contacts);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_GT(contacts[0].distance, 0.5 - 1e-12);
        EXPECT_LT(contacts[0].distance, 0.5 + sagitta);
    }
}

TEST(SurfaceContacts, OfACentreOnTheSurfaceLeaveAlongTheNormal) {
    const auto contacts = contacts_of(plate(4, 10), Vec3(4.1, 3.3, 0), 0.75);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].distance, 0);
    EXPECT_NEAR(std::abs(contacts[0].direction.z()), 1, tight);
}

}  // namespace
}  // namespace tomodem
