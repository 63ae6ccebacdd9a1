#include "core/surface/alpha_surface.hpp"

#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<Vec3> regular_tetrahedron(double edge) {
    const double s = edge / std::sqrt(8.0);
    return {s * Vec3(1, 1, 1), s * Vec3(1, -1, -1), s * Vec3(-1, 1, -1), s * Vec3(-1, -1, 1)};
}

std::vector<Vec3> cubic_lattice(int cells, const Vec3& origin = Vec3::Zero()) {
    std::vector<Vec3> points;
    for (int k = 0; k <= cells; ++k)
        for (int j = 0; j <= cells; ++j)
            for (int i = 0; i <= cells; ++i) points.push_back(origin + Vec3(i, j, k));
    return points;
}

std::vector<Vec3> uniform_points(int count, double edge, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> coordinate(0.0, edge);
    std::vector<Vec3> points(count);
    for (Vec3& point : points)
        for (int axis = 0; axis < 3; ++axis) point[axis] = coordinate(generator);
    return points;
}

/// Every directed edge occurs once, and so does its reverse: closed, oriented, two triangles at each edge.
bool is_closed_manifold(const TriangleMesh& mesh) {
    std::set<std::pair<int, int>> edges;
    for (const auto& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            if (!edges.emplace(t[k], t[(k + 1) % 3]).second) return false;
    for (const auto& [from, to] : edges)
        if (!edges.contains({to, from})) return false;
    return true;
}

int euler_characteristic(const TriangleMesh& mesh) {
    return int(mesh.vertices.size()) - int(mesh.triangles.size()) / 2;
}

std::size_t merged_vertices(const TriangleMesh& mesh) {
    std::set<std::array<double, 3>> places;
    for (const Vec3& v : mesh.vertices) places.insert({v.x(), v.y(), v.z()});
    return places.size();
}

struct Oracle {
    double volume = 0.0, area = 0.0;
    std::size_t components = 0;
};

/// CGAL's alpha shape with exact comparison of alphas; the square of the probe radius must be a double.
Oracle alpha_shape_3(const std::vector<Vec3>& centres, double probe_radius) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Vertex = CGAL::Alpha_shape_vertex_base_3<Kernel, CGAL::Default, CGAL::Tag_true>;
    using Cell = CGAL::Alpha_shape_cell_base_3<Kernel, CGAL::Default, CGAL::Tag_true>;
    using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell>>;
    using Shape = CGAL::Alpha_shape_3<Delaunay, CGAL::Tag_true>;
    std::vector<Kernel::Point_3> points;
    for (const Vec3& c : centres) points.emplace_back(c.x(), c.y(), c.z());
    Shape shape(points.begin(), points.end(), Shape::FT(probe_radius * probe_radius), Shape::GENERAL);
    Oracle oracle;
    for (auto cell : shape.finite_cell_handles())
        if (shape.classify(cell) == Shape::INTERIOR) oracle.volume += shape.tetrahedron(cell).volume();
    for (const auto& facet : shape.finite_facets())
        if (shape.classify(facet) == Shape::REGULAR) oracle.area += std::sqrt(shape.triangle(facet).squared_area());
    oracle.components = shape.number_of_solid_components();
    return oracle;
}

TEST(AlphaSurface, OfARegularTetrahedronHasItsVolumeAndArea) {
    const AlphaSurface surface = alpha_surface(regular_tetrahedron(2.0), {.probe_radius = 1.23});
    EXPECT_NEAR(surface.volume, 8.0 / (6.0 * std::numbers::sqrt2), 1e-14);
    EXPECT_NEAR(surface.area, 4.0 * std::numbers::sqrt3, 1e-14);
    EXPECT_EQ(surface.components.size(), 1u);
    EXPECT_EQ(surface.mesh.triangles.size(), 4u);
    EXPECT_NEAR(surface.mesh.volume(), surface.volume, 1e-14);
}

TEST(AlphaSurface, FillsATetrahedronFromItsCircumradiusOn) {
    const double circumradius = 2.0 * std::sqrt(6.0) / 4.0;
    EXPECT_NO_THROW(alpha_surface(regular_tetrahedron(2.0), {.probe_radius = 1.000001 * circumradius}));
    EXPECT_THAT([&] { alpha_surface(regular_tetrahedron(2.0), {.probe_radius = 0.999999 * circumradius}); },
                ThrowsMessage<InvalidInput>(HasSubstr("give a larger probe radius")));
}

