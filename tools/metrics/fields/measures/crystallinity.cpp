// crystallinity: share of the particles that lie as in a crystal, along a run.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/packing/structure.hpp"
#include "tools/metrics/fields/run_frames.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, table, fields;
    std::string frames = "all";
};

cli::Usage usage(Request& request) {
    return cli::Usage{"crystallinity",
                      "Share of the particles in fcc, hcp, bcc or icosahedral order (common-neighbour analysis)."}
        .input("RUN", request.run, "Run or sample (.h5) to measure.")
        .output("TABLE", request.table,
                "Table to write, with one row of all particles and one of each phase for each frame.", {".csv"})
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .output_option("--fields", request.fields,
                       "Also write the order of each particle (0 none, 1 fcc, 2 hcp, 3 bcc, 4 icosahedral), and "
                       "beside the file a .xdmf for ParaView.",
                       {".h5"})
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Crystalline order",
                  .results = {{"crystalline_last", "crystalline particles, of those inside, last frame", "%", 100},
                              {"crystalline_first", "crystalline particles, of those inside, first frame", "%", 100},
                              {"fcc_last", "in fcc order", "%", 100},
                              {"hcp_last", "in hcp order", "%", 100},
                              {"bcc_last", "in bcc order", "%", 100},
                              {"icosahedral_last", "in icosahedral order", "%", 100}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"crystalline", "crystalline particles, of those inside", "%", 100}}})
        .example("crystallinity run.h5 crystallinity.csv --fields order.h5");
}

constexpr double reach = 1.7;  // diameters: 14 neighbours and more

/// How many particles of a selection lie how.
struct Count {
    std::int64_t particles = 0, surface = 0;
    std::array<std::int64_t, 5> inside{};  // by Order; those at the surface not
    std::int64_t inner() const { return particles - surface; }
    double share(Order order) const { return double(inside[std::size_t(order)]) / double(inner()); }
    /// Of lattices that fill space; icosahedra do not.
    double crystalline() const { return share(Order::fcc) + share(Order::hcp) + share(Order::bcc); }
};

Count count(const std::vector<Order>& order, const std::vector<std::uint8_t>& surface, const Packing& packing,
            std::optional<std::int32_t> label) {
    Count result;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (label && packing.species[i] != *label) continue;
        ++result.particles;
        if (surface[i] != 0)
            ++result.surface;
        else
            ++result.inside[std::size_t(order[i])];
    }
    return result;
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, frames.run().frame_count());
    const Packing& packing = frames.packing();
    std::unique_ptr<FieldWriter> fields;
    if (!request.fields.empty())
        fields = std::make_unique<FieldWriter>(frames.run(), chosen,
                                               std::vector<ParticleField>{{"order", "", 1}, {"surface", "", 1}},
                                               request.fields, provenance_of_fields(frames.run(), tool.provenance()));
    double largest = packing.seed_radius;
    if (!packing.radius.empty()) largest = *std::max_element(packing.radius.begin(), packing.radius.end());

    Table table(RunFrames::columns({"species [-]", "particles [-]", "surface [-]", "fcc [-]", "hcp [-]", "bcc [-]",
                                    "icosahedral [-]", "crystalline [-]"}));
    Count first, last;
    const auto progress = tool.progress("frames", double(chosen.size()));
    for (std::size_t done = 0; done < chosen.size(); ++done) {
        const std::size_t index = chosen[done];
        const Frame frame = frames.run().frame(index);
        const NeighbourTable near(frame.position, frames.box(index), reach * 2.0 * largest, tool.threads());
        const std::vector<Order> order = common_neighbour_analysis(near, tool.threads());
        const std::vector<std::uint8_t> surface = surface_points(near, tool.threads());
        const auto add = [&](std::optional<std::int32_t> label) {
            const Count found = count(order, surface, packing, label);
            table.add(
                frames.row(index, {label_cell(label), found.particles, found.surface, number(found.share(Order::fcc)),
                                   number(found.share(Order::hcp)), number(found.share(Order::bcc)),
                                   number(found.share(Order::icosahedral)), number(found.crystalline())}));
            return found;
        };
        last = add({});
        if (done == 0) first = last;
        if (frames.labels().size() > 1)
            for (const std::int32_t label : frames.labels()) add(label);
        if (fields) {
            std::vector<double> orders;
            for (const Order one : order) orders.push_back(double(one));
            fields->add_frame(frame, {orders, std::vector<double>(surface.begin(), surface.end())});
        }
        progress->update(double(done + 1));
    }
    table.write(request.table);
    if (fields) fields->commit();

    tool.report("frames", std::int64_t(chosen.size()));
    tool.report("particles", std::int64_t(packing.size()));
    tool.report("surface_last", last.surface);
    if (last.inner() == 0) {
        tool.note("all particles lie at the surface: there is no share of the others");
    } else {
        tool.report("fcc_last", last.share(Order::fcc));
        tool.report("hcp_last", last.share(Order::hcp));
        tool.report("bcc_last", last.share(Order::bcc));
        tool.report("icosahedral_last", last.share(Order::icosahedral));
        if (first.inner() > 0) tool.report("crystalline_first", first.crystalline());
        tool.report("crystalline_last", last.crystalline());
    }
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
