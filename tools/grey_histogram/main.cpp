// grey_histogram: how often each grey value occurs in a tomography, and the thresholds that segment it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/volume/grey_histogram.hpp"
#include "tools/grey_histogram/chart.hpp"

namespace tomodem::grey_histogram {
namespace {

struct Request {
    VolumeRequest volume;
    std::filesystem::path picture;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("grey_histogram", "Draw the histogram of a grey tomography with the thresholds that segment it.");
    add_volume(usage, request.volume)
        .output("PICTURE", request.picture, "Picture to write.", {".png"})
        .example("grey_histogram grey.tif histogram.png                     # Otsu's threshold")
        .example("grey_histogram scan.h5 histogram.png --otsu 2 --bin 4     # two thresholds, of a coarser image")
        .example("grey_histogram grey/ histogram.png --threshold 83,140     # your own thresholds")
        .step(cli::Step::image);
    return usage;
}

void run(const Request& request, cli::Tool& tool) {
    VolumeOptions options = volume_options(request.volume);
    const GreyImage image = read_grey_histogram(request.volume.path, options, tool.threads(), tool);
    const GreyHistogram& histogram = image.histogram;
    tool.report("image", image.description);
    if (options.thresholds.empty()) options.thresholds = otsu_thresholds(histogram, std::max(1, options.otsu_levels));

    tool.report("voxels", histogram.voxels());
    if (histogram.not_a_number > 0) tool.report("not_a_number", histogram.not_a_number);
    std::vector<std::int64_t> classes(options.thresholds.size() + 1);
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
        std::size_t label = 0;
        for (const double threshold : options.thresholds) label += histogram.upper(bin) > threshold;
        classes[label] += histogram.counts[bin];
    }
    for (std::size_t i = 0; i < options.thresholds.size(); ++i)
        tool.report(fmt::format("threshold_{}", i + 1), options.thresholds[i]);
    for (std::size_t i = 0; i < classes.size(); ++i)
        tool.report(fmt::format("fraction_label_{}", i),
                    100.0 * static_cast<double>(classes[i]) / static_cast<double>(histogram.voxels()), "%");
    const auto values =
        std::count_if(histogram.counts.begin(), histogram.counts.end(), [](std::int64_t count) { return count > 0; });
    constexpr std::ptrdiff_t max_labels = 16;
    if (histogram.whole && values <= max_labels)
        tool.note(fmt::format("the image has {} values: if they are labels already, it needs no threshold", values));
    constexpr double few = 5;  // %
    if (request.volume.threshold.empty())
        for (std::size_t i = 0; i < classes.size(); ++i)
            if (const double share = 100.0 * static_cast<double>(classes[i]) / static_cast<double>(histogram.voxels());
                share < few)
                tool.note(
                    fmt::format("label {} is {:.2g} % of the image: for so small a phase Otsu's threshold may be "
                                "far off; check it in the picture, and give --threshold",
                                i, share));
    tool.report_json("counts", histogram.counts);
    tool.report("first_bin", histogram.low);
    tool.report("bin_width", histogram.width);
    draw_histogram(histogram, options.thresholds, request.picture, tool.threads());
}

}  // namespace
}  // namespace tomodem::grey_histogram

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::grey_histogram::usage, tomodem::grey_histogram::run);
}
