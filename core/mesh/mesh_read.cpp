#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <array>
#include <compare>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/base/error.hpp"
#include "core/mesh/mesh.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

/// Errors name the file.
class MeshFile {
 public:
    explicit MeshFile(const fs::path& path) : path_(path) {
        std::error_code error;
        if (!fs::exists(path, error)) fail("there is no such file");
        std::ifstream file(path, std::ios::binary);
        if (!file || fs::is_directory(path, error)) fail("it cannot be opened as a file");
        std::ostringstream content;
        content << file.rdbuf();
        bytes_ = std::move(content).str();
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InvalidInput(fmt::format("cannot read the mesh '{}': {}", path_.string(), what));
    }
    std::string take() { return std::move(bytes_); }

 private:
    fs::path path_;
    std::string bytes_;
};

using Polygons = std::vector<std::vector<std::size_t>>;

/// CGAL merges the equal vertices of an STL in this order, in which one that is not a number equals itself alone.
struct Vertex : std::array<double, 3> {
    friend bool operator<(const Vertex& a, const Vertex& b) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (const std::weak_ordering order = std::weak_order(a[axis], b[axis]); order != 0) return order < 0;
        return false;
    }
};

constexpr std::size_t binary_stl_header = 84, binary_stl_triangle = 50;

/// @return false if the bytes are not all of an STL file
bool read_stl(std::string bytes, std::vector<Vec3>& vertices, Polygons& polygons) {
    bool binary = !bytes.starts_with("solid");
    if (bytes.size() >= binary_stl_header) {
        // A binary file may begin with "solid" too, which CGAL takes for text: its size decides.
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + binary_stl_header - sizeof count, sizeof count);
        binary = binary || bytes.size() == binary_stl_header + binary_stl_triangle * std::size_t{count};
        if (binary) bytes.front() = '#';
    }
    // CGAL takes the beginning of a header for an empty file.
    if (binary ? bytes.size() < binary_stl_header : bytes.find("endsolid") == std::string::npos) return false;
    std::istringstream stream(std::move(bytes));
    std::vector<Vertex> points;
    if (!CGAL::IO::read_STL(stream, points, polygons)) return false;
    for (const Vertex& point : points) vertices.emplace_back(point[0], point[1], point[2]);
    return true;
}

/// @return false if the bytes are not all of a PLY file
bool read_ply(std::string bytes, std::vector<Vec3>& vertices, Polygons& polygons) {
    std::istringstream stream(std::move(bytes));
    std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
    if (!CGAL::IO::read_PLY(stream, points, polygons, CGAL::parameters::verbose(false))) return false;
    for (const auto& point : points) vertices.emplace_back(point.x(), point.y(), point.z());
    return true;
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension != ".stl" && extension != ".ply")
        throw InvalidInput(fmt::format("cannot read the mesh '{}': the name must end in .stl or .ply", path.string()));
    MeshFile file(path);
    TriangleMesh mesh;
    Polygons polygons;
    if (!(extension == ".stl" ? read_stl : read_ply)(file.take(), mesh.vertices, polygons))
        file.fail(fmt::format("the file is cut short, or no {} file of triangles", extension.substr(1)));
    for (const Vec3& vertex : mesh.vertices)
        if (!vertex.allFinite()) file.fail("a vertex is not a finite number");
    mesh.triangles.reserve(polygons.size());
    for (const auto& polygon : polygons) {
        if (polygon.size() != 3) file.fail("a face is not a triangle");
        std::array<std::int32_t, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            if (polygon[k] >= mesh.vertices.size())
                file.fail(fmt::format("a triangle names vertex {} of {}", polygon[k], mesh.vertices.size()));
            triangle[k] = static_cast<std::int32_t>(polygon[k]);
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

}  // namespace tomodem
