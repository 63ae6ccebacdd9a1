// phantom_scan: the grey tomography that a scanner would make of a label volume.
#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/scan.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    VolumeRequest volume;
    std::filesystem::path image;
    std::string grey = "60,180";
    double noise = 20.0, shading = 0.0;
    std::int64_t random_seed = 1;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("phantom_scan",
                     "Make the grey tomography that a scanner would take of a label volume, with noise and uneven "
                     "brightness.");
    add_volume(usage, request.volume)
        .output("IMAGE", request.image, "Grey volume to write, 8 bits a voxel.", {".tif", ".tiff"})
        .option("--grey", request.grey, "Grey value of each label from 0 on, as 60,180; from 0 to 255.")
        .option("--noise", request.noise, cli::Unit::none, {0, 255},
                "Standard deviation of the noise of a voxel, in grey values.")
        .option("--shading", request.shading, cli::Unit::fraction, {0, 1},
                "Fraction by which the brightness falls along x, from the first voxel to the last.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another noise.")
        .step(cli::Step::image)
        .example("phantom_scan fibres.tif scan.tif --grey 60,180 --noise 30");
    return usage;
}

std::vector<double> grey_values(const std::string& text) {
    const std::string expected = "numbers from 0 to 255 between commas, as 60,180";
    std::vector<double> values = parse_numbers("--grey", text, expected);
    for (const double value : values)
        if (value < 0 || value > 255) throw WrongUsage("--grey '" + text + "': expected " + expected);
    return values;
}

void run(const Request& request, cli::Tool& tool) {
    const Scanner scanner{grey_values(request.grey), request.noise, request.shading};
    const LabelVolume labels = read_volume(request.volume, volume_options(request.volume), tool);
    Random random(static_cast<std::uint64_t>(request.random_seed));
    write_label_volume(scan(labels, scanner, random), request.image, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
