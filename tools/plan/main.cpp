// plan: resolution, law and time step for a wanted error, or the options of the chain for a wanted number of particles.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/plan/proposal.hpp"
#include "tools/plan/sample_plan.hpp"
#include "tools/plan/text_file.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::plan;

struct Request {
    VolumeRequest volume;
    std::filesystem::path scene, proposed, table, script;
    double error = 0;
    std::string of, law = "any", feature = "median", objects = "auto";
    // For a given size of the particles.
    double particles = 0, pixels_per_seed = 0, density = 0;
    std::string labels, options, write = "all";
};

cli::Usage usage(Request& request) {
    cli::Usage usage("plan",
                     "Propose the resolution, law and time step of a simulation, and predict its error, time and "
                     "memory; or, for a given size of the particles, write the scene and the options of the other "
                     "tools.");
    add_volume(usage, request.volume)
        .step(cli::Step::plan)
        .optional_output("PROPOSED", request.proposed,
                         "Scene to write, with the law and the time step proposed; the default is NAME.proposed.toml "
                         "beside the scene NAME.toml.",
                         {".toml"})
        .option("--error", request.error, cli::Unit::percent, cli::positive,
                "Wanted error, kept in 19 of 20 runs by each quantity of --of; the cheapest resolution, law and time "
                "step that keep it are proposed.")
        .option("--particles", request.particles, cli::Unit::particles, cli::positive,
                "Instead of --error, choose the size of the particles for about this number of them.")
        .option("--pixels-per-seed", request.pixels_per_seed, cli::Unit::voxels, cli::positive,
                "Instead of --error, give the particles this radius.")
        .input_option("--scene", request.scene,
                      "Scene (.toml): what the sample is made of and how it is loaded. --error needs it; without it, "
                      "the other two propose one from the labels of the image.")
        .option("--of", request.of,
                "Quantities that --error is about, separated by commas: flow_stress, composite_stress, shape_factor, "
                "pore_volume, foam_stress. The default is all that the image and the scene have.")
        .choice("--objects", request.objects, {"auto", "components", "watershed", "labels"},
                "How the objects of the phase with objects = true are told apart: by its connected components, by a "
                "watershed that separates touching ones, or by the labels of the image, which has one for each; auto "
                "takes labels where the image has more than 16 that look like objects, else components.")
        .choice("--law", request.law, {"any", "bilin", "trilin", "norton"}, "Law that --error may propose.")
        .choice("--feature", request.feature, {"median", "smallest"},
                "Object, pore or strut that --error resolves; the median is that by volume.")
        .input_option("--table", request.table,
                      "Table by which --error predicts error, time and memory (.toml, from trade_table). The default "
                      "is the table that tomodem ships.")
        .output_option("--script", request.script,
                       "Also write the commands of the proposal, from the packing to the run, as a shell script.",
                       {".sh"})
        .option("--labels", request.labels,
                "With --particles or --pixels-per-seed: names of the labels, as 1=matrix,2=inclusion. The default is "
                "the names of the scene.")
        .option("--density", request.density, cli::Unit::none, {0, 1, false, true},
                "With --particles or --pixels-per-seed: density D of the brick that the sample will be cut from. The "
                "default is that of the scene's law, as of packgen --law.")
        .option("--options", request.options,
                "With --particles or --pixels-per-seed: also write into this folder one file for each tool of the "
                "chain with the options that depend on the image or on the load.")
        .choice("--write", request.write, {"all", "sample", "load"},
                "With --particles or --pixels-per-seed: write all files; those that the sample is made with; or the "
                "scene and those that follow from its load, for which --scene alone is read.")
        .exclusive({"--error", "--particles", "--pixels-per-seed"})
        .example("plan stack/ --scene scene.toml --error 5% --voxel-size 2.4um")
        .example("plan casting.tif proposed.toml --scene casting.toml --error 10% --of pore_volume")
        .example("plan stack/ scene.toml --particles 40000 --voxel-size 2.4um")
        .example("plan sand.tif --scene sand.toml --error 10% --objects watershed --voxel-size 5um");
    return usage;
}

