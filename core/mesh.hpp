#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/packing.hpp"

namespace tomodem {

/// Triangulated surface [mm]. Closed and outward oriented unless said otherwise.
struct TriangleMesh {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;

    /// Enclosed volume [mm^3] (divergence theorem); negative when the triangles are oriented inwards.
    double volume() const;
    double area() const;  ///< mm^2
};

/// Writes binary STL, binary PLY or VTP by the extension (atomically).
/// @throws InvalidInput for another extension, or if it cannot be written
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path);

/// Reads binary or ASCII STL, PLY as written by write_mesh; equal vertices of an STL are merged.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace tomodem
