#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include "core/base/binary_output.hpp"
#include "core/base/error.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/vtp_file.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return extension;
}

/// 50 bytes a triangle: normal, three corners, an unused number.
void write_stl(const TriangleMesh& mesh, const fs::path& path) {
    BinaryOutput out(path);
    std::string title = "tomodem, lengths in mm";
    title.resize(80, ' ');
    out.text(title);
    out.value(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
        const Vec3 normal = (q - p).cross(r - p).normalized();
        for (const Vec3& v : {normal, p, q, r}) {
            const Eigen::Vector3f single = v.cast<float>();
            out.values(std::span<const float>(single.data(), 3));
        }
        out.value(std::uint16_t{0});
    }
    out.commit();
}

void write_ply(const TriangleMesh& mesh, const fs::path& path) {
    BinaryOutput out(path);
    out.text(
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment tomodem, lengths in mm\nelement vertex {}\n"
                    "property double x\nproperty double y\nproperty double z\nelement face {}\n"
                    "property list uchar int vertex_indices\nend_header\n",
                    mesh.vertices.size(), mesh.triangles.size()));
    for (const Vec3& vertex : mesh.vertices) out.values(std::span<const double>(vertex.data(), 3));
    for (const auto& triangle : mesh.triangles) {
        out.value(std::uint8_t{3});
        out.values(std::span<const std::int32_t>(triangle));
    }
    out.commit();
}

void write_obj(const TriangleMesh& mesh, const std::vector<TriangleNumber>& numbers, const fs::path& path) {
    BinaryOutput out(path);
    out.text("# tomodem, lengths in mm\n");
    for (const Vec3& v : mesh.vertices) out.text(fmt::format("v {} {} {}\n", v.x(), v.y(), v.z()));
    std::vector<std::size_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    const bool grouped = !numbers.empty();
    if (grouped)
        std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
            return numbers.front().values[i] < numbers.front().values[j];
        });
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (grouped) {
            const auto& [name, values] = numbers.front();
            if (k == 0 || values[order[k]] != values[order[k - 1]])
                out.text(fmt::format("g {}_{}\n", name, values[order[k]]));
        }
        const auto& [a, b, c] = mesh.triangles[order[k]];
        out.text(fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1));
    }
    out.commit();
}

/// The bytes of a file, taken from the front; errors name the file.
class Bytes {
 public:
    explicit Bytes(const fs::path& path) : path_(path) {
        std::error_code error;
        if (!fs::exists(path, error)) fail("there is no such file");
        std::ifstream file(path, std::ios::binary);
        if (!file || fs::is_directory(path, error)) fail("it cannot be opened as a file");
        std::ostringstream content;
        content << file.rdbuf();
        all_ = std::move(content).str();
        rest_ = all_;
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InvalidInput(fmt::format("cannot read the mesh '{}': {}", path_.string(), what));
    }
    std::string_view rest() const { return rest_; }
    std::string_view take(std::size_t size) {
        if (size > rest_.size()) fail("the file is cut short");
        const std::string_view front = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return front;
    }
    template <class T>
    T value() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string line() {
        const std::size_t end = rest_.find('\n');
        if (end == std::string_view::npos) fail("the file is cut short");
        std::string text(take(end + 1));
        text.pop_back();
        if (!text.empty() && text.back() == '\r') text.pop_back();
        return text;
    }

 private:
    fs::path path_;
    std::string all_;
    std::string_view rest_;
};

/// Builds a mesh from loose triangles; corners of equal coordinates become one vertex.
class Merger {
 public:
    /// @return false if a corner is not finite
    [[nodiscard]] bool add(const std::array<Vec3, 3>& corners) {
        std::array<std::int32_t, 3> triangle;
        for (int i = 0; i < 3; ++i) {
            const Vec3& p = corners[i];
            if (!p.allFinite()) return false;
            const auto next = static_cast<std::int32_t>(mesh.vertices.size());
            const auto [found, added] = index_.try_emplace({p.x(), p.y(), p.z()}, next);
            if (added) mesh.vertices.push_back(p);
            triangle[i] = found->second;
        }
        mesh.triangles.push_back(triangle);
        return true;
    }
    TriangleMesh mesh;

 private:
    std::map<std::array<double, 3>, std::int32_t> index_;
};

constexpr const char* not_finite = "a vertex is not a finite number";

TriangleMesh read_binary_stl(Bytes& bytes) {
    bytes.take(80);
    const auto count = bytes.value<std::uint32_t>();
    Merger merger;
    for (std::uint32_t i = 0; i < count; ++i) {
        bytes.take(3 * sizeof(float));  // the normal follows from the corners
        std::array<Vec3, 3> corners;
        for (Vec3& corner : corners)
            for (int axis = 0; axis < 3; ++axis) corner[axis] = bytes.value<float>();
        bytes.take(2);
        if (!merger.add(corners)) bytes.fail(not_finite);
    }
    return std::move(merger.mesh);
}

