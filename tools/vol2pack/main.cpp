// vol2pack: fill a segmented tomography with labelled particles.
#include <fmt/format.h>

#include <algorithm>

#include "core/cli.hpp"
#include "core/packing_file.hpp"
#include "core/volume_cli.hpp"
#include "tools/vol2pack/phase_report.hpp"
#include "tools/vol2pack/sample.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path brick, sample;
    VolumeRequest volume;
    double pixels_per_seed = 0.0;
    std::string filter = "nearest";
    double box_size = 1.0;
    std::string labels, objects;
    std::int64_t min_component = 0;
    std::int64_t random_seed = 0;
    std::int64_t max_particles = 50'000'000;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("vol2pack", "Fill a segmented tomography with a periodic packing; each particle takes its label.");
    usage.input("brick", request.brick, "periodic packing (.h5, from packgen), repeated as far as the image goes");
    add_volume(usage, request.volume)
        .output("sample", request.sample, "sample to write (.h5)")
        .required("--pixels-per-seed", request.pixels_per_seed, cli::Unit::voxels, cli::positive,
                  "radius of a particle's seed; smaller is finer and costs more")
        .choice("--filter", request.filter, {"nearest", "box"},
                "label of the voxel at the centre, or the one that fills most of a box around it")
        .option("--box-size", request.box_size, cli::Unit::none, cli::positive,
                "edge of the box of --filter box, in diameters of a seed")
        .option("--labels", request.labels,
                "names of the labels, as 1=matrix,2=inclusion; a label of the image that is not named is then an error")
        .option("--objects", request.objects,
                "labels of which each connected component (by faces) becomes an object of its own, as 2,3")
        .option("--min-component", request.min_component, cli::Unit::voxels, cli::not_negative,
                "smaller connected components, void apart, take the label that surrounds them")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "shift the brick by a random vector, for several samples of one image; 0: no shift")
        .option("--max-particles", request.max_particles, cli::Unit::particles, cli::positive,
                "refuse to make more (a wrong scale fills the memory)")
        .example("vol2pack brick.h5 stack/ sample.h5 --voxel-size 2.4um --pixels-per-seed 2")
        .example(
            "vol2pack brick.h5 stack.tif sample.h5 --voxel-size 3um --pixels-per-seed 4 --filter box "
            "--labels 1=inclusion,2=matrix --objects 1 --min-component 27");
    return usage;
}

void run(const Request& request) {
    const VolumeOptions volume_request = volume_options(request.volume);
    const auto names =
        request.labels.empty() ? std::map<std::int32_t, std::string>{} : parse_label_names("--labels", request.labels);
    SampleOptions options;
    if (!request.objects.empty()) options.object_labels = parse_labels("--objects", request.objects);
    if (request.filter == "nearest" && cli::given("--box-size")) throw WrongUsage("--box-size belongs to --filter box");

    const Packing brick = read_packing(request.brick);
    LabelVolume volume = read_label_volume(request.volume.path, volume_request);
    const auto image = volume.histogram();
    check_labels(image, names, options.object_labels);
    if (request.min_component > 0) {
        std::vector<std::int32_t> solid;
        for (const auto& [label, voxels] : image)
            if (label != 0) solid.push_back(label);
        cli::report("small_components_removed", remove_small_components(volume, solid, request.min_component));
    }

    options.seed_radius = request.pixels_per_seed * volume.spacing()[0];
    options.filter.kind = request.filter == "box" ? Filter::box : Filter::nearest;
    options.filter.box_size = request.box_size * 2 * options.seed_radius;
    options.random_seed = static_cast<std::uint64_t>(request.random_seed);
    options.max_particles = request.max_particles;
    options.threads = cli::threads();
    const Sample sample = sample_volume(volume, brick, options);

    cli::report("particles", static_cast<std::int64_t>(sample.packing.size()));
    cli::report("seed_radius", sample.packing.seed_radius, "mm");
    const auto phases = compare_phases(image, volume.histogram(), sample, names);
    report_phases(phases);
    if (!options.object_labels.empty()) report_objects(sample);
    check_phases(phases);
    write_packing(sample.packing, request.sample, cli::provenance());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
