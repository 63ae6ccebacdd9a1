// volume_info: what a segmented tomography holds, the files it is made of, and the volumes in a folder.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/volume/volume_files.hpp"

namespace tomodem::volume_info {
namespace {

struct Request {
    VolumeRequest volume;
    std::int64_t min_component = 27;
    bool files = false, find = false;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("volume_info", "Report size, labels and connected components of a segmented tomography.");
    add_volume(usage, request.volume)
        .option("--min-component", request.min_component, cli::Unit::voxels, cli::positive,
                "For each label, also report the number of connected components of at least this size.")
        .flag("--files", request.files,
              "Only list the files that the volume is made of, one per line (key files); its voxels are not read.")
        .flag("--find", request.find,
              "Only list the volumes in the folder VOLUME, one per line: image files, and subfolders of slices. With "
              "--json, they are under the key volumes.")
        .exclusive({"--files", "--find"})
        .example("volume_info stack/ --voxel-size 2.4um")
        .example("volume_info scan.h5:/exchange/data --voxel-size 2.4um --bin 4 --otsu 1")
        .example("volume_info grey.tif --voxel-size 19.5um --threshold 83 --json info.json")
        .example("volume_info scan.mhd --files")
        .example("volume_info scans/ --find")
        .step(cli::Step::image);
    return usage;
}

void list_paths(const std::string& key, const std::vector<std::filesystem::path>& paths, cli::Tool& tool) {
    tool.report_lines(key, {paths.begin(), paths.end()});
}

void run(const Request& request, cli::Tool& tool) {
    if (request.files) {
        const auto files = volume_files(request.volume.path);
        if (std::filesystem::is_directory(files.front())) open_volume(request.volume.path);  // names what is missing
        list_paths("files", files, tool);
        return;
    }
    if (request.find) {
        list_paths("volumes", find_volumes(request.volume.path), tool);
        return;
    }
    const LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const VoxelIndex size = volume.size();
    const Vec3 extent = volume.extent();
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name(1, "xyz"[axis]);
        tool.report("size_" + name, std::int64_t{size[axis]}, "voxels");
        tool.report("voxel_size_" + name, 1e3 * volume.spacing()[axis], "um");
        tool.report("extent_" + name, extent[axis], "mm");
    }
    const auto histogram = volume.histogram();
    constexpr std::size_t max_labels = 16;
    if (histogram.size() > max_labels) {
        tool.report("label_count", static_cast<std::int64_t>(histogram.size()));
        tool.warn(
            "more than 16 labels, so nothing more is counted: if the image is grey, give --otsu 1 or --threshold "
            "(grey_histogram shows where it cuts, denoise removes noise before); if each object has a label of its "
            "own, "
            "vol2pack takes them by --label-objects");
        return;
    }

    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : histogram) labels.push_back(label);
    const Components components = connected_components(volume, labels, Joining::same_label, Connectivity::faces, tool);
    const double all = static_cast<double>(size[0]) * size[1] * size[2];
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    std::int64_t specks = 0;
    for (const auto& [label, voxels] : histogram) {
        std::int64_t count = 0, large = 0, largest = 0;
        for (std::size_t i = 0; i < components.voxels.size(); ++i) {
            if (components.label[i] != label) continue;
            ++count;
            large += components.voxels[i] >= request.min_component;
            largest = std::max(largest, components.voxels[i]);
        }
        if (label != 0) specks += count - large;
        const std::string key = fmt::format("label_{}", label);
        tool.report("voxels_" + key, voxels);
        tool.report("fraction_" + key, 100 * static_cast<double>(voxels) / all, "%");
        tool.report("components_" + key, count);
        tool.report("large_components_" + key, large);
        tool.report("largest_component_" + key, largest, "voxels");
        table.push_back({{"label", label},
                         {"voxels", voxels},
                         {"fraction", static_cast<double>(voxels) / all},
                         {"components", count},
                         {"large_components", large},
                         {"largest_component", largest}});
    }
    tool.report_json("labels", table);
    if (specks > 0)
        tool.note(
            fmt::format("{} of the components that are not void have fewer than {} voxels: if they are noise, vol2pack "
                        "--min-component {} removes them, or denoise before the threshold",
                        specks, request.min_component, request.min_component));
}

}  // namespace
}  // namespace tomodem::volume_info

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::volume_info::usage, tomodem::volume_info::run);
}