TriangleMesh read_ascii_stl(Bytes& bytes) {
    std::istringstream words{std::string(bytes.rest())};
    Merger merger;
    std::array<Vec3, 3> corners;
    int corner = 0;
    bool ended = false;
    for (std::string word; words >> word;) {
        ended = word == "endsolid";
        if (word != "vertex") continue;
        if (corner == 3) bytes.fail("a facet has more than three corners");
        for (int axis = 0; axis < 3; ++axis) {
            std::string number;
            words >> number;
            const auto [end, error] =
                std::from_chars(number.data(), number.data() + number.size(), corners[corner][axis]);
            if (error != std::errc{} || end != number.data() + number.size())
                bytes.fail(
                    fmt::format("'{}' in triangle {} is not a number", number, merger.mesh.triangles.size() + 1));
        }
        if (++corner == 3) {
            if (!merger.add(corners)) bytes.fail(not_finite);
            corner = 0;
            words >> word;  // endloop: a fourth vertex here would be a polygon
            if (word != "endloop") bytes.fail(fmt::format("a facet ends with '{}' instead of endloop", word));
        }
    }
    if (corner != 0 || (!ended && words.str().find("endsolid") == std::string::npos))
        bytes.fail("the file is cut short");
    return std::move(merger.mesh);
}

TriangleMesh read_stl(Bytes& bytes) {
    // A binary file may begin with "solid" too, so its size decides.
    if (bytes.rest().size() >= 84) {
        std::uint32_t count;
        std::memcpy(&count, bytes.rest().data() + 80, sizeof count);
        if (bytes.rest().size() == 84 + 50 * std::size_t{count}) return read_binary_stl(bytes);
    }
    if (bytes.rest().substr(0, 5) == "solid") return read_ascii_stl(bytes);
    return read_binary_stl(bytes);
}

TriangleMesh read_ply(Bytes& bytes) {
    if (bytes.line() != "ply") bytes.fail("it does not begin with 'ply'");
    std::size_t vertices = 0, faces = 0;
    std::string header;
    for (std::string line = bytes.line(); line != "end_header"; line = bytes.line()) {
        std::istringstream words(line);
        std::string first, second;
        words >> first >> second;
        if (first == "comment" || first == "obj_info") continue;
        if (first == "element" && second == "vertex")
            words >> vertices, line = "element vertex";
        else if (first == "element" && second == "face")
            words >> faces, line = "element face";
        header += line + "\n";
    }
    const auto expected = [](const char* real) {
        return fmt::format(
            "format binary_little_endian 1.0\nelement vertex\nproperty {0} x\nproperty {0} y\nproperty {0} z\n"
            "element face\nproperty list uchar int vertex_indices\n",
            real);
    };
    const bool single = header == expected("float");
    if (!single && header != expected("double"))
        bytes.fail("only binary little-endian PLY with x, y, z and vertex_indices is read, as write_mesh writes it");

    TriangleMesh mesh;
    if (vertices > bytes.rest().size() || faces > bytes.rest().size()) bytes.fail("the file is cut short");
    mesh.vertices.resize(vertices);
    for (Vec3& vertex : mesh.vertices)
        for (int axis = 0; axis < 3; ++axis) vertex[axis] = single ? bytes.value<float>() : bytes.value<double>();
    mesh.triangles.resize(faces);
    for (auto& triangle : mesh.triangles) {
        if (bytes.value<std::uint8_t>() != 3) bytes.fail("a face is not a triangle");
        for (std::int32_t& corner : triangle) {
            corner = bytes.value<std::int32_t>();
            if (corner < 0 || static_cast<std::size_t>(corner) >= vertices)
                bytes.fail(fmt::format("a triangle names vertex {} of {}", corner, vertices));
        }
    }
    return mesh;
}

}  // namespace

void write_mesh(const TriangleMesh& mesh, const fs::path& path, const std::vector<TriangleNumber>& numbers) {
    const std::string extension = extension_of(path);
    if (extension == ".stl") return write_stl(mesh, path);
    if (extension == ".ply") return write_ply(mesh, path);
    if (extension == ".obj") return write_obj(mesh, numbers, path);
    if (extension == ".vtp") {
        std::vector<PointArray> arrays;
        for (const TriangleNumber& number : numbers)
            arrays.push_back({number.name, std::span<const std::int32_t>(number.values)});
        return write_vtp(path, mesh.vertices, mesh.triangles, {}, arrays);
    }
    throw InvalidInput(
        fmt::format("cannot write the mesh '{}': the name must end in .stl, .ply, .vtp or .obj", path.string()));
}

TriangleMesh read_mesh(const fs::path& path) {
    const std::string extension = extension_of(path);
    if (extension != ".stl" && extension != ".ply")
        throw InvalidInput(fmt::format("cannot read the mesh '{}': the name must end in .stl or .ply", path.string()));
    Bytes bytes(path);
    TriangleMesh mesh = extension == ".stl" ? read_stl(bytes) : read_ply(bytes);
    for (const Vec3& vertex : mesh.vertices)
        if (!vertex.allFinite()) bytes.fail(not_finite);
    return mesh;
}

}  // namespace tomodem
