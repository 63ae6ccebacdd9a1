// coordination: contacts, rattlers and overlaps of the particles along a run, of each phase and between phases.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/packing/structure.hpp"
#include "tools/metrics/fields/run_frames.hpp"
#include "tools/metrics/fields/summary.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, table, fields;
    std::string frames = "all";
    double reach = 1.0;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"coordination", "Contacts, rattlers and overlaps of the particles along a run."}
        .input("RUN", request.run, "Run or sample (.h5) to measure.")
        .output("TABLE", request.table,
                "Table to write, with one row of all particles, of each phase and of each pair of phases for each "
                "frame.",
                {".csv"})
        .option("--reach", request.reach, cli::Unit::none, {.low = 0.5, .high = 3.0},
                "Count a pair as a contact when its centres are closer than this many times the sum of the two radii: "
                "1 is the contact of the seeds, r_c / r_s (1.5 for BILIN) that of the crowns.")
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .output_option("--fields", request.fields,
                       "Also write the contacts of each particle, and beside the file a .xdmf for ParaView.", {".h5"})
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Contacts of the particles",
                  .results = {{"mean_coordination_last", "contacts of a particle, mean", ""},
                              {"backbone_coordination_last", "contacts of a particle, mean without rattlers", ""},
                              {"rattlers_last", "rattlers", ""},
                              {"mean_overlap_last", "overlap of a contact, mean", "%", 100},
                              {"max_overlap_last", "overlap of a contact, largest", "%", 100}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"mean_coordination", "contacts of a particle, mean", ""},
                             {"backbone_coordination", "contacts of a particle, mean without rattlers", ""}}})
        .example("coordination run.h5 coordination.csv --fields contacts.h5");
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, frames.run().frame_count());
    const Packing& packing = frames.packing();
    std::unique_ptr<FieldWriter> fields;
    if (!request.fields.empty())
        fields = std::make_unique<FieldWriter>(
            frames.run(), chosen,
            std::vector<ParticleField>{{"coordination", "", 1}, {"backbone_coordination", "", 1}, {"rattler", "", 1}},
            request.fields, provenance_of_fields(frames.run(), tool.provenance()));

    Table table(RunFrames::columns({"species [-]", "other_species [-]", "particles [-]", "contacts [-]",
                                    "mean_coordination [-]", "rattlers [-]", "backbone_coordination [-]",
                                    "mean_overlap [-]", "max_overlap [-]"}));
    ContactStatistics last;
    const auto progress = tool.progress("frames", double(chosen.size()));
    for (std::size_t done = 0; done < chosen.size(); ++done) {
        const std::size_t index = chosen[done];
        const Frame frame = frames.run().frame(index);
        const ContactDetail detail =
            contact_detail(frames.at(frame, index), request.reach, OpenFaces::free, tool.threads());
        last = detail.all;
        table.add(frames.row(index, {{},
                                     {},
                                     std::int64_t(packing.size()),
                                     last.contacts,
                                     last.mean_coordination,
                                     last.rattlers,
                                     last.backbone_coordination,
                                     last.mean_overlap,
                                     last.max_overlap}));

        const std::vector<double> contacts(detail.contacts.begin(), detail.contacts.end());
        const std::vector<double> backbone(detail.backbone_contacts.begin(), detail.backbone_contacts.end());
        const std::vector<double> rattler(detail.rattler.begin(), detail.rattler.end());
        std::map<std::int32_t, std::int64_t> particles;
        for (const std::int32_t label : frames.labels()) {
            const Summary all = summary({contacts}, packing.species, label);
            particles[label] = all.count;
            if (frames.labels().size() == 1) break;  // the row of all says it
            const double loose = summary({rattler}, packing.species, label).mean * double(all.count);
            const double held = summary({backbone}, packing.species, label).mean * double(all.count);
            table.add(frames.row(index, {std::int64_t(label),
                                         {},
                                         all.count,
                                         {},
                                         all.mean,
                                         std::int64_t(loose + 0.5),
                                         number(held / (double(all.count) - loose)),
                                         {},
                                         {}}));
        }
        if (frames.labels().size() > 1)
            for (const auto& [labels, pair] : detail.between)
                for (const auto& [from, to] : {std::pair(labels[0], labels[1]), std::pair(labels[1], labels[0])}) {
                    const double ends = double(pair.contacts) * (from == to ? 2.0 : 1.0);
                    table.add(frames.row(index, {std::int64_t(from),
                                                 std::int64_t(to),
                                                 particles[from],
                                                 pair.contacts,
                                                 ends / double(particles[from]),
                                                 {},
                                                 {},
                                                 pair.mean_overlap,
                                                 pair.max_overlap}));
                    if (from == to) break;
                }
        if (fields) fields->add_frame(frame, {contacts, backbone, rattler});
        progress->update(double(done + 1));
    }
    table.write(request.table);
    if (fields) fields->commit();

    tool.report("frames", std::int64_t(chosen.size()));
    tool.report("particles", std::int64_t(packing.size()));
    tool.report("contacts_last", last.contacts);
    tool.report("mean_coordination_last", last.mean_coordination);
    tool.report("backbone_coordination_last", last.backbone_coordination);
    tool.report("rattlers_last", last.rattlers);
    tool.report("mean_overlap_last", last.mean_overlap);
    tool.report("max_overlap_last", last.max_overlap);
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
