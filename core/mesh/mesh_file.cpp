#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <numeric>

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

}  // namespace tomodem
