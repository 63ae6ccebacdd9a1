// plan: resolution, law and time step for a wanted error, or the options of the chain for a wanted number of particles.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
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
    std::filesystem::path scene, proposed, table;
    double error = 0;
    std::string of, law = "any", feature = "median";
    // For a given size of the particles.
    double particles = 0, pixels_per_seed = 0, density = 0.7;
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
        .choice("--law", request.law, {"any", "bilin", "trilin", "norton"}, "Law that --error may propose.")
        .choice("--feature", request.feature, {"median", "smallest"},
                "Object, pore or strut that --error resolves; the median is that by volume.")
        .input_option("--table", request.table,
                      "Table by which --error predicts error, time and memory (.toml, from trade_table). The default "
                      "is the table that tomodem ships.")
        .option("--labels", request.labels,
                "With --particles or --pixels-per-seed: names of the labels, as 1=matrix,2=inclusion. The default is "
                "the names of the scene.")
        .option("--density", request.density, cli::Unit::none, {0, 1, false, true},
                "With --particles or --pixels-per-seed: density D of the brick that the sample will be cut from.")
        .option("--options", request.options,
                "With --particles or --pixels-per-seed: also write into this folder one file for each tool of the "
                "chain with the options that depend on the image or on the load.")
        .choice("--write", request.write, {"all", "sample", "load"},
                "With --particles or --pixels-per-seed: write all files; those that the sample is made with; or the "
                "scene and those that follow from its load, for which --scene alone is read.")
        .exclusive({"--error", "--particles", "--pixels-per-seed"})
        .example("plan stack/ --scene scene.toml --error 5% --voxel-size 2.4um")
        .example("plan casting.tif proposed.toml --scene casting.toml --error 10% --of pore_volume")
        .example("plan stack/ scene.toml --particles 40000 --voxel-size 2.4um");
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
                                one.kind == Feature::Kind::struts ? "" : fmt::format("{} of them, ", one.count),
                                one.median, one.median / image.voxel, one.smallest));
        rows.push_back(
            {{"kind", kind}, {"of", one.of}, {"count", one.count}, {"median", one.median}, {"smallest", one.smallest}});
    }
    tool.report_json("features", rows);
}

