#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem {

/// One value, or row of them, a point (or triangle), under the name that ParaView shows.
///
/// Six components are a symmetric tensor in VTK's order: xx yy zz xy yz xz.
struct PointArray {
    std::string name;
    std::variant<std::span<const double>, std::span<const std::int32_t>, std::span<const std::int64_t>> values;
    int components = 1;
};

/// Writes VTK PolyData (.vtp, raw appended binary, little-endian) atomically: a surface, or points where there are no
/// triangles (each one then is a vertex cell).
///
/// @param points     mm
/// @param triangles  indices into points; may be empty
/// @param arrays     each a row for each point
/// @param on_triangles  each as long as triangles; none where there are no triangles
/// @throws InvalidInput if the file cannot be written
/// @see   The VTK User's Guide, 11th ed. (2010), section 19.3 (XML file formats)
void write_vtp(const std::filesystem::path& path, std::span<const Vec3> points,
               std::span<const std::array<std::int32_t, 3>> triangles = {}, const std::vector<PointArray>& arrays = {},
               const std::vector<PointArray>& on_triangles = {});

/// Writes a ParaView collection (.pvd) of files beside it, each at its time [s].
void write_pvd(const std::filesystem::path& path,
               const std::vector<std::pair<double, std::filesystem::path>>& file_at_time);

}  // namespace tomodem