TEST(AlphaSurface, OfACubicLatticeIsItsCubeThoughAllItsCellsAreDegenerate) {
    const AlphaSurface surface = alpha_surface(cubic_lattice(8), {.probe_radius = 1.0});
    EXPECT_NEAR(surface.volume, 512.0, 1e-10);
    EXPECT_NEAR(surface.area, 384.0, 1e-10);
    EXPECT_EQ(surface.components.size(), 1u);
    EXPECT_TRUE(is_closed_manifold(surface.mesh));
    EXPECT_EQ(euler_characteristic(surface.mesh), 2);
}

TEST(AlphaSurface, OfATurnedLatticeHasNoSliverVoids) {
    // Rounding leaves tetrahedra of volume 1e-16 between the cubes, whose circumradius floating point gets wrong.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Vec3> points = cubic_lattice(12);
    for (Vec3& p : points) p = turn * p;
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = 1.0});
    EXPECT_NEAR(surface.volume, 1728.0, 1e-8);
    EXPECT_NEAR(surface.area, 864.0, 1e-6);
    EXPECT_TRUE(is_closed_manifold(surface.mesh));
}

TEST(AlphaSurface, TakesTheVolumeOfAVoidThatTheProbeEnters) {
    std::vector<Vec3> points = cubic_lattice(10);
    std::erase_if(points, [](const Vec3& p) { return (p - Vec3(5, 5, 5)).cwiseAbs().maxCoeff() < 2.5; });
    // A cubic void of edge 6 whose edges and corners the probe does not reach: half a cell, 5/6 of a cell.
    const double chamfer = 12 * 4 * (1.0 / 2.0) + 8 * (5.0 / 6.0);
    const AlphaSurface with_void = alpha_surface(points, {.probe_radius = 1.0});
    EXPECT_NEAR(with_void.volume, 1000.0 - 216.0 + chamfer, 1e-9);
    EXPECT_TRUE(is_closed_manifold(with_void.mesh));
    EXPECT_EQ(euler_characteristic(with_void.mesh), 4) << "outer and inner surface";
    EXPECT_NEAR(alpha_surface(points, {.probe_radius = 6.0}).volume, 1000.0, 1e-9);
}

TEST(AlphaSurface, TellsSeparatePartsLargestFirst) {
    std::vector<Vec3> points = cubic_lattice(2, {20, 0, 0});
    const std::vector<Vec3> large = cubic_lattice(4);
    points.insert(points.end(), large.begin(), large.end());
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = 1.0});
    ASSERT_EQ(surface.components.size(), 2u);
    EXPECT_NEAR(surface.components[0], 64.0, 1e-10);
    EXPECT_NEAR(surface.components[1], 8.0, 1e-10);
}

TEST(AlphaSurface, KeepsTwoTetrahedraThatShareAnEdgeApart) {
    const double c = 0.5, s = std::sqrt(0.5);  // apexes at 35.26 degrees from the y-axis, sqrt(3)/2 from the edge
    const std::vector<Vec3> points{{0, 0, 0.5}, {0, 0, -0.5}, {c, s, 0}, {-c, s, 0}, {c, -s, 0}, {-c, -s, 0}};
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = 0.65});
    EXPECT_EQ(surface.components.size(), 2u);
    EXPECT_EQ(surface.mesh.vertices.size(), 8u) << "the ends of the shared edge are doubled";
    EXPECT_TRUE(is_closed_manifold(surface.mesh));
    EXPECT_NEAR(surface.mesh.volume(), 2.0 / (6.0 * std::numbers::sqrt2), 1e-14);
}

TEST(AlphaSurface, IsAClosedManifoldWhereTheSolidTouchesItself) {
    bool midpoints_needed = false;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const std::vector<Vec3> points = uniform_points(3000, 10.0, seed);
        const AlphaSurface surface = alpha_surface(points, {.probe_radius = 0.6});
        EXPECT_TRUE(is_closed_manifold(surface.mesh)) << "seed " << seed;
        EXPECT_LT(merged_vertices(surface.mesh), surface.mesh.vertices.size()) << "the case is there";
        EXPECT_NEAR(surface.mesh.volume(), surface.volume, 1e-9 * surface.volume);
        const std::set<double> given = [&] {
            std::set<double> x;
            for (const Vec3& p : points) x.insert(p.x());
            return x;
        }();
        for (const Vec3& v : surface.mesh.vertices) midpoints_needed |= !given.contains(v.x());
    }
    EXPECT_TRUE(midpoints_needed) << "the case is there";
}

