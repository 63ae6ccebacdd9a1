// local_threshold: labels from grey values that drift from one place to another.
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/picture/slices.hpp"
#include "tools/segment/itk_filters.hpp"

namespace tomodem::segment {
namespace {

struct Request {
    VolumeRequest volume;
    std::filesystem::path labels, picture;
    std::int64_t radius = 0;
    double offset = 0.0;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("local_threshold",
                     "Make labels from grey values by a threshold of each voxel's own: the mean of what is around it.");
    add_grey_volume(usage, request.volume)
        .output("LABELS", request.labels, "Label volume to write: 1 above the threshold, 0 elsewhere.",
                {".tif", ".tiff"})
        .required("--radius", request.radius, cli::Unit::voxels, {1, 1000},
                  "How far the box of the mean reaches along each axis: about the thickness of the thickest part of "
                  "either phase.")
        .option("--offset", request.offset, cli::Unit::none, cli::any,
                "Grey values that are added to the mean; about half the contrast keeps noise out of wide dark parts.")
        .output_option("--picture", request.picture, "Picture to write: middle slices, grey and labels.", {".png"})
        .example("local_threshold grey.tif labels.tif --voxel-size 3um --radius 20 --picture labels.png")
        .example("local_threshold quiet.tif labels.tif --radius 30 --offset 8")
        .step(cli::Step::image);
    return usage;
}

void run(const Request& request, cli::Tool& tool) {
    const GreyVolume grey = read_grey_volume(request.volume.path, volume_options(request.volume), tool.threads(), tool);
    tool.report("image", grey.description);
    const auto mean = local_mean(grey, static_cast<int>(request.radius), tool.threads(), tool);
    LabelVolume labels(grey.size, grey.spacing, grey.origin);
    labels.use_threads(tool.threads());
    const std::int64_t page = std::int64_t{grey.size[0]} * grey.size[1];
    std::vector<std::int32_t> slab;
    for (std::int32_t k = 0; k < grey.size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, grey.size[2] - k);
        slab.resize(page * count);
        for (std::size_t i = 0; i < slab.size(); ++i) {
            const std::size_t at = static_cast<std::size_t>(k * page) + i;
            slab[i] = double{grey.values[at]} > double{mean[at]} + request.offset;
        }
        labels.set_slices(k, count, slab);
    }
    const auto counts = labels.histogram();
    for (const std::int32_t label : {0, 1})
        tool.report(fmt::format("fraction_label_{}", label),
                    100.0 * static_cast<double>(counts.contains(label) ? counts.at(label) : 0) /
                        static_cast<double>(grey.values.size()),
                    "%");
    if (counts.size() < 2)
        throw InvalidInput(fmt::format("every voxel is {} the threshold: give another --offset",
                                       counts.begin()->first == 0 ? "below" : "above"));
    if (!request.picture.empty()) {
        const auto window = grey_window(grey);
        std::vector<std::vector<Panel>> rows;
        for (const int axis : {2, 1})
            rows.push_back({slice_panel(grey, axis, fmt::format("grey: middle slice across {}", "xyz"[axis]), window),
                            slice_panel(labels, axis, "label 1", [](std::int32_t label) {
                                return label == 0 ? Colour{25, 25, 30} : Colour{225, 205, 150};
                            })});
        write_panels(rows, request.picture);
    }
    write_label_volume(labels, request.labels, tool);
}

}  // namespace
}  // namespace tomodem::segment

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::segment::usage, tomodem::segment::run);
}