void report_proposal(const Proposal& found, const ImageFeatures& image, cli::Tool& tool) {
    tool.report("law", found.choice.law);
    tool.report(found.choice.key(), found.choice.step);
    tool.report("pixels_per_seed", found.seed_radius / image.voxel, "voxels");
    tool.report("seed_radius", found.seed_radius, "mm");
    tool.report("particles", static_cast<std::int64_t>(std::llround(found.particles)));
    tool.report("time_step", found.time_step, "s");
    tool.report("steps", found.steps);
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

/// Notes what the errors of the table, or carve, do not hold for.
void note_limits(const Plan& plan, const ImageFeatures& image, const Scene& scene, cli::Tool& tool) {
    const double two_particles = 4 * plan.proposal.seed_radius;
    const auto near =
        std::count_if(image.pore_gaps.begin(), image.pore_gaps.end(), [&](double gap) { return gap < two_particles; });
    if (near > 0)
        tool.note(
            fmt::format("{} of {} closed pores come within two particles of a face of the image: carve takes them as "
                        "open and leaves them as they are; take a larger part of the image, or finer particles",
                        near, image.pore_gaps.size()));
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

std::string with_relabel(const std::string& text) {
    return text.empty() ? std::string{} : " --relabel " + shell_quoted(text);
}

std::string packgen_command(double particles, double density) {
    constexpr double max_of_brick = 20000;
    return fmt::format("packgen brick.h5 --particles {:.0f} --density {:g}",
                       std::clamp(particles, 1000.0, max_of_brick), density);
}

/// The commands that make the proposed run. Objects, pores: what vol2pack and carve need for them.
std::vector<std::string> commands(const Request& request, const Proposal& found, const ImageFeatures& image,
                                  const Scene& scene, cli::Tool& tool) {
    const std::string stack = shell_quoted(request.volume.path), options = image_options(request.volume, tool);
    const std::string relabel = request.volume.relabel, proposed = shell_quoted(request.proposed.string());
    std::vector<std::int32_t> objects;
    for (const Phase& phase : scene.phases)
        if (phase.objects) objects.push_back(phase.label);
    // A dense sample is carved: closed pores keep their volume so. With several phases void has no phase to be filled
    // by.
    const bool carved = !image.pore_gaps.empty() && image.labels.size() == 1;
    const std::string filled = fmt::format("{}{}0={}", relabel, relabel.empty() ? "" : ",", image.labels.front());
    return {packgen_command(found.particles, found.density),
            fmt::format("vol2pack brick.h5 {} sample.h5{}{} --pixels-per-seed {:.4g}{}", stack, options,
                        with_relabel(carved ? filled : relabel), found.seed_radius / image.voxel,
                        objects.empty() ? "" : fmt::format(" --objects {}", fmt::join(objects, ","))),
            carved
                ? fmt::format("carve sample.h5 {} {} relaxed.h5{}{}", proposed, stack, options, with_relabel(relabel))
                : fmt::format("relax sample.h5 {} relaxed.h5", proposed),
            fmt::format("solve relaxed.h5 {} run.h5", proposed)};
}

void report_commands(const std::vector<std::string>& lines, cli::Tool& tool) {
    for (const std::string& line : lines) tool.report("command_" + line.substr(0, line.find(' ')), line);
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

    const LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const ImageFeatures image = find_features(volume, scene, tool.threads());
    report_features(image, tool);
    const Plan plan = make_plan(image, wanted, table);
    // Files that the scene names are looked for beside it: also beside the new one?
    parse_scene(plan.proposal.scene, request.proposed.string());

    report_proposal(plan.proposal, image, tool);
    note_limits(plan, image, scene, tool);
    for (const auto& [law, why] : plan.not_taken) tool.note(fmt::format("not law \"{}\": {}", law, why));
    for (const Proposal& other : plan.other_laws)
        tool.note(fmt::format("law \"{}\" would take {:.0f} particles and {:.3g} s", other.choice.law, other.particles,
                              other.cpu_seconds + other.prepare_seconds));
    for (const ExpectedFlow& flow : plan.proposal.flows)
        if (!flow.outside.empty())
            tool.note(fmt::format("[phase.{}] would be outside its calibration: {}", flow.phase,
                                  fmt::join(flow.outside, "; ")));
    report_commands(commands(request, plan.proposal, image, scene, tool), tool);
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

/// For a given size of the particles: the scene and the options of the chain.
void plan_for_size(const Request& request, cli::Tool& tool) {
    for (const char* flag : {"--of", "--law", "--feature", "--table"})
        if (tool.given(flag)) throw WrongUsage(fmt::format("{} goes with --error", flag));
    if (request.proposed.empty())
        throw WrongUsage("give PROPOSED, the scene to write; with --scene it is a copy of it");
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
    wanted.density = request.density;
    if (tool.given("--labels")) wanted.names = parse_label_names("--labels", request.labels);

    const LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const SamplePlan plan = plan_sample(volume, solid_labels(volume), wanted, scene, scene_text);
    const std::map<std::string, std::string> options = sample_options(plan);
    tool.report("pixels_per_seed", plan.pixels_per_seed, "voxels");
    tool.report("seed_radius", plan.seed_radius, "mm");
    tool.report("particles", static_cast<std::int64_t>(std::llround(plan.particles)));
    tool.report("min_component", plan.min_component, "voxels");
    tool.report("probe_radius", plan.probe_radius, "mm");
    report_commands(
        {packgen_command(plan.particles, request.density),
         fmt::format("vol2pack brick.h5 {} sample.h5{}{} {}", shell_quoted(request.volume.path),
                     image_options(request.volume, tool), with_relabel(request.volume.relabel), options.at("vol2pack")),
         fmt::format("relax sample.h5 {} relaxed.h5", shell_quoted(request.proposed.string())),
         fmt::format("solve relaxed.h5 {} run.h5", shell_quoted(request.proposed.string()))},
        tool);
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