TEST(AlphaSurface, HasTheVolumeOfItsMeshFarFromTheOrigin) {
    std::vector<Vec3> points = uniform_points(5000, 10.0, 3);
    for (Vec3& p : points) p += Vec3(1e4, -2e4, 3e4);
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = 1.0});
    EXPECT_NEAR(surface.mesh.volume(), surface.volume, 1e-9 * surface.volume);
}

TEST(AlphaSurface, EqualsAlphaShape3) {
    for (const double probe_radius : {0.5, 0.625, 0.8125, 1.5, 64.0}) {
        const std::vector<Vec3> points = uniform_points(2000, 10.0, 7);
        const AlphaSurface surface = alpha_surface(points, {.probe_radius = probe_radius});
        const Oracle oracle = alpha_shape_3(points, probe_radius);
        EXPECT_NEAR(surface.volume, oracle.volume, 1e-12 * oracle.volume);
        EXPECT_NEAR(surface.area, oracle.area, 1e-12 * oracle.area);
        EXPECT_EQ(surface.components.size(), oracle.components);
    }
}

TEST(AlphaSurface, EqualsAlphaShape3AtTheCircumradiusItself) {
    // Tetrahedra of a lattice of doubled integers: many circumradii are exactly the probe radius 3 = |(1, 2, 2)|.
    std::mt19937 generator(11);
    std::uniform_int_distribution<int> coordinate(0, 14);
    std::vector<Vec3> points(400);
    for (Vec3& p : points) p = 2.0 * Vec3(coordinate(generator), coordinate(generator), coordinate(generator));
    for (const double probe_radius : {2.5, 3.0, 3.5, 4.5}) {
        const AlphaSurface surface = alpha_surface(points, {.probe_radius = probe_radius});
        const Oracle oracle = alpha_shape_3(points, probe_radius);
        EXPECT_NEAR(surface.volume, oracle.volume, 1e-12 * oracle.volume);
        EXPECT_NEAR(surface.area, oracle.area, 1e-12 * oracle.area);
        EXPECT_EQ(surface.components.size(), oracle.components);
    }
}

TEST(AlphaSurface, DecidesAtTheCircumradiusItselfInAnyScale) {
    std::mt19937 generator(11);
    std::uniform_int_distribution<int> coordinate(0, 14);
    std::vector<Vec3> points(400);
    for (Vec3& p : points) p = 2.0 * Vec3(coordinate(generator), coordinate(generator), coordinate(generator));
    const AlphaSurface surface = alpha_surface(points, {.probe_radius = 3.0});
    const double scale = 1.0 + 5.0 / 1073741824.0;  // times a small integer it is exact, its square is not
    for (Vec3& p : points) p *= scale;
    const AlphaSurface scaled = alpha_surface(points, {.probe_radius = 3.0 * scale});
    EXPECT_NEAR(scaled.volume, surface.volume * scale * scale * scale, 1e-10 * surface.volume);
    EXPECT_NEAR(scaled.area, surface.area * scale * scale, 1e-10 * surface.area);
    EXPECT_EQ(scaled.mesh.triangles.size(), surface.mesh.triangles.size());
}

AlphaSurface shape_of(const std::vector<Vec3>& points) {
    return alpha_surface(points, {.probe_radius = 1.0, .progress = {}, .seed_radius = 0.5});
}

double largest_norm(const Vec3& v) {
    return v.cwiseAbs().maxCoeff();
}

