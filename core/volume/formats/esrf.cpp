#include <libxml/parser.h>
#include <libxml/tree.h>

#include <fstream>
#include <functional>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

/// "NUM_X = 2048" lines of a .info, by key in lower case.
std::map<std::string, std::string> fields_of_info(const fs::path& path) {
    std::ifstream file(path);
    std::map<std::string, std::string> fields;
    for (std::string line; std::getline(file, line) && fields.size() < 1000;) {
        const auto equal = line.find('=');
        if (line.starts_with('!') || equal == std::string::npos) continue;
        fields[lower_case(trimmed(line.substr(0, equal)))] = trimmed(line.substr(equal + 1));
    }
    return fields;
}

/// Leaves of an .xml by their name in lower case.
std::map<std::string, std::string> fields_of_xml(const fs::path& path) {
    xmlInitParser();
    const std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)> document(
        xmlReadFile(path.c_str(), nullptr, XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING), &xmlFreeDoc);
    if (!document) cannot_read(path, "it is no well-formed XML");
    std::map<std::string, std::string> fields;
    const std::function<void(xmlNode*)> visit = [&](xmlNode* node) {
        for (; node; node = node->next) {
            if (node->type != XML_ELEMENT_NODE) continue;
            if (xmlChildElementCount(node) > 0) {
                visit(node->children);
                continue;
            }
            const std::unique_ptr<xmlChar, decltype(xmlFree)> text(xmlNodeGetContent(node), xmlFree);
            if (text)
                fields[lower_case(reinterpret_cast<const char*>(node->name))] =
                    trimmed(reinterpret_cast<const char*>(text.get()));
        }
    };
    visit(xmlDocGetRootElement(document.get()));
    return fields;
}

fs::path with_suffix(fs::path path, const char* suffix) {
    return path += suffix;
}

bool is_description(const fs::path& file) {
    const std::string extension = lower_case(file.extension().string());
    return extension == ".info" || extension == ".xml";
}

struct Parts {
    fs::path description, data;
};

Parts parts_of(const fs::path& file) {
    if (is_description(file)) return {file, fs::path(file).replace_extension()};
    const fs::path info = with_suffix(file, ".info");
    return {fs::exists(info) ? info : with_suffix(file, ".xml"), file};
}

Source open_esrf(const fs::path& file, const std::string&) {
    const auto [description, data] = parts_of(file);
    if (!fs::exists(description))
        cannot_read(file, fmt::format("there is no '{}.info' or '.xml' beside it; give its layout with --raw-size and "
                                      "--raw-type",
                                      file.filename().string()));
    const bool info = lower_case(description.extension().string()) == ".info";
    const auto fields = info ? fields_of_info(description) : fields_of_xml(description);
    const auto field = [&](std::initializer_list<const char*> names) -> const std::string* {
        for (const char* name : names)
            if (const auto found = fields.find(name); found != fields.end()) return &found->second;
        return nullptr;
    };
    std::array<std::int64_t, 3> size{};
    const std::array<std::array<const char*, 2>, 3> edges{{{"num_x", "sizex"}, {"num_y", "sizey"}, {"num_z", "sizez"}}};
    for (int axis = 0; axis < 3; ++axis) {
        const std::string* text = field({edges[axis][0], edges[axis][1]});
        if (!text) cannot_read(description, fmt::format("it has no {}", info ? edges[axis][0] : edges[axis][1]));
        size[axis] = whole_number_in(description, edges[axis][info ? 0 : 1], *text);
    }
    check_size(description, size);

    VolumeHeader header;
    header.format = "ESRF volume";
    for (int axis = 0; axis < 3; ++axis) header.size[axis] = static_cast<std::int32_t>(size[axis]);
    if (const std::string* text = field({"voxelsize", "voxel_size"})) {
        constexpr double micrometre = 1e-3;
        const double edge = micrometre * number_in(description, "voxelSize", *text);
        if (edge > 0) {
            header.spacing = Vec3::Constant(edge);
            header.spacing_has_unit = true;
        }
    }
    RawVoxels where{{data}, 0, false, false};
    if (const std::string* text = field({"byteorder", "byte_order"}))
        where.big_endian = lower_case(*text).starts_with("high");
    // A .vol holds floats and a .raw integers; how many bytes they have, only the length of the file says.
    const std::int64_t voxels = size[0] * size[1] * size[2], bytes = file_bytes(data);
    const bool floats = lower_case(data.extension().string()) != ".raw";
    header.type = floats ? VoxelType::float32 : bytes == 2 * voxels ? VoxelType::uint16 : VoxelType::uint8;
    return open_raw(std::move(header), where);
}

const RegisteredFormat esrf{{
    .name = "ESRF .vol or .raw with .info or .xml",
    .extensions = {".vol", ".raw"},
    .sniff = [](const std::string&, const fs::path& file) { return is_description(file); },
    .companions = [](const fs::path& file) -> std::vector<fs::path> {
        const auto [description, data] = parts_of(file);
        return {description, data};
    },
    .open = open_esrf,
}};

}  // namespace
}  // namespace tomodem::formats
