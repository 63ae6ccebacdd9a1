#include "core/mesh/vtp_file.hpp"

#include <fmt/format.h>

#include <numeric>

#include "core/base/binary_output.hpp"
#include "core/base/output_file.hpp"

namespace tomodem {
namespace {

/// The appended blocks of a VTK XML file: the tags name offsets, the bytes come at the end, each behind its size.
class Appended {
 public:
    template <class T>
    std::string tag(const std::string& name, const char* type, std::span<const T> values, int components = 1) {
        std::string text = fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
            name, components, offset_);
        blocks_.push_back(std::as_bytes(values));
        offset_ += sizeof(std::uint64_t) + values.size_bytes();
        return text;
    }
    void write(BinaryOutput& out) const {
        for (const auto& block : blocks_) {
            out.value(static_cast<std::uint64_t>(block.size()));
            out.values(block);
        }
    }

 private:
    std::vector<std::span<const std::byte>> blocks_;
    std::uint64_t offset_ = 0;
};

std::string xml_escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    return out;
}

std::string tag_of(Appended& appended, const PointArray& array) {
    return std::visit(
        [&](const auto& values) {
            using T = typename std::decay_t<decltype(values)>::value_type;
            const char* type = std::is_same_v<T, double> ? "Float64" : sizeof(T) == 4 ? "Int32" : "Int64";
            return appended.tag(array.name, type, values, array.components);
        },
        array.values);
}

}  // namespace

void write_vtp(const std::filesystem::path& path, std::span<const Vec3> points,
               std::span<const std::array<std::int32_t, 3>> triangles, const std::vector<PointArray>& arrays,
               const std::vector<PointArray>& on_triangles) {
    const bool surface = !triangles.empty();
    const std::size_t cells = surface ? triangles.size() : points.size();
    const std::int32_t corners = surface ? 3 : 1;
    std::vector<std::int32_t> own;
    if (!surface) {
        own.resize(cells);
        std::iota(own.begin(), own.end(), 0);
    }
    const std::span<const std::int32_t> connectivity =
        surface ? std::span(triangles.front().data(), 3 * cells) : std::span<const std::int32_t>(own);
    std::vector<std::int64_t> offsets(cells);
    for (std::size_t i = 0; i < cells; ++i) offsets[i] = static_cast<std::int64_t>(i + 1) * corners;
    const std::span<const double> coordinates =
        points.empty() ? std::span<const double>() : std::span(points.front().data(), 3 * points.size());

    Appended appended;
    std::string head = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"{}\">\n<PointData>\n",
        points.size(), surface ? 0 : cells, surface ? cells : 0);
    for (const PointArray& array : arrays) head += tag_of(appended, array);
    head += "</PointData>\n<CellData>\n";
    if (surface)
        for (const PointArray& array : on_triangles) head += tag_of(appended, array);
    head += "</CellData>\n<Points>\n";
    head += appended.tag("Points", "Float64", coordinates, 3);
    const char* kind = surface ? "Polys" : "Verts";
    head += fmt::format("</Points>\n<{}>\n", kind);
    head += appended.tag("connectivity", "Int32", connectivity);
    head += appended.tag("offsets", "Int64", std::span<const std::int64_t>(offsets));
    head += fmt::format("</{}>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", kind);

    BinaryOutput out(path);
    out.text(head);
    appended.write(out);
    out.text("\n</AppendedData>\n</VTKFile>\n");
    out.commit();
}

void write_pvd(const std::filesystem::path& path,
               const std::vector<std::pair<double, std::filesystem::path>>& file_at_time) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "<Collection>\n";
    for (const auto& [time, file] : file_at_time)
        text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time,
                            xml_escaped(file.filename().string()));
    write_text(path, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace tomodem