TEST(Bodies, ABlockHasOneShellAndNoHandle) {
    const AlphaSurface surface = shape_of(cubic_lattice(8));
    ASSERT_EQ(surface.bodies.size(), 1u);
    EXPECT_EQ(surface.bodies[0].shells, 1);
    EXPECT_EQ(surface.bodies[0].genus, 0);
    EXPECT_EQ(surface.bodies[0].euler_characteristic(), 2);
    EXPECT_EQ(surface.bodies[0].particles, 729);
    EXPECT_NEAR((surface.bodies[0].centre - Vec3(4, 4, 4)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(surface.bodies[0].area, surface.area, 1e-9);
    EXPECT_TRUE(surface.pores.empty());
}

TEST(Bodies, ABlockWithTwoHolesThroughItHasTwoHandles) {
    std::vector<Vec3> points = cubic_lattice(20);
    std::erase_if(points, [](const Vec3& p) {
        return p.z() > 6.5 || largest_norm(Vec3(p.x() - 5, p.y() - 10, 0)) < 2.5 ||
               largest_norm(Vec3(p.x() - 14, p.y() - 10, 0)) < 2.5;
    });
    const AlphaSurface surface = shape_of(points);
    ASSERT_EQ(surface.bodies.size(), 1u);
    EXPECT_EQ(surface.bodies[0].genus, 2);
    EXPECT_EQ(surface.bodies[0].euler_characteristic(), -2);
    EXPECT_EQ(euler_characteristic(surface.mesh), -2);
    EXPECT_TRUE(surface.pores.empty());
}

TEST(Bodies, AVoidIsAPoreAndAShellMore) {
    std::vector<Vec3> points = cubic_lattice(10);
    std::erase_if(points, [](const Vec3& p) { return largest_norm(p - Vec3(5, 5, 5)) < 2.5; });
    const AlphaSurface surface = shape_of(points);
    ASSERT_EQ(surface.pores.size(), 1u);
    EXPECT_EQ(surface.bodies[0].shells, 2);
    EXPECT_EQ(surface.bodies[0].euler_characteristic(), 4);
    EXPECT_NEAR(surface.pores[0].volume, 1000.0 - surface.volume, 1e-9);
    EXPECT_NEAR((surface.pores[0].centre - Vec3(5, 5, 5)).norm(), 0.0, 1e-9);
    const SurfacePart pore = pore_surface(surface);
    EXPECT_TRUE(is_closed_manifold(pore.mesh));
    EXPECT_NEAR(pore.mesh.volume(), surface.pores[0].volume, 1e-9);
    EXPECT_LT(surface.pores[0].corrected_volume, surface.pores[0].volume);
}

TEST(Bodies, APartWithinAPoreIsItsIsland) {
    std::vector<Vec3> points = cubic_lattice(16);
    std::erase_if(points, [](const Vec3& p) {
        const double r = largest_norm(p - Vec3(8, 8, 8));
        return r > 1.5 && r < 5.5;
    });
    const AlphaSurface surface = shape_of(points);
    ASSERT_EQ(surface.bodies.size(), 2u);
    ASSERT_EQ(surface.pores.size(), 1u);
    EXPECT_EQ(surface.pores[0].shells, 2);
    EXPECT_NEAR(surface.bodies[1].volume, 8.0, 1e-9);
    EXPECT_EQ(surface.bodies[1].particles, 27);
    EXPECT_NEAR(pore_surface(surface).mesh.volume(), surface.pores[0].volume, 1e-9);
}

TEST(Bodies, AVoidWithAWayOutIsNoPoreButAHandleWithTwo) {
    const auto tunnel = [](bool through) {
        std::vector<Vec3> points = cubic_lattice(14);
        std::erase_if(points, [&](const Vec3& p) {
            const bool within = largest_norm(p - Vec3(7, 7, 7)) < 2.5;
            const bool way = largest_norm(Vec3(p.x() - 7, p.y() - 7, 0)) < 1.5 && (through || p.z() > 7);
            return within || way;
        });
        return shape_of(points);
    };
    for (const bool through : {false, true}) {
        const AlphaSurface surface = tunnel(through);
        EXPECT_TRUE(surface.pores.empty());
        ASSERT_EQ(surface.bodies.size(), 1u);
        EXPECT_EQ(surface.bodies[0].shells, 1);
        EXPECT_EQ(surface.bodies[0].genus, through ? 1 : 0);
    }
}

TEST(Bodies, EveryShellIsTheOutsideOfABodyOrOfAPore) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const AlphaSurface surface = alpha_surface(uniform_points(3000, 10.0, seed), {.probe_radius = 0.8});
        std::int64_t shells = 0;
        double area = 0.0, pores = 0.0;
        for (const Body& body : surface.bodies) {
            shells += body.shells;
            area += body.area;
            EXPECT_GE(body.genus, 0);
        }
        for (const Body& pore : surface.pores) pores += pore.volume;
        EXPECT_GT(surface.pores.size(), 0u);
        EXPECT_EQ(shells, std::int64_t(surface.bodies.size() + surface.pores.size())) << "seed " << seed;
        EXPECT_NEAR(area, surface.area, 1e-9 * area);
        const SurfacePart part = pore_surface(surface);
        EXPECT_TRUE(is_closed_manifold(part.mesh));
        EXPECT_NEAR(part.mesh.volume(), pores, 1e-9 * pores);
    }
}