std::vector<Quantity> quantities_asked(const std::string& text) {
    std::vector<Quantity> found;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const auto* const one =
            std::find_if(quantities.begin(), quantities.end(), [&](Quantity known) { return part == name_of(known); });
        if (one == quantities.end())
            throw WrongUsage(
                fmt::format("--of '{}': '{}' is none of flow_stress, composite_stress, shape_factor, "
                            "pore_volume, foam_stress",
                            text, part));
        found.push_back(*one);
    }
    return found;
}

std::string shell_quoted(const std::string& text) {
    if (!text.empty() &&
        text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=,:") ==
            std::string::npos)
        return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

/// The options of the image as they were given.
std::string image_options(const VolumeRequest& volume, cli::Tool& tool) {
    std::string text;
    const auto add = [&](const std::string& flag, const std::string& value) {
        if (tool.given(flag)) text += " " + flag + " " + shell_quoted(value);
    };
    add("--voxel-size", fmt::format("{:g}mm", volume.voxel_size));
    if (tool.given("--override-voxel-size")) text += " --override-voxel-size";
    add("--slice-spacing", fmt::format("{:g}mm", volume.slice_spacing));
    add("--origin", volume.origin);
    add("--roi", volume.roi);
    add("--bin", volume.bin);
    add("--threshold", volume.threshold);
    add("--otsu", std::to_string(volume.otsu));
    add("--raw-size", volume.raw_size);
    add("--raw-type", volume.raw_type);
    add("--raw-byte-order", volume.raw_byte_order);
    add("--raw-offset", std::to_string(volume.raw_offset));
    return text;
}

void report_features(const ImageFeatures& image, cli::Tool& tool) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const Feature& one : image.features) {
        const char* const kind = one.kind == Feature::Kind::objects ? "objects"
                                 : one.kind == Feature::Kind::pores ? "pores"
                                                                    : "struts";
        tool.report(one.kind == Feature::Kind::objects ? fmt::format("objects_of_{}", one.of) : kind,
                    fmt::format("{}median diameter {:.4g} mm ({:.3g} voxels), smallest {:.4g} mm",
                                one.kind == Feature::Kind::struts ? ""
                                : one.count == 0                  ? "still to be separated, "
                                                                  : fmt::format("{} of them, ", one.count),
                                one.median, one.median / image.voxel, one.smallest));
        rows.push_back(
            {{"kind", kind}, {"of", one.of}, {"count", one.count}, {"median", one.median}, {"smallest", one.smallest}});
    }
    tool.report_json("features", rows);
}

void report_proposal(const Proposal& found, const ImageFeatures& image, cli::Tool& tool) {
    tool.report("law", found.choice.law);
    if (find_law(found.choice.law)->traits().quasi_static) tool.report("scheme", "quasi_static");
    tool.report("strain_per_step", found.choice.step);
    tool.report("pixels_per_seed", found.seed_radius / image.voxel, "voxels");
    tool.report("seed_radius", found.seed_radius, "mm");
    tool.report("particles", static_cast<std::int64_t>(std::llround(found.particles)));
    tool.report("time_step", found.time_step, "s");
    tool.report("steps", found.steps);
    if (found.evaluations > 0) tool.report("evaluations", found.evaluations);
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const PredictedError& one : found.errors) {
        const ErrorParts& parts = one.parts;
        tool.report(
            fmt::format("predicted_error_{}", name_of(one.quantity)),
            fmt::format("{:.2g} % (resolution {:.2g}, time step {:.2g}, packings {:.2g}, rates {:.2g}) at {:.3g} "
                        "particles{}",
                        100 * parts.total(), 100 * parts.resolution, 100 * parts.time_step, 100 * parts.packings,
                        100 * parts.rates, one.resolution, one.quantity == Quantity::flow_stress ? "" : " across"));
        rows.push_back({{"quantity", name_of(one.quantity)},
                        {"error", parts.total()},
                        {"resolution", one.resolution},
                        {"error_resolution", parts.resolution},
                        {"error_time_step", parts.time_step},
                        {"error_packings", parts.packings},
                        {"error_rates", parts.rates}});
    }
    tool.report_json("predicted_errors", rows);
    tool.report("predicted_error", 100 * found.error(), "%");
    tool.report("predicted_prepare_cpu_seconds", found.prepare_seconds, "s");
    tool.report("predicted_cpu_seconds", found.cpu_seconds, "s");
    tool.report("predicted_peak_bytes", static_cast<std::int64_t>(found.bytes), "B");
}

