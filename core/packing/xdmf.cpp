#include "core/packing/xdmf.hpp"

#include <fmt/format.h>

namespace tomodem {
namespace {

std::string xml_escaped(const std::string& text) {
    std::string out;
    for (const char c : text) switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            default:
                out += c;
        }
    return out;
}

std::string scalar(const std::string& name, const std::string& array, int bytes, const XdmfContent& content) {
    return fmt::format(
        R"(        <Attribute Name="{}" AttributeType="Scalar" Center="Node">
          <DataItem Format="HDF" NumberType="Int" Precision="{}" Dimensions="{}">{}:/particles/all/{}</DataItem>
        </Attribute>
)",
        name, bytes, content.particles, xml_escaped(content.h5_name), array);
}

/// A field in one frame. XDMF has no name for six components in the order of the file: they are a matrix of one row.
std::string field_of_frame(const ParticleField& field, std::size_t frame, const XdmfContent& content) {
    const char* type = field.components == 1 ? "Scalar" : field.components == 3 ? "Vector" : "Matrix";
    return fmt::format(
        R"(        <Attribute Name="{0}" AttributeType="{1}" Center="Node">
          <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{2} {3}">{4}:/xdmf/{0}_{5}</DataItem>
        </Attribute>
)",
        field.name, type, content.particles, field.components, xml_escaped(content.h5_name), frame);
}

/// VTK's two readers agree on plain arrays only: the newer one passes over an ItemType="HyperSlab" of the run's
/// positions and makes no cells of a Polyvertex without indices. Hence the arrays of the group /xdmf.
std::string grid(std::size_t frame, const XdmfContent& content) {
    const std::size_t n = content.particles;
    const std::string h5 = xml_escaped(content.h5_name);
    std::string text = fmt::format(
        R"(      <Grid Name="particles" GridType="Uniform">
        <Time Value="{0}"/>
        <Topology TopologyType="Polyvertex" NumberOfElements="{1}" NodesPerElement="1">
          <DataItem Format="HDF" NumberType="Int" Precision="4" Dimensions="{1}">{2}:/xdmf/vertex</DataItem>
        </Topology>
        <Geometry GeometryType="XYZ">
          <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{1} 3">{2}:/xdmf/position_{3}</DataItem>
        </Geometry>
)",
        content.times[frame], n, h5, frame);
    text += scalar("species", "species", 4, content);
    text += scalar("id", "id", 8, content);
    if (content.has_objects) text += scalar("object", "object", 4, content);
    for (const ParticleField& field : content.fields) text += field_of_frame(field, frame, content);
    return text + "      </Grid>\n";
}

}  // namespace

std::string xdmf_text(const XdmfContent& content) {
    const bool collection = content.times.size() > 1;
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"2.0\">\n  <Domain>\n";
    if (collection) text += "    <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
    for (std::size_t frame = 0; frame < content.times.size(); ++frame) text += grid(frame, content);
    if (collection) text += "    </Grid>\n";
    return text + "  </Domain>\n</Xdmf>\n";
}

}  // namespace tomodem
