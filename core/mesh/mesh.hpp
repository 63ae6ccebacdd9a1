#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem {

/// Triangulated surface [mm]. Closed and outward oriented unless said otherwise.
struct TriangleMesh {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;

    /// Enclosed volume [mm^3] (divergence theorem); negative when the triangles are oriented inwards.
    double volume() const;
    double area() const;  ///< mm^2
};

/// A number of each triangle, such as that of the body it belongs to.
struct TriangleNumber {
    std::string name;
    std::vector<std::int32_t> values;
};

/// Writes binary STL, binary PLY, VTP or OBJ by the extension (atomically).
/// @param numbers  VTP: cell arrays; OBJ: a group "NAME_VALUE" for each value of the first; else left out
/// @throws InvalidInput for another extension, or if it cannot be written
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path,
                const std::vector<TriangleNumber>& numbers = {});

/// Reads binary or ASCII STL or PLY, by CGAL: library tomodem_mesh_read. Equal vertices of an STL are merged.
/// @throws InvalidInput for another extension, a file that is cut or damaged, a vertex that is not finite, or a face
///         that is not a triangle
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace tomodem