/// What is said of the objects whatever the size of the particles.
void note_objects(const ImageFeatures& image, ObjectsBy by, cli::Tool& tool) {
    for (const Feature& one : image.features) {
        if (one.kind != Feature::Kind::objects) continue;
        if (by == ObjectsBy::watershed)
            tool.note(
                fmt::format("the objects of {} are still to be separated: their size is taken from the thickness of "
                            "the phase at places spread over its surface",
                            one.of));
        if (one.tangled)
            tool.note(
                fmt::format("one connected part holds {:.0f} % of {} and is no compact body, so its thickness is taken "
                            "for its size; "
                            "if it is made of objects that touch (grains, fibres), they would count as one, and "
                            "--objects watershed "
                            "separates them",
                            100 * one.largest_share, one.of));
    }
}

/// Pores of the image as carve would take them with particles of this size.
struct PoreCount {
    std::int64_t closed = 0, cut = 0, open = 0, too_small = 0;
    bool carvable() const { return closed + cut > 0; }
};

PoreCount count_pores(const ImageFeatures& image, double seed_radius) {
    PoreCount count;
    for (const VoidPart& part : image.voids) switch (kind_of(part, seed_radius)) {
            case PoreKind::closed:
                ++count.closed;
                break;
            case PoreKind::cut:
                ++count.cut;
                break;
            case PoreKind::open:
                ++count.open;
                break;
            case PoreKind::too_small:
                ++count.too_small;
        }
    return count;
}

void note_stress(const ImageFeatures& image, const Scene& scene, double seed_radius, double density,
                 const TradeTable& table, cli::Tool& tool) {
    for (const CoarseStress& one : coarse_stresses(image, scene, seed_radius, density, table))
        tool.note(fmt::format(
            "the stress of this sample would be unreliable: {}, {:.3g} are the fewest that were measured; {:.0f} "
            "particles (--pixels-per-seed {:.3g}) would do{}",
            one.quantity == Quantity::foam_stress
                ? fmt::format("its struts are {:.2g} particles across", one.resolution)
            : one.quantity == Quantity::composite_stress
                ? fmt::format("its objects are {:.2g} particles across", one.resolution)
                : fmt::format("it has {:.0f} particles", one.resolution),
            one.needed, one.particles, one.seed_radius / image.voxel,
            one.cpu_seconds > 0 ? fmt::format(", for about {:.2g} s of CPU time", one.cpu_seconds) : ""));
}

/// Notes what the errors of the table, or carve, do not hold for.
void note_limits(const Plan& plan, const ImageFeatures& image, const Scene& scene, bool carved, cli::Tool& tool) {
    for (const std::string& why : plan.left_out) tool.note(why);
    const PoreCount pores = count_pores(image, plan.proposal.seed_radius);
    if (carved && pores.cut > 0)
        tool.note(
            fmt::format("{} of {} pores that carve takes out meet a face of the image or come within two "
                        "particles of one; the errors are those of pores inside",
                        pores.cut, pores.cut + pores.closed));
    if (!carved && std::find(plan.of.begin(), plan.of.end(), Quantity::pore_volume) != plan.of.end())
        tool.note(fmt::format(
            "the pores are not carved ({}): relaxation changes their volume by some per cent "
            "(docs/relaxation.md), which the predicted error does not include",
            not_carved(image, scene)
                .value_or("each passes through the image, or nearly so, or is less than 4 particles across")));
    // Of the scenes of pipelines/trade.
    constexpr double deepest = 0.36;
    for (const LoadStep& step : scene.steps)
        if (step.strain > 0 || step.strain < -deepest || &step != &scene.steps.front()) {
            tool.note(
                "the errors are those of samples pressed once to a strain of -0.2 (pores) or -0.3; this load is "
                "another one");
            return;
        }
}

/// The user's --relabel with everything that it makes void, and void itself, made a label.
std::string filled(const std::string& relabel, std::int32_t label) {
    std::map<std::int32_t, std::int32_t> labels;
    if (!relabel.empty()) labels = parse_relabel("--relabel", relabel);
    labels.try_emplace(0, 0);
    std::vector<std::string> texts;
    for (const auto& [from, to] : labels) texts.push_back(fmt::format("{}={}", from, to == 0 ? label : to));
    return fmt::format("{}", fmt::join(texts, ","));
}

