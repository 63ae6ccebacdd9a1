// separate_objects: touching objects of a phase, each with a label of its own.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/picture/slices.hpp"
#include "tools/segment/separation.hpp"

namespace tomodem::segment {
namespace {

struct Request {
    VolumeRequest volume;
    std::filesystem::path objects, picture;
    std::string labels;
    double min_depth = 0.0;
    std::int64_t min_voxels = 1;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("separate_objects",
                     "Separate touching objects (grains, inclusions) by a watershed; each gets a label of its own.");
    add_volume(usage, request.volume)
        .output("OBJECTS", request.objects,
                "Label volume to write, of 8, 16 or 32 bits as the number of objects needs.", {".tif", ".tiff"})
        .option("--labels", request.labels,
                "Labels whose objects are separated, as 1 or 1,3; without it, the only label that is not void.")
        .option("--min-depth", request.min_depth, cli::Unit::length, cli::positive,
                "Two parts are two objects if the neck between them is narrower than both by this, as the radius of "
                "the largest sphere inside; a larger value gives fewer objects. Without it, the edge of a voxel.")
        .option("--min-voxels", request.min_voxels, cli::Unit::voxels, cli::positive,
                "Smaller parts join the object beside them; where there is none, they take the label around them.")
        .output_option("--picture", request.picture,
                       "Picture to write: the middle slices before and after, each object in a colour of its own.",
                       {".png"})
        .example("separate_objects sand.tif objects.tif --voxel-size 3um --picture objects.png")
        .example("separate_objects grey.tif objects.tif --voxel-size 3um --otsu 1 --min-depth 6um --min-voxels 27")
        .example("vol2pack brick.h5 objects.tif sample.h5 --pixels-per-seed 2 --label-objects 1:105=1")
        .step(cli::Step::image);
    return usage;
}

std::vector<std::int32_t> labels_to_separate(const Request& request, const LabelVolume& volume) {
    std::vector<std::int32_t> solid;
    for (const auto& [label, voxels] : volume.histogram())
        if (label != 0) solid.push_back(label);
    if (!request.labels.empty()) {
        const auto labels = parse_labels("--labels", request.labels);
        for (const std::int32_t label : labels) {
            if (label < 1) throw WrongUsage(fmt::format("--labels {}: objects have labels from 1 on", request.labels));
            if (!std::binary_search(solid.begin(), solid.end(), label))
                throw InvalidInput(fmt::format("--labels {}: the image has no label {}", request.labels, label));
        }
        return labels;
    }
    constexpr std::size_t max_labels = 16;
    if (solid.size() > max_labels)
        throw InvalidInput(
            fmt::format("the image has {} labels: if it is grey give --threshold or --otsu, if its "
                        "objects have labels of their own already, vol2pack --label-objects",
                        solid.size()));
    if (solid.size() > 1)
        throw InvalidInput(
            fmt::format("the image has the labels {}: name those whose objects are to be separated, as --labels {}",
                        fmt::join(solid, ", "), solid.front()));
    if (solid.empty()) throw InvalidInput("the image is void everywhere");
    return solid;
}

double diameter(double volume) {
    return std::cbrt(6 * volume / std::numbers::pi);
}

void report(const Separation& separation, const LabelVolume& before, cli::Tool& tool) {
    std::vector<std::string> ranges;
    std::vector<std::int64_t> voxels;
    std::int64_t components = 0, cut = 0, joined = 0, removed = 0;
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    for (const SeparatedLabel& one : separation.labels) {
        ranges.push_back(fmt::format("{}:{}={}", one.first, one.last(), one.label));
        voxels.insert(voxels.end(), one.voxels.begin(), one.voxels.end());
        components += one.components;
        cut += one.components_cut;
        joined += one.joined;
        removed += one.removed;
        table.push_back({{"label", one.label},
                         {"first", one.first},
                         {"last", one.last()},
                         {"components", one.components},
                         {"components_cut", one.components_cut},
                         {"voxels", one.voxels}});
        const std::int64_t largest = *std::max_element(one.voxels.begin(), one.voxels.end());
        const double share = static_cast<double>(largest) / static_cast<double>(before.histogram().at(one.label));
        constexpr std::size_t many = 10;
        if (one.voxels.size() >= many && share > 0.5)
            tool.warn(
                fmt::format("one of the {} objects of label {} holds {:.0f} % of it: if it is several that touch, give "
                            "a smaller --min-depth; the others may be specks (--min-voxels)",
                            one.voxels.size(), one.label, 100 * share));
    }
    std::sort(voxels.begin(), voxels.end());
    const std::int64_t median = voxels[voxels.size() / 2];
    tool.report("components", components);
    tool.report("components_cut", cut);
    tool.report("objects", static_cast<std::int64_t>(voxels.size()));
    tool.report("touching_objects", touching_objects(separation.volume, separation.labels.front().first));
    tool.report("smallest_object", voxels.front(), "voxels");
    tool.report("median_object", median, "voxels");
    tool.report("largest_object", voxels.back(), "voxels");
    tool.report("median_diameter", 1e3 * diameter(static_cast<double>(median) * before.spacing().prod()), "um");
    if (joined > 0) tool.report("small_parts_joined", joined);
    if (removed > 0) tool.report("small_parts_removed", removed);
    tool.report("label_objects", fmt::format("{}", fmt::join(ranges, ",")));
    tool.report_json("labels", table);
    constexpr std::int64_t speck = 27;
    if (median < speck)
        tool.warn(
            fmt::format("half of the objects have at most {} voxels: they are noise, or parts of larger objects; "
                        "give a larger --min-depth or --min-voxels, or remove noise first (denoise)",
                        median));
}

void draw(const Separation& separation, const LabelVolume& before, const std::filesystem::path& picture) {
    const std::int32_t first = separation.labels.front().first;
    const auto phase = [&](std::int32_t label) -> Colour {
        for (const SeparatedLabel& one : separation.labels)
            if (one.label == label) return {225, 205, 150};
        return label == 0 ? Colour{25, 25, 30} : Colour{120, 120, 125};
    };
    const auto object = [&](std::int32_t label) -> Colour {
        if (label >= first) return colour_of_object(label - first + 1);
        return label == 0 ? Colour{25, 25, 30} : Colour{120, 120, 125};
    };
    std::vector<std::vector<Panel>> rows;
    for (const int axis : {2, 1, 0})
        rows.push_back({slice_panel(before, axis, fmt::format("before: middle slice across {}", "xyz"[axis]), phase),
                        slice_panel(separation.volume, axis,
                                    axis == 2 ? fmt::format("after: {} objects in the volume",
                                                            separation.labels.back().last() - first + 1)
                                              : "after",
                                    object)});
    write_panels(rows, picture);
}

void run(const Request& request, cli::Tool& tool) {
    const LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const auto labels = labels_to_separate(request, volume);
    const double min_depth = tool.given("--min-depth") ? request.min_depth : volume.spacing().maxCoeff();
    tool.report("min_depth", 1e3 * min_depth, "um");
    const Separation separation = separate_objects(volume, labels, min_depth, request.min_voxels, tool);
    report(separation, volume, tool);
    if (!request.picture.empty()) draw(separation, volume, request.picture);
    write_label_volume(separation.volume, request.objects, tool);
}

}  // namespace
}  // namespace tomodem::segment

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::segment::usage, tomodem::segment::run);
}
