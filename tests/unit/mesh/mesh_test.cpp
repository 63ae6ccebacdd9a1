#include "core/mesh/mesh.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "tests/unit/file_size_limit.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// Corners (0,0,0), (a,0,0), (0,a,0), (0,0,a) moved by `shift`: volume a^3/6, area (3 + sqrt 3) a^2/2.
TriangleMesh corner_tetrahedron(double a, const Vec3& shift = Vec3::Zero()) {
    TriangleMesh mesh;
    mesh.vertices = {shift, shift + Vec3(a, 0, 0), shift + Vec3(0, a, 0), shift + Vec3(0, 0, a)};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

class MeshFile : public InTemporaryFolder {};

TEST(Mesh, VolumeAndAreaOfACornerTetrahedronAreExact) {
    const TriangleMesh mesh = corner_tetrahedron(2.0);
    EXPECT_DOUBLE_EQ(mesh.volume(), 8.0 / 6.0);
    EXPECT_DOUBLE_EQ(mesh.area(), (3.0 + std::sqrt(3.0)) * 2.0);
}

TEST(Mesh, VolumeFarFromTheOriginKeepsItsDigits) {
    EXPECT_DOUBLE_EQ(corner_tetrahedron(2.0, Vec3(1 << 20, 1 << 21, 1 << 22)).volume(), 8.0 / 6.0);
}

TEST(Mesh, VolumeOfAnInsideOutSurfaceIsNegative) {
    TriangleMesh mesh = corner_tetrahedron(1.0);
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    EXPECT_DOUBLE_EQ(mesh.volume(), -1.0 / 6.0);
}

TEST(Mesh, WithoutTrianglesHasNoVolumeAndNoArea) {
    EXPECT_EQ(TriangleMesh{}.volume(), 0.0);
    EXPECT_EQ(TriangleMesh{}.area(), 0.0);
}

TEST_F(MeshFile, PlyGivesTheSameMeshAgain) {
    const TriangleMesh mesh = corner_tetrahedron(1.0 / 3.0, {0.1, 0.2, 0.3});
    write_mesh(mesh, folder / "a.ply");
    const TriangleMesh again = read_mesh(folder / "a.ply");
    EXPECT_EQ(again.vertices, mesh.vertices);
    EXPECT_EQ(again.triangles, mesh.triangles);
    EXPECT_THAT(names(), ElementsAre("a.ply"));
}

TEST_F(MeshFile, StlIsClosedAgainAfterReading) {
    const TriangleMesh mesh = corner_tetrahedron(1.0 / 3.0, {0.1, 0.2, 0.3});
    write_mesh(mesh, folder / "a.STL");
    EXPECT_EQ(std::filesystem::file_size(folder / "a.STL"), 84 + 50 * 4);
    const TriangleMesh again = read_mesh(folder / "a.STL");
    EXPECT_EQ(again.vertices.size(), 4);  // 12 corners merged
    EXPECT_EQ(again.triangles.size(), 4);
    EXPECT_NEAR(again.volume(), mesh.volume(), 1e-6 * mesh.volume());  // single precision
}

TEST_F(MeshFile, AsciiStlIsRead) {
    put(folder / "a.stl",
        "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 2 0 0\n   vertex 0 3e0 0\n"
        "  endloop\n endfacet\nendsolid one\n");
    const TriangleMesh mesh = read_mesh(folder / "a.stl");
    EXPECT_EQ(mesh.triangles.size(), 1);
    EXPECT_EQ(mesh.area(), 3.0);
}

TEST_F(MeshFile, BinaryStlThatBeginsWithSolidIsRead) {
    write_mesh(corner_tetrahedron(1.0), folder / "a.stl");
    std::string bytes = content(folder / "a.stl");
    bytes.replace(0, 5, "solid");
    put(folder / "a.stl", bytes);
    EXPECT_EQ(read_mesh(folder / "a.stl").triangles.size(), 4);
}

TEST_F(MeshFile, PlyAsTextAndInSinglePrecisionIsRead) {
    put(folder / "a.ply",
        "ply\nformat ascii 1.0\ncomment of another program\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar quality\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
        "0 0 0 7\n2 0 0 7\n0 3.5 0 7\n3 0 1 2\n");
    const TriangleMesh mesh = read_mesh(folder / "a.ply");
    EXPECT_EQ(mesh.area(), 3.5);
    EXPECT_THAT(mesh.triangles, ElementsAre(std::array<std::int32_t, 3>{0, 1, 2}));
}

TEST_F(MeshFile, RejectsAFaceOfFourVertices) {
    put(folder / "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    EXPECT_THAT([&] { read_mesh(folder / "a.ply"); }, ThrowsMessage<InvalidInput>(HasSubstr("not a triangle")));
}

TEST_F(MeshFile, RejectsAnotherFileThatIsNamedAsAMesh) {
    for (const char* name : {"a.stl", "a.ply"}) {
        put(folder / name, "frame [-],time [s],strain [-]\n" + std::string(200, '0') + "\n");
        EXPECT_THAT([&] { read_mesh(folder / name); },
                    ThrowsMessage<InvalidInput>(HasSubstr("cut short, or no " + std::string(name).substr(2))));
    }
}

TEST_F(MeshFile, RejectsACutFile) {
    for (const char* name : {"a.stl", "a.ply"}) {
        write_mesh(corner_tetrahedron(1.0), folder / name);
        const std::string bytes = content(folder / name);
        for (const std::size_t size : {std::size_t{0}, std::size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
            put(folder / name, bytes.substr(0, size));
            EXPECT_THAT([&] { read_mesh(folder / name); }, ThrowsMessage<InvalidInput>(HasSubstr("cut short")))
                << name << " " << size;
        }
    }
    put(folder / "a.stl", "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n");
    EXPECT_THAT([&] { read_mesh(folder / "a.stl"); }, ThrowsMessage<InvalidInput>(HasSubstr("cut short")));
}

TEST_F(MeshFile, RejectsAVertexThatIsNotFinite) {
    TriangleMesh mesh = corner_tetrahedron(1.0);
    mesh.vertices[2].y() = std::nan("");
    for (const char* name : {"a.stl", "a.ply"}) {
        write_mesh(mesh, folder / name);
        EXPECT_THAT([&] { read_mesh(folder / name); }, ThrowsMessage<InvalidInput>(HasSubstr("not a finite number")));
    }
}

TEST_F(MeshFile, RejectsATriangleOfAVertexThatIsNotThere) {
    TriangleMesh mesh = corner_tetrahedron(1.0);
    mesh.triangles[0][0] = 4;
    mesh.vertices.resize(5, Vec3::Zero());
    write_mesh(mesh, folder / "a.ply");
    std::string bytes = content(folder / "a.ply");
    bytes.replace(bytes.find("vertex 5"), 8, "vertex 4");
    bytes.erase(bytes.find("end_header\n") + 11 + 4 * 24, 24);
    put(folder / "a.ply", bytes);
    EXPECT_THAT([&] { read_mesh(folder / "a.ply"); }, ThrowsMessage<InvalidInput>(HasSubstr("names vertex 4 of 4")));
}

TEST_F(MeshFile, ObjGroupsItsTrianglesByTheFirstNumber) {
    write_mesh(corner_tetrahedron(0.5), folder / "a.obj", {{"body", {2, 1, 2, 1}}});
    EXPECT_EQ(content(folder / "a.obj"),
              "# tomodem, lengths in mm\nv 0 0 0\nv 0.5 0 0\nv 0 0.5 0\nv 0 0 0.5\n"
              "g body_1\nf 1 2 4\nf 2 3 4\ng body_2\nf 1 3 2\nf 1 4 3\n");
}

TEST_F(MeshFile, RejectsAnotherExtension) {
    EXPECT_THAT([&] { write_mesh(corner_tetrahedron(1.0), folder / "a.off"); },
                ThrowsMessage<InvalidInput>(HasSubstr("must end in .stl, .ply, .vtp or .obj")));
    EXPECT_THAT([&] { read_mesh(folder / "a.obj"); },
                ThrowsMessage<InvalidInput>(HasSubstr("must end in .stl or .ply")));
    EXPECT_THAT(names(), IsEmpty());
}

TEST_F(MeshFile, LeavesNothingBehindWhenTheDiskIsFull) {
    TriangleMesh big;
    for (int i = 0; i < 100; ++i) {
        const TriangleMesh one = corner_tetrahedron(1.0);
        for (const auto& t : one.triangles) {
            const int shift = static_cast<int>(big.vertices.size());
            big.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
        }
        big.vertices.insert(big.vertices.end(), one.vertices.begin(), one.vertices.end());
    }
    const FileSizeLimit limit(1000);
    for (const char* name : {"a.stl", "a.ply", "a.vtp", "a.obj"})
        EXPECT_THAT([&] { write_mesh(big, folder / name); }, ThrowsMessage<InvalidInput>(HasSubstr("File too large")));
    EXPECT_THAT(names(), IsEmpty());
}

}  // namespace
}  // namespace tomodem