std::string with_relabel(const std::string& text) {
    return text.empty() ? std::string{} : " --relabel " + shell_quoted(text);
}

std::string packgen_command(double particles, double density) {
    constexpr double max_of_brick = 20000;
    return fmt::format("packgen brick.h5 --particles {:.0f} --density {:g}",
                       std::clamp(particles, 1000.0, max_of_brick), density);
}

/// The image as vol2pack reads it, and the command that makes it; a watershed writes a new one.
struct ImageForSample {
    std::string arguments;              ///< file and options
    std::vector<std::string> commands;  ///< before
};

ImageForSample image_for_sample(const VolumeRequest& volume, const std::string& relabel, ObjectsBy by,
                                const std::vector<LabelObjects>& ranges, cli::Tool& tool) {
    const std::string stack = shell_quoted(volume.path), options = image_options(volume, tool) + with_relabel(relabel);
    if (by != ObjectsBy::watershed) return {stack + " sample.h5" + options, {}};
    return {"objects.tif sample.h5",
            {fmt::format("separate_objects {} objects.tif{} --labels {}", stack, options, ranges.front().species)}};
}

/// The commands that make the proposed run.
/// @param carved  pores are filled and taken out again, so that they keep their volume
std::vector<std::string> commands(const Request& request, const Proposal& found, const ImageFeatures& image,
                                  const Scene& scene, bool carved, ObjectsBy by,
                                  const std::vector<LabelObjects>& ranges, cli::Tool& tool) {
    const std::string& relabel = request.volume.relabel;
    const std::string proposed = shell_quoted(request.proposed.string());
    std::vector<std::int32_t> objects;
    for (const Phase& phase : scene.phases)
        if (phase.objects) objects.push_back(phase.label);
    const std::string told_apart = vol2pack_options(by, objects, ranges);
    const ImageForSample made =
        image_for_sample(request.volume, carved ? filled(relabel, image.labels.front()) : relabel, by, ranges, tool);
    std::vector<std::string> lines{packgen_command(found.particles, found.density)};
    lines.insert(lines.end(), made.commands.begin(), made.commands.end());
    lines.push_back(fmt::format("vol2pack brick.h5 {} --pixels-per-seed {:.4g}{}{}", made.arguments,
                                found.seed_radius / image.voxel, told_apart.empty() ? "" : " ", told_apart));
    lines.push_back(carved ? fmt::format("carve sample.h5 {} {} relaxed.h5{}{}", proposed,
                                         shell_quoted(request.volume.path), image_options(request.volume, tool),
                                         with_relabel(relabel))
                           : fmt::format("relax sample.h5 {} relaxed.h5", proposed));
    lines.push_back(fmt::format("solve relaxed.h5 {} run.h5", proposed));
    return lines;
}

void give_commands(const std::vector<std::string>& lines, const Request& request, cli::Tool& tool) {
    for (const std::string& line : lines) tool.report("command_" + line.substr(0, line.find(' ')), line);
    if (!request.script.empty()) write_text(request.script, fmt::format("set -eu\n{}\n", fmt::join(lines, "\n")));
}

/// D of a brick for a scene, given or to be proposed.
double density_for(const std::optional<Scene>& scene) {
    return (scene ? scene->law() : proposed_law()).traits().packing_density;
}

/// --objects, looked at with the image.
ObjectsBy objects_of(const Request& request, const LabelVolume& volume, cli::Tool& tool) {
    if (request.objects == "watershed") return ObjectsBy::watershed;
    if (request.objects == "labels") return ObjectsBy::labels;
    if (request.objects == "components" || volume.histogram().size() <= most_phases || !looks_labelled(volume))
        return ObjectsBy::components;
    tool.note(fmt::format("the image has {} labels: each is taken as an object of its own (--objects labels)",
                          volume.histogram().size()));
    return ObjectsBy::labels;
}

std::vector<std::int32_t> labels_of(const Scene& scene, std::int32_t without) {
    std::vector<std::int32_t> labels;
    for (const Phase& phase : scene.phases)
        if (phase.label != without) labels.push_back(phase.label);
    return labels;
}