/// A body-centred lattice of diameter 1, every centre moved at random.
std::vector<Vec3> shaken_ball(double radius) {
    const double edge = 2.0 / std::sqrt(3.0);
    std::mt19937 generator(3);
    std::normal_distribution<double> shake(0.0, 0.1);
    const int half = int(std::ceil(radius / edge)) + 1;
    std::vector<Vec3> points;
    for (int k = -half; k <= half; ++k)
        for (int j = -half; j <= half; ++j)
            for (int i = -half; i <= half; ++i)
                for (const double shift : {0.0, 0.5}) {
                    const Vec3 moved(shake(generator), shake(generator), shake(generator));
                    const Vec3 p = edge * Vec3(i + shift, j + shift, k + shift) + moved;
                    if (p.norm() < radius) points.push_back(p);
                }
    return points;
}

TEST(CorrectedVolume, OfABallOfTenThousandParticlesIsWithinOnePercent) {
    const std::vector<Vec3> points = shaken_ball(12.2);
    EXPECT_NEAR(double(points.size()), 1e4, 200);
    const double truth = 4.0 / 3.0 * std::numbers::pi * std::pow(12.2, 3);
    const AlphaSurface surface = shape_of(points);
    EXPECT_LT(surface.volume, 0.93 * truth);
    EXPECT_NEAR(surface.bodies[0].corrected_volume, truth, 0.01 * truth);
}

TEST(CorrectedVolume, IsThatOfTheMovedSurface) {
    std::vector<Vec3> points = shaken_ball(9.0);
    std::erase_if(points, [](const Vec3& p) { return p.norm() < 4.0; });
    const AlphaSurface surface = shape_of(points);
    ASSERT_EQ(surface.pores.size(), 1u);
    SurfacePart solid = body_surface(surface), pore = pore_surface(surface);
    correct_envelope(solid, surface.bodies);
    correct_envelope(pore, surface.pores);
    EXPECT_TRUE(is_closed_manifold(solid.mesh));
    EXPECT_NEAR(solid.mesh.volume(), surface.bodies[0].corrected_volume, 1e-9 * surface.volume);
    EXPECT_NEAR(pore.mesh.volume(), surface.pores[0].corrected_volume, 1e-9 * surface.volume);
    const double truth = 4.0 / 3.0 * std::numbers::pi;
    EXPECT_NEAR(pore.mesh.volume(), truth * 64.0, 0.05 * truth * 64.0) << "8 particles across";
    EXPECT_NEAR(solid.mesh.volume(), truth * (729.0 - 64.0), 0.02 * truth * 665.0);
}

TEST(CorrectedVolume, IsNotKnownWhereNoParticleLiesInside) {
    EXPECT_TRUE(std::isnan(shape_of(cubic_lattice(1)).bodies[0].corrected_volume));
}

TEST(AlphaSurface, CountsADuplicatedPointOnce) {
    std::vector<Vec3> points = cubic_lattice(3);
    points.insert(points.end(), points.begin(), points.begin() + 10);
    EXPECT_NEAR(alpha_surface(points, {.probe_radius = 1.0}).volume, 27.0, 1e-10);
}

TEST(AlphaSurface, RejectsFewerThanFourPoints) {
    EXPECT_THAT([] { alpha_surface(std::vector<Vec3>(3, Vec3::Zero()), {.probe_radius = 1.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("at least 4")));
}

TEST(AlphaSurface, RejectsPointsInOnePlane) {
    std::vector<Vec3> points = cubic_lattice(3);
    std::erase_if(points, [](const Vec3& p) { return p.z() != 1.0; });
    EXPECT_THAT([&] { alpha_surface(points, {.probe_radius = 1.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("lie in one plane")));
}

TEST(AlphaSurface, RejectsACoordinateThatIsNotFinite) {
    std::vector<Vec3> points = cubic_lattice(1);
    points[5].y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT([&] { alpha_surface(points, {.probe_radius = 1.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("particle 5")));
}

TEST(AlphaSurface, RejectsAProbeRadiusThatIsNotPositive) {
    EXPECT_THAT([] { alpha_surface(cubic_lattice(1), {.probe_radius = 0.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("more than 0")));
}

}  // namespace
}  // namespace tomodem
