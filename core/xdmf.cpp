#include "core/xdmf.hpp"

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

std::string grid(std::size_t frame, const XdmfContent& content) {
    const std::size_t n = content.particles;
    std::string text = fmt::format(
        R"(      <Grid Name="particles" GridType="Uniform">
        <Time Value="{}"/>
        <Topology TopologyType="Polyvertex" NumberOfElements="{}" NodesPerElement="1"/>
        <Geometry GeometryType="XYZ">
          <DataItem ItemType="HyperSlab" Dimensions="1 {} 3">
            <DataItem Format="XML" NumberType="Int" Dimensions="3 3">{} 0 0 1 1 1 1 {} 3</DataItem>
            <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{} {} 3">{}:/particles/all/position/value</DataItem>
          </DataItem>
        </Geometry>
)",
        content.times[frame], n, n, frame, n, content.times.size(), n, xml_escaped(content.h5_name));
    text += scalar("species", "species", 4, content);
    text += scalar("id", "id", 8, content);
    if (content.has_objects) text += scalar("object", "object", 4, content);
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