/// For a wanted error: searches the table for the cheapest setting.
void plan_for_error(const Request& given, cli::Tool& tool) {
    Request request = given;
    for (const char* flag : {"--labels", "--density", "--options", "--write"})
        if (tool.given(flag))
            throw WrongUsage(fmt::format("{} goes with --particles or --pixels-per-seed, not with --error", flag));
    if (!tool.given("--scene")) throw WrongUsage("give the --scene");
    if (request.proposed.empty())
        request.proposed = std::filesystem::path(request.scene).replace_extension("proposed.toml");
    PlanRequest wanted;
    wanted.of = quantities_asked(request.of);
    wanted.scene_text = read_text(request.scene);
    wanted.scene_name = request.scene.string();
    wanted.error = request.error / 100;
    wanted.smallest = request.feature == "smallest";
    if (request.law != "any") wanted.law = request.law;
    const Scene scene = readable_scene(wanted.scene_text, wanted.scene_name);
    const TradeTable table =
        request.table.empty() ? shipped_trade() : parse_trade(read_text(request.table), request.table.string());

    LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const ObjectsBy by = objects_of(request, volume, tool);
    std::optional<LabelledObjects> labelled;
    std::vector<LabelObjects> ranges;
    if (by == ObjectsBy::labels) {
        const std::int32_t phase = phase_of_objects(scene);
        labelled = take_labels(volume, phase, labels_of(scene, phase));
        ranges = labelled->ranges;
    } else if (by == ObjectsBy::watershed) {
        const std::int32_t phase = phase_of_objects(scene);
        ranges = {separated_range(labels_of(scene, phase), phase)};
    }
    const ImageFeatures image = find_features(volume, scene, tool.threads(), by, labelled ? &*labelled : nullptr);
    report_features(image, tool);
    note_objects(image, by, tool);
    const Plan plan = make_plan(image, wanted, table);
    // Files that the scene names are looked for beside it: also beside the new one?
    parse_scene(plan.proposal.scene, request.proposed.string());

    const bool carved = std::find(plan.of.begin(), plan.of.end(), Quantity::pore_volume) != plan.of.end() &&
                        !not_carved(image, scene) && count_pores(image, plan.proposal.seed_radius).carvable();
    report_proposal(plan.proposal, image, tool);
    note_limits(plan, image, scene, carved, tool);
    note_stress(image, parse_scene(plan.proposal.scene, wanted.scene_name), plan.proposal.seed_radius,
                plan.proposal.density, table, tool);
    for (const auto& [law, why] : plan.not_taken) tool.note(fmt::format("not law \"{}\": {}", law, why));
    for (const Proposal& other : plan.other_laws)
        tool.note(fmt::format("law \"{}\" would take {:.0f} particles and {:.3g} s", other.choice.law, other.particles,
                              other.cpu_seconds + other.prepare_seconds));
    for (const ExpectedFlow& flow : plan.proposal.flows)
        if (!flow.outside.empty())
            tool.note(fmt::format("[phase.{}] would be outside its calibration: {}", flow.phase,
                                  fmt::join(flow.outside, "; ")));
    give_commands(commands(request, plan.proposal, image, scene, carved, by, ranges, tool), request, tool);
    tool.report("table", fmt::format("{}; seconds are those of {}", table.name, table.processor));
    write_text(request.proposed, plan.proposal.scene);
}

void write_options(const std::map<std::string, std::string>& options, const std::filesystem::path& folder) {
    if (folder.empty()) return;
    std::filesystem::create_directories(folder);
    for (const auto& [name, line] : options) write_text(folder / name, line + "\n");
}

void write_load(const LoadPlan& load, const Request& request) {
    write_options(load_options(load), request.options);
    write_text(request.proposed, load.scene);
}

/// Objects with labels of their own that would have no shape.
void note_small_objects(const SamplePlan& plan, const std::vector<std::int64_t>& voxels, cli::Tool& tool) {
    const double voxels_of_sample = std::reduce(voxels.begin(), voxels.end(), 0.0);
    const auto small = std::count_if(voxels.begin(), voxels.end(), [&](std::int64_t object) {
        return static_cast<double>(object) / voxels_of_sample * plan.particles < min_particles_of_shape;
    });
    if (small > 0)
        tool.note(
            fmt::format("{} of {} objects would have fewer than {} particles, too few to have a shape; give more "
                        "--particles, or join small ones (separate_objects --min-voxels)",
                        small, voxels.size(), min_particles_of_shape));
}

