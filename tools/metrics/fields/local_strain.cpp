// local_strain: how the surroundings of each particle deformed since a reference frame.
#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "tools/metrics/fields/field_radius.hpp"
#include "tools/metrics/fields/local_strain_fit.hpp"
#include "tools/metrics/fields/run_frames.hpp"
#include "tools/metrics/fields/summary.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, fields, table;
    std::string frames = "all", reference = "0";
    double radius = 0.0;  // mm; 0: three seed radii
    bool within_phase = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{
        "local_strain",
        "Local strain of each particle, from the motion of its neighbours since a reference frame, and its "
        "non-affine part."}
        .input("RUN", request.run, "Run (.h5) to measure.")
        .output("FIELDS", request.fields, "Strain of each particle, to write; beside it a .xdmf for ParaView.", {".h5"})
        .option("--radius", request.radius, cli::Unit::length, cli::positive,
                "Take as neighbours the particles within this distance in the reference; the default is three seed "
                "radii.")
        .option("--reference", request.reference,
                "Measure the strain from this frame, counted from 0; previous measures each from the frame before it.")
        .flag("--within-phase", request.within_phase, "Take only neighbours of the particle's own phase.")
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .output_option("--table", request.table,
                       "Also write the means over all particles and over each phase, with rows for each frame.",
                       {".csv"})
        .step(cli::Step::measure)
        .threads()
        .example("local_strain run.h5 strain.h5 --table strain.csv")
        .example("local_strain run.h5 increments.h5 --reference previous");
}

/// The fixed reference frame; none for `previous`.
std::optional<std::size_t> reference_frame(const std::string& text, std::size_t frame_count) {
    if (text == "previous") return std::nullopt;
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc{} || end != text.data() + text.size())
        throw WrongUsage(fmt::format("--reference '{}': give a number from 0, or previous", text));
    if (index >= frame_count)
        throw InvalidInput(fmt::format("--reference {}: the file has frames 0 to {}", index, frame_count - 1));
    return index;
}

std::vector<double> flattened(const std::vector<Symmetric>& tensors) {
    std::vector<double> values;
    values.reserve(6 * tensors.size());
    for (const Symmetric& tensor : tensors) values.insert(values.end(), tensor.begin(), tensor.end());
    return values;
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, frames.run().frame_count());
    const RunReader& run = frames.run();
    const Packing& packing = frames.packing();
    if (run.frame_count() < 2)
        throw InvalidInput(
            fmt::format("'{}' has one frame: a strain needs a run of two or more", request.run.string()));
    const std::optional<std::size_t> fixed = reference_frame(request.reference, run.frame_count());
    const double radius = tool.given("--radius") ? request.radius : default_field_radius(packing.seed_radius);
    require_smaller_than_sample(radius, packing);
    const double diameter = 2.0 * packing.seed_radius;
    const std::span<const std::int32_t> species =
        request.within_phase ? std::span<const std::int32_t>(packing.species) : std::span<const std::int32_t>();

    const std::vector<std::pair<std::string, double>> attributes{{"neighbourhood_radius", radius}};
    FieldWriter writer(run, chosen,
                       {{"strain", "", 6, attributes},
                        {"strain_linear", "", 6, attributes},
                        {"strain_equivalent", "", 1, attributes},
                        {"strain_volumetric", "", 1, attributes},
                        {"non_affine", "", 1, attributes}},
                       request.fields, provenance_of_fields(run, tool.provenance()));
    Table table(RunFrames::columns({"reference [-]", "species [-]", "particles [-]", "without_strain [-]",
                                    "strain_xx [-]", "strain_yy [-]", "strain_zz [-]", "strain_xy [-]", "strain_xz [-]",
                                    "strain_yz [-]", "strain_equivalent [-]", "strain_equivalent_deviation [-]",
                                    "strain_equivalent_max [-]", "strain_volumetric [-]",
                                    "strain_volumetric_deviation [-]", "non_affine [-]", "non_affine_max [-]"}));
    std::vector<Vec3> reference;
    std::size_t reference_at = run.frame_count();  // none read yet
    LocalStrain strain;
    const auto progress = tool.progress("frames", double(chosen.size()));
    for (std::size_t done = 0; done < chosen.size(); ++done) {
        const std::size_t index = chosen[done];
        const std::size_t from = fixed.value_or(index > 0 ? index - 1 : 0);
        if (from != reference_at) reference = run.frame(from).position;
        reference_at = from;
        const Frame frame = run.frame(index);
        strain = local_strain(reference, frames.box(from), frame.position, frames.box(index), radius, diameter, species,
                              tool.threads());
        if (strain.degenerate == std::int64_t(packing.size()))
            throw InvalidInput(fmt::format(
                "no particle of frame {} has the neighbours that a strain needs (4, not in one plane) within --radius "
                "{:g} mm: take a larger one",
                from, radius));
        const std::vector<double> tensor = flattened(strain.logarithmic);
        const auto add = [&](std::optional<std::int32_t> label) {
            const Summary equivalent = summary({strain.equivalent}, packing.species, label);
            const Summary volumetric = summary({strain.volumetric}, packing.species, label);
            const Summary non_affine = summary({strain.non_affine}, packing.species, label);
            const auto particles = label ? std::count(packing.species.begin(), packing.species.end(), *label)
                                         : std::ptrdiff_t(packing.size());
            std::vector<Table::Cell> cells{std::int64_t(from), label_cell(label), std::int64_t(particles),
                                           std::int64_t(particles) - equivalent.count};
            for (std::size_t k = 0; k < 6; ++k)
                cells.push_back(number(summary({tensor, 6, k}, packing.species, label).mean));
            for (const double value : {equivalent.mean, equivalent.deviation, equivalent.max, volumetric.mean,
                                       volumetric.deviation, non_affine.mean, non_affine.max})
                cells.push_back(number(value));
            table.add(frames.row(index, cells));
        };
        add({});
        if (frames.labels().size() > 1)
            for (const std::int32_t label : frames.labels()) add(label);
        writer.add_frame(frame,
                         {tensor, flattened(strain.small), strain.equivalent, strain.volumetric, strain.non_affine});
        progress->update(double(done + 1));
    }
    writer.commit();
    if (!request.table.empty()) table.write(request.table);

    tool.report("frames", std::int64_t(chosen.size()));
    tool.report("particles", std::int64_t(packing.size()));
    tool.report("radius", radius, "mm");
    tool.report("without_strain_last", strain.degenerate);
    tool.report("strain_equivalent_last", summary({strain.equivalent}, packing.species).mean);
    tool.report("strain_volumetric_last", summary({strain.volumetric}, packing.species).mean);
    tool.report("non_affine_last", summary({strain.non_affine}, packing.species).mean);
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
