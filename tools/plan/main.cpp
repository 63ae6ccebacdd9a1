// plan: the cheapest resolution, law and time step that keep a wanted error, for an image and a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/plan/proposal.hpp"

namespace {
using namespace tomodem;

struct Request {
    VolumeRequest volume;
    std::filesystem::path scene, proposed, table;
    double error = 0;
    std::string of, law = "any", feature = "median";
};

cli::Usage usage(Request& request) {
    cli::Usage usage(
        "plan",
        "Propose resolution, law and time step for an image and a scene, with predicted error, time and memory.");
    add_volume(usage, request.volume)
        .optional_output("PROPOSED", request.proposed,
                         "the scene with the law and the time step proposed, to write (.toml); default: "
                         "NAME.proposed.toml beside the scene NAME.toml")
        .required("--error", request.error, cli::Unit::percent, cli::positive,
                  "wanted of each quantity: what 19 runs of 20 keep within")
        .input_option("--scene", request.scene, "what the sample is made of and what is done to it (.toml; required)")
        .option("--of", request.of,
                "what must be that right, of flow_stress, composite_stress, shape_factor, pore_volume, foam_stress, "
                "between commas; all that the image and the scene have unless given")
        .choice("--law", request.law, {"any", "bilin", "trilin", "norton"}, "that may be proposed")
        .choice("--feature", request.feature, {"median", "smallest"},
                "object, pore or strut that gets the particles across; the median is of the volume")
        .input_option("--table", request.table, "measured on another machine, or other scenes (.toml: pipelines/trade)")
        .example("plan stack/ --scene scene.toml --error 5% --voxel-size 2.4um")
        .example("plan casting.tif proposed.toml --scene casting.toml --error 10% --of pore_volume");
    return usage;
}

std::string content(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    if (!(text << file.rdbuf())) throw InvalidInput(fmt::format("cannot read '{}'", path.string()));
    return text.str();
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

void tell(const std::vector<Feature>& features, const ImageFeatures& image, cli::Tool& tool) {
    std::string rows;
    for (const Feature& one : features) {
        const char* const kind = one.kind == Feature::Kind::objects ? "objects"
                                 : one.kind == Feature::Kind::pores ? "pores"
                                                                    : "struts";
        tool.report(one.kind == Feature::Kind::objects ? fmt::format("objects_of_{}", one.of) : kind,
                    fmt::format("{}median diameter {:.4g} mm ({:.3g} voxels), smallest {:.4g} mm",
                                one.kind == Feature::Kind::struts ? "" : fmt::format("{} of them, ", one.count),
                                one.median, one.median / image.voxel, one.smallest));
        rows += fmt::format(R"({}{{"kind": "{}", "of": "{}", "count": {}, "median": {}, "smallest": {}}})",
                            rows.empty() ? "" : ", ", kind, one.of, one.count, one.median, one.smallest);
    }
    tool.report_json("features", nlohmann::ordered_json::parse("[" + rows + "]"));
}

void tell(const Proposal& found, const ImageFeatures& image, cli::Tool& tool) {
    tool.report("law", std::string(name_of(found.choice.law)));
    tool.report(found.choice.key(), found.choice.step);
    tool.report("pixels_per_seed", found.seed_radius / image.voxel, "voxels");
    tool.report("seed_radius", found.seed_radius, "mm");
    tool.report("particles", static_cast<std::int64_t>(std::llround(found.particles)));
    tool.report("time_step", found.time_step, "s");
    tool.report("steps", found.steps);
    std::string rows;
    for (const PredictedError& one : found.errors) {
        const ErrorParts& parts = one.parts;
        tool.report(
            fmt::format("predicted_error_{}", name_of(one.quantity)),
            fmt::format("{:.2g} % (resolution {:.2g}, time step {:.2g}, packings {:.2g}, rates {:.2g}) at {:.3g} "
                        "particles{}",
                        100 * parts.total(), 100 * parts.resolution, 100 * parts.time_step, 100 * parts.packings,
                        100 * parts.rates, one.resolution, one.quantity == Quantity::flow_stress ? "" : " across"));
        rows += fmt::format(
            R"({}{{"quantity": "{}", "error": {}, "resolution": {}, "error_resolution": {}, "error_time_step": {}, )"
            R"("error_packings": {}, "error_rates": {}}})",
            rows.empty() ? "" : ", ", name_of(one.quantity), parts.total(), one.resolution, parts.resolution,
            parts.time_step, parts.packings, parts.rates);
    }
    tool.report_json("predicted_errors", nlohmann::ordered_json::parse("[" + rows + "]"));
    tool.report("predicted_error", 100 * found.error(), "%");
    tool.report("predicted_prepare_cpu_seconds", found.prepare_seconds, "s");
    tool.report("predicted_cpu_seconds", found.cpu_seconds, "s");
    tool.report("predicted_peak_bytes", static_cast<std::int64_t>(found.bytes), "B");
}

/// Where the errors of the table, or carve, have their limits.
void tell_what_it_does_not_hold_for(const Plan& plan, const ImageFeatures& image, const Scene& scene, cli::Tool& tool) {
    const double two_particles = 4 * plan.proposal.seed_radius;
    const auto near =
        std::count_if(image.pore_gaps.begin(), image.pore_gaps.end(), [&](double gap) { return gap < two_particles; });
    if (near > 0)
        tool.note(
            fmt::format("{} of {} closed pores come within two particles of a face of the image: carve takes these as "
                        "open, and leaves them as they are; take a larger part of the image, or finer particles",
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

/// What to type next. Objects, pores: what vol2pack and carve need for them.
std::vector<std::string> commands(const Request& request, const Proposal& found, const ImageFeatures& image,
                                  const Scene& scene, cli::Tool& tool) {
    const std::string stack = shell_quoted(request.volume.path), options = image_options(request.volume, tool);
    const std::string relabel = request.volume.relabel, proposed = shell_quoted(request.proposed.string());
    const auto relabelled = [&](const std::string& text) {
        return text.empty() ? std::string{} : " --relabel " + shell_quoted(text);
    };
    std::vector<std::int32_t> objects;
    for (const Phase& phase : scene.phases)
        if (phase.objects) objects.push_back(phase.label);
    // A dense sample is carved: closed pores keep their volume so. With several phases void has no phase to be filled
    // by.
    const bool carved = !image.pore_gaps.empty() && image.labels.size() == 1;
    const std::string filled = fmt::format("{}{}0={}", relabel, relabel.empty() ? "" : ",", image.labels.front());
    constexpr double most_of_a_brick = 20000;
    std::vector<std::string> lines;
    lines.push_back(fmt::format("packgen brick.h5 --particles {:.0f} --density {:g}",
                                std::clamp(found.particles, 1000.0, most_of_a_brick), found.density));
    lines.push_back(fmt::format("vol2pack brick.h5 {} sample.h5{}{} --pixels-per-seed {:.4g}{}", stack, options,
                                relabelled(carved ? filled : relabel), found.seed_radius / image.voxel,
                                objects.empty() ? "" : fmt::format(" --objects {}", fmt::join(objects, ","))));
    lines.push_back(
        carved ? fmt::format("carve sample.h5 {} {} relaxed.h5{}{}", proposed, stack, options, relabelled(relabel))
               : fmt::format("relax sample.h5 {} relaxed.h5", proposed));
    lines.push_back(fmt::format("solve relaxed.h5 {} run.h5", proposed));
    return lines;
}

void run(const Request& given, cli::Tool& tool) {
    Request request = given;
    if (!tool.given("--scene")) throw WrongUsage("give the --scene");
    if (request.proposed.empty())
        request.proposed = std::filesystem::path(request.scene).replace_extension("proposed.toml");
    PlanRequest wanted;
    wanted.of = quantities_asked(request.of);
    wanted.scene_text = content(request.scene);
    wanted.scene_name = request.scene.string();
    wanted.error = request.error / 100;
    wanted.smallest = request.feature == "smallest";
    if (request.law != "any")
        wanted.law = request.law == "bilin" ? Law::bilin : request.law == "trilin" ? Law::trilin : Law::norton;
    const Scene scene = readable_scene(wanted.scene_text, wanted.scene_name);
    const TradeTable table =
        request.table.empty() ? shipped_trade() : parse_trade(content(request.table), request.table.string());

    const LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const ImageFeatures image = find_features(volume, scene, tool.threads());
    tell(image.features, image, tool);
    const Plan plan = make_plan(image, wanted, table);
    // Files that the scene names are looked for beside it: also beside the new one?
    parse_scene(plan.proposal.scene, request.proposed.string());

    tell(plan.proposal, image, tool);
    tell_what_it_does_not_hold_for(plan, image, scene, tool);
    for (const auto& [law, why] : plan.not_taken) tool.note(fmt::format("not law \"{}\": {}", name_of(law), why));
    for (const Proposal& other : plan.other_laws)
        tool.note(fmt::format("law \"{}\" would take {:.0f} particles and {:.3g} s", name_of(other.choice.law),
                              other.particles, other.cpu_seconds + other.prepare_seconds));
    for (const ExpectedFlow& flow : plan.proposal.flows)
        if (!flow.outside.empty())
            tool.note(fmt::format("[phase.{}] would be outside its calibration: {}", flow.phase,
                                  fmt::join(flow.outside, "; ")));
    for (const std::string& line : commands(request, plan.proposal, image, scene, tool))
        tool.report("command_" + line.substr(0, line.find(' ')), line);
    tool.report("table", fmt::format("{}; seconds are those of {}", table.name, table.processor));
    write_text(request.proposed, plan.proposal.scene);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