/// For a given size of the particles: the scene and the options of the chain.
void plan_for_size(const Request& given, cli::Tool& tool) {
    Request request = given;
    for (const char* flag : {"--of", "--law", "--feature", "--table"})
        if (tool.given(flag)) throw WrongUsage(fmt::format("{} goes with --error", flag));
    if (request.proposed.empty()) {
        if (!tool.given("--scene")) throw WrongUsage("give PROPOSED, the scene to write, or --scene");
        request.proposed = std::filesystem::path(request.scene).replace_extension("proposed.toml");
    }
    std::optional<Scene> scene;
    std::string scene_text;
    if (tool.given("--scene")) {
        scene = read_scene(request.scene);
        scene_text = read_text(request.scene);
    }
    if (scene && request.write == "load") {
        write_load(load_of(*scene, scene_text), request);
        return;
    }
    SampleRequest wanted;
    if (tool.given("--particles")) wanted.particles = request.particles;
    if (tool.given("--pixels-per-seed")) wanted.pixels_per_seed = request.pixels_per_seed;
    wanted.density = tool.given("--density") ? request.density : density_for(scene);
    if (tool.given("--labels")) wanted.names = parse_label_names("--labels", request.labels);

    LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    wanted.by = objects_of(request, volume, tool);
    std::optional<LabelledObjects> labelled;
    if (wanted.by == ObjectsBy::labels) {
        const std::int32_t phase = scene ? phase_of_objects(*scene) : 1;
        labelled = take_labels(volume, phase, scene ? labels_of(*scene, phase) : std::vector<std::int32_t>{});
        wanted.ranges = labelled->ranges;
    }
    const LabelledObjects* const objects = labelled ? &*labelled : nullptr;
    const SamplePlan plan = plan_sample(volume, solid_labels(volume, objects), wanted, scene, scene_text);
    const std::map<std::string, std::string> options = sample_options(plan);
    tool.report("pixels_per_seed", plan.pixels_per_seed, "voxels");
    tool.report("seed_radius", plan.seed_radius, "mm");
    tool.report("particles", static_cast<std::int64_t>(std::llround(plan.particles)));
    if (plan.min_component > 0) tool.report("min_component", plan.min_component, "voxels");
    note_small_objects(plan, labelled ? labelled->voxels : std::vector<std::int64_t>{}, tool);
    tool.report("probe_radius", plan.probe_radius, "mm");
    const Scene made = parse_scene(plan.load.scene, request.proposed.string());
    const ImageFeatures image = find_features(volume, made, tool.threads(), plan.by, objects);
    report_features(image, tool);
    note_objects(image, plan.by, tool);
    note_stress(image, made, plan.seed_radius, wanted.density, shipped_trade(), tool);
    if (const PoreCount pores = count_pores(image, plan.seed_radius);
        pores.carvable() && pores.open == 0 && !not_carved(image, made))
        tool.note(
            fmt::format("{} pores would change their volume by some per cent as the sample relaxes; carve keeps it "
                        "(docs/relaxation.md), and --error proposes it",
                        pores.closed + pores.cut));
    const ImageForSample sample = image_for_sample(request.volume, request.volume.relabel, plan.by, plan.ranges, tool);
    std::vector<std::string> lines{packgen_command(plan.particles, wanted.density)};
    lines.insert(lines.end(), sample.commands.begin(), sample.commands.end());
    lines.push_back(fmt::format("vol2pack brick.h5 {} {}", sample.arguments, options.at("vol2pack")));
    lines.push_back(fmt::format("relax sample.h5 {} relaxed.h5", shell_quoted(request.proposed.string())));
    lines.push_back(fmt::format("solve relaxed.h5 {} run.h5", shell_quoted(request.proposed.string())));
    give_commands(lines, request, tool);
    tool.report_json("options", options);
    if (request.write != "load") write_options(options, request.options);
    if (request.write != "sample") write_load(plan.load, request);
}

void run(const Request& request, cli::Tool& tool) {
    if (tool.given("--error"))
        plan_for_error(request, tool);
    else if (tool.given("--particles") || tool.given("--pixels-per-seed"))
        plan_for_size(request, tool);
    else
        throw WrongUsage("give --error, --particles or --pixels-per-seed");
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
