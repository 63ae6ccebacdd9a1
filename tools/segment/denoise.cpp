// denoise: a grey tomography with less noise.
#include <fmt/format.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/picture/slices.hpp"
#include "tools/segment/itk_filters.hpp"

namespace tomodem::segment {
namespace {

struct Request {
    VolumeRequest volume;
    std::filesystem::path filtered, picture;
    std::int64_t median = 0, diffusion = 0;
    double edge = 2.0;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("denoise", "Remove noise from a grey tomography, before thresholds make labels of it.");
    add_grey_volume(usage, request.volume)
        .output("FILTERED", request.filtered,
                "Grey volume to write: of the type of VOLUME up to 16 bits, else 32-bit floats.", {".tif", ".tiff"})
        .option("--median", request.median, cli::Unit::voxels, {1, 5},
                "Give each voxel the median of the box that reaches this far along each axis.")
        .option("--diffusion", request.diffusion, cli::Unit::steps, {1, 1000},
                "Smooth by this number of steps of anisotropic diffusion, which stops at edges.")
        .exclusive({"--median", "--diffusion"})
        .option("--edge", request.edge, cli::Unit::none, cli::positive,
                "Gradient that --diffusion takes for an edge, as a multiple of the mean gradient; a larger value "
                "smooths more.")
        .output_option("--picture", request.picture,
                       "Picture to write: middle slice and histogram of the grey values, before and after.", {".png"})
        .example("denoise grey.tif quiet.tif --voxel-size 3um --median 1 --picture quiet.png")
        .example("denoise scan.h5 quiet.tif --diffusion 10")
        .step(cli::Step::image);
    return usage;
}

void run(const Request& request, cli::Tool& tool) {
    const bool median_given = tool.given("--median");
    if (!median_given && !tool.given("--diffusion")) throw WrongUsage("give the filter: --median 1, or --diffusion 10");
    if (median_given && tool.given("--edge")) throw WrongUsage("--edge belongs to --diffusion");
    GreyVolume grey = read_grey_volume(request.volume.path, volume_options(request.volume), tool.threads(), tool);
    tool.report("image", grey.description);
    std::vector<float> values =
        median_given ? median(grey, static_cast<int>(request.median), tool.threads(), tool)
                     : diffusion(grey, static_cast<int>(request.diffusion), request.edge, tool.threads(), tool);

    double squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) squares += std::pow(double{values[i]} - double{grey.values[i]}, 2);
    tool.report("mean_change", std::sqrt(squares / static_cast<double>(values.size())));
    tool.report("written_as", std::string(name_of(grey.stored_type())));
    const auto window = grey_window(grey);
    std::vector<std::vector<Panel>> page{{slice_panel(grey, 2, "before: middle slice across z", window)},
                                         {histogram_panel(grey, "grey values; heights are square roots", window)}};
    grey.values = std::move(values);
    if (!request.picture.empty()) {
        page[0].push_back(slice_panel(grey, 2, "after", window));
        page[1].push_back(histogram_panel(grey, "", window));
        write_panels(page, request.picture);
    }
    write_grey_volume(grey, request.filtered, tool);
}

}  // namespace
}  // namespace tomodem::segment

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::segment::usage, tomodem::segment::run);
}
