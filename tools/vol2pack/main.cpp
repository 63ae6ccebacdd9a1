// vol2pack: fill a segmented tomography with labelled particles.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/packing/packing_file.hpp"
#include "core/volume/volume_files.hpp"
#include "tools/vol2pack/geometric_error.hpp"
#include "tools/vol2pack/phase_report.hpp"
#include "tools/vol2pack/resolution.hpp"
#include "tools/vol2pack/sample.hpp"
#include "tools/vol2pack/stage_clock.hpp"

namespace tomodem::vol2pack {
namespace {

struct Request {
    std::filesystem::path brick, sample;
    VolumeRequest volume;
    double pixels_per_seed = 0.0, max_error = 0.0;
    std::string filter = "level-set";
    double box_size = LabelFilter{}.box_size, smoothing = LabelFilter{}.smoothing;
    std::string labels, objects, label_objects;
    std::string connectivity = "6", property;
    bool skip_components = false;
    std::int64_t min_component = 0;
    std::int64_t random_seed = 0;
    std::int64_t max_particles = 50'000'000;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("vol2pack",
                     "Fill a segmented tomography with a periodic packing; each particle gets the label at its place.");
    usage.input("BRICK", request.brick, "Periodic packing (.h5, from packgen); it is repeated to cover the image.");
    add_volume(usage, request.volume)
        .output("SAMPLE", request.sample, "Sample to write.", {".h5"})
        .option("--pixels-per-seed", request.pixels_per_seed, cli::Unit::voxels, cli::positive,
                "Radius of a particle's seed, in voxel edges along x; a smaller one gives more particles.")
        .option(
            "--max-error", request.max_error, cli::Unit::percent, cli::positive,
            "Choose the coarsest resolution at which the volume of every label, void included, has at most this error.")
        .exclusive({"--pixels-per-seed", "--max-error"})
        .choice(
            "--filter", request.filter, {"level-set", "nearest", "box"},
            "How a particle gets its label: by the side of a smoothed interface that its centre is on, by the voxel at "
            "its centre, or by the label that fills most of a box around it.")
        .option("--smoothing", request.smoothing, cli::Unit::voxels, {0.2, 8, true, true},
                "Width of the smoothing of --filter level-set.")
        .option("--box-size", request.box_size, cli::Unit::none, cli::positive,
                "Edge of the box of --filter box, in seed diameters.")
        .option("--labels", request.labels,
                "Names of the labels, as 1=matrix,2=inclusion; if given, every label of the image needs one.")
        .option("--objects", request.objects,
                "Labels whose connected components become separate objects, as 2,3, or all; without it, none.")
        .option("--label-objects", request.label_objects,
                "Make each of these labels of the image one object, as separate_objects prints them; 2:500=1 makes "
                "those of the "
                "labels 2 to 500 that occur objects of label 1 in the sample.")
        .choice("--connectivity", request.connectivity, {"6", "18", "26"},
                "Neighbours of a voxel: those that share a face with it, an edge too, or a corner too.")
        .option("--min-component", request.min_component, cli::Unit::voxels, cli::not_negative,
                "Give connected components smaller than this the label around them; void is left as it is.")
        .flag("--skip-components", request.skip_components,
              "Do not count the components that the sample loses or merges; saves time and memory with large images.")
        .option("--property", request.property,
                "Other volumes of the same size, stored as properties of the particles, as "
                "temperature=t.tif,damage=d.h5:/d.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Shift and rotate the brick at random, to get different samples of one image; 0 leaves it as it is.")
        .option("--max-particles", request.max_particles, cli::Unit::particles, cli::positive,
                "Fail if the sample would have more particles than this.")
        .example("vol2pack brick.h5 stack/ sample.h5 --voxel-size 2.4um --pixels-per-seed 2")
        .example(
            "vol2pack brick.h5 stack/ sample.h5 --voxel-size 2.4um --max-error 2% --labels 1=strut --random-seed 3")
        .example(
            "vol2pack brick.h5 stack.tif sample.h5 --voxel-size 3um --pixels-per-seed 4 "
            "--labels 1=inclusion,2=matrix --objects 1 --connectivity 26 --min-component 27")
        .step(cli::Step::sample);
    return usage;
}

LabelFilter filter_of(const Request& request, cli::Tool& tool) {
    for (const auto& [flag, filter] : {std::pair{"--box-size", "box"}, {"--smoothing", "level-set"}})
        if (tool.given(flag) && request.filter != filter)
            throw WrongUsage(fmt::format("{} belongs to --filter {}", flag, filter));
    const Filter kind = request.filter == "box"       ? Filter::box
                        : request.filter == "nearest" ? Filter::nearest
                                                      : Filter::level_set;
    return {kind, request.box_size, request.smoothing};
}

std::vector<std::int32_t> labels_with_objects(const Request& request, const Histogram& image) {
    if (request.objects != "all")
        return request.objects.empty() ? std::vector<std::int32_t>{} : parse_labels("--objects", request.objects);
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : image)
        if (label != 0) labels.push_back(label);
    return labels;
}

void remove_small(LabelVolume& volume, const Request& request, cli::Tool& tool) {
    if (request.min_component == 0) return;
    constexpr double much = 0.02;
    std::vector<std::int32_t> solid;
    double before = 0, after = 0;
    for (const auto& [label, voxels] : volume.histogram())
        if (label != 0) {
            solid.push_back(label);
            before += static_cast<double>(voxels);
        }
    tool.report("small_components_removed", remove_small_components(volume, solid, request.min_component,
                                                                    connectivity_of(request.connectivity), tool));
    for (const auto& [label, voxels] : volume.histogram())
        if (label != 0) after += static_cast<double>(voxels);
    if (const double removed = 1 - after / before; removed > much)
        tool.warn(
            fmt::format("--min-component {} takes {:.2g} % of the solid out of the image; give a smaller one, and "
                        "fewer --pixels-per-seed, to keep it",
                        request.min_component, 100 * removed));
}

/// Objects that touch are one object, which is rarely wanted.
void warn_of_merged_objects(const Regions& regions, const std::vector<std::int32_t>& object_labels, cli::Tool& tool) {
    constexpr double most = 0.9;
    for (const std::int32_t label : object_labels) {
        std::int64_t objects = 0, voxels = 0, largest = 0;
        for (std::size_t i = 0; i < regions.components.voxels.size(); ++i) {
            if (regions.components.label[i] != label || regions.image_label[i] != 0) continue;
            ++objects;
            voxels += regions.components.voxels[i];
            largest = std::max(largest, regions.components.voxels[i]);
        }
        if (objects > 1 && static_cast<double>(largest) > most * static_cast<double>(voxels))
            tool.warn(
                fmt::format("one of the {} objects of label {} holds {:.4g} % of it: objects that touch are one; "
                            "separate_objects gives each a label of its own, for --label-objects",
                            objects, label, 100 * static_cast<double>(largest) / static_cast<double>(voxels)));
    }
}

double seed_radius_of(const Request& request, const LabelVolume& volume, const Packing& brick, cli::Tool& tool) {
    const double pixel = volume.spacing()[0];
    if (tool.given("--pixels-per-seed")) return request.pixels_per_seed * pixel;
    const double max_error = request.max_error / 100;
    const auto steps = choose_resolution(volume, brick,
                                         {.max_error = max_error,
                                          .pixel = pixel,
                                          .filter = filter_of(request, tool),
                                          .random_seed = static_cast<std::uint64_t>(request.random_seed),
                                          .max_particles = request.max_particles,
                                          .threads = tool.threads()},
                                         tool);
    report_resolution(steps, max_error, tool);
    return steps.back().pixels_per_seed * pixel;
}

void run(const Request& request, cli::Tool& tool) {
    if (!tool.given("--pixels-per-seed") && !tool.given("--max-error"))
        throw WrongUsage("give the resolution: --pixels-per-seed, or --max-error");
    const LabelFilter filter = filter_of(request, tool);
    const VolumeOptions volume_request = volume_options(request.volume);
    const auto names =
        request.labels.empty() ? std::map<std::int32_t, std::string>{} : parse_label_names("--labels", request.labels);
    const auto label_objects = request.label_objects.empty()
                                   ? std::vector<LabelObjects>{}
                                   : parse_label_objects("--label-objects", request.label_objects);
    const auto properties = request.property.empty() ? std::map<std::string, std::string>{}
                                                     : parse_properties("--property", request.property);
    for (const auto& [name, file] : properties) open_volume(file);  // a missing file is an error before the work

    StageClock clock;
    const Packing brick = read_packing(request.brick);
    LabelVolume volume = read_volume(request.volume, volume_request, tool);
    clock.done("reading");
    const Histogram image = species_histogram(volume, label_objects);
    const auto object_labels = labels_with_objects(request, image);
    constexpr std::size_t max_labels = 16;
    if (image.size() > max_labels && request.labels.empty() && request.objects.empty() && label_objects.empty())
        throw InvalidInput(
            fmt::format("the image has {} labels: if it is grey give --threshold or --otsu, if its labels are "
                        "grains --label-objects, else name them by --labels",
                        image.size()));
    check_labels(image, names, object_labels);
    remove_small(volume, request, tool);
    const auto regions =
        distinguish_regions(volume, object_labels, label_objects, connectivity_of(request.connectivity),
                            request.skip_components ? Regions::Of::objects : Regions::Of::everything, tool);
    if (regions) warn_of_merged_objects(*regions, object_labels, tool);
    clock.done("components");

    const double seed_radius = seed_radius_of(request, volume, brick, tool);
    clock.done("resolution");
    const Tiling tiling(brick, seed_radius, {volume.origin(), volume.extent(), {false, false, false}},
                        static_cast<std::uint64_t>(request.random_seed), request.max_particles);
    Sample sample = sample_volume(volume, tiling, regions ? &*regions : nullptr, filter, tool.threads(), tool);
    clock.done("sampling");

    for (const auto& [name, file] : properties) {
        sample.packing.property[name] =
            read_values_at(file, request.volume.path, volume_request, sample.packing.position, tool.threads(), tool);
        tool.add_input(file, volume_files(file));
    }
    clock.done("properties");

    tool.report("particles", static_cast<std::int64_t>(sample.packing.size()));
    tool.report("seed_radius", sample.packing.seed_radius, "mm");
    const auto phases = compare_phases(image, volume.histogram(), sample, names);
    report_phases(phases, tool);
    if (!object_labels.empty() || !label_objects.empty()) report_objects(sample, tool);
    check_phases(phases);
    const GeometricError error = geometric_error(
        volume, tiling, sample.places, regions && !request.skip_components ? &*regions : nullptr, tool.threads());
    report_geometric_error(error, tool);
    clock.done("geometric_error");

    Provenance provenance = tool.provenance();
    provenance.geometric_error = error.json().dump();
    sample.packing.label_names = names;
    write_packing(sample.packing, request.sample, provenance);
    clock.done("writing");
    clock.report(tool);
}

}  // namespace
}  // namespace tomodem::vol2pack

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::vol2pack::usage, tomodem::vol2pack::run);
}
