// packgen: a random dense packing of spheres, the brick that vol2pack masks with an image.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/packgen/brick_cache.hpp"
#include "tools/packgen/brick_structure.hpp"
#include "tools/packgen/compaction.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path packing;
    std::int64_t particles = 0;
    double density = 0.0;
    double seed_radius = 0.5;  // mm
    double dispersion = 0.0;   // percent
    std::string aspect = "1:1:1", periodic = "xyz";
    std::int64_t random_seed = 1;
    bool no_cache = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage("packgen", "Make a random dense packing of spheres by compaction of random points.")
        .output("packing", request.packing, "packing to write (.h5)")
        .required("--particles", request.particles, cli::Unit::particles, {1, 1e9}, "number of spheres")
        .required(
            "--density", request.density, cli::Unit::none, {packgen::lowest_density, packgen::highest_density},
            "D, volume of the spheres over that of the box: N pi d^3 / (6 V), d = 2 r_s, for equal ones; random close "
            "packing is 0.64, more makes spheres overlap")
        .option("--seed-radius", request.seed_radius, cli::Unit::length, cli::positive,
                "radius r_s of the spheres, or their mean")
        .option("--dispersion", request.dispersion, cli::Unit::percent, {0, 100 * packgen::highest_dispersion},
                "standard deviation of the radii over their mean, of a normal distribution cut at three of them")
        .option("--aspect", request.aspect, "edges of the box in proportion, x:y:z, such as 1:1:10")
        .option("--periodic", request.periodic,
                "axes along which the packing repeats, such as xy, or none; along the others flat walls hold it")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "the same number gives the same packing")
        .flag("--no-cache", request.no_cache,
              "make it even if it was made before, and do not keep it (in $XDG_CACHE_HOME/tomodem or ~/.cache/tomodem)")
        .threads()
        .example("packgen brick.h5 --particles 20000 --density 0.70");
}

std::array<double, 3> aspect_of(const std::string& text) {
    std::array<double, 3> aspect{};
    const char *at = text.data(), *const end = at + text.size();
    for (int axis = 0; axis < 3; ++axis) {
        const auto [next, error] = std::from_chars(at, end, aspect[axis]);
        const bool in_order = axis < 2 ? next != end && *next == ':' : next == end;
        if (error != std::errc{} || !in_order || !(aspect[axis] > 0.0))
            throw WrongUsage("--aspect '" + text + "': expected three positive numbers as 1:1:10");
        at = next + 1;
    }
    return aspect;
}

std::array<bool, 3> periodic_of(const std::string& text) {
    std::array<bool, 3> periodic{};
    if (text == "none") return periodic;
    for (const char letter : text) {
        const int axis = letter - 'x';
        if (axis < 0 || axis > 2 || periodic[axis])
            throw WrongUsage("--periodic '" + text + "': expected some of the letters x, y and z, each once, or none");
        periodic[axis] = true;
    }
    if (text.empty()) throw WrongUsage("--periodic is empty: for walls on all sides say none");
    return periodic;
}

/// The table of g(r) as JSON.
std::string as_json(const RadialDistribution& distribution, double diameter) {
    std::vector<double> radii;
    for (std::size_t k = 0; k < distribution.g.size(); ++k) radii.push_back(distribution.radius(k) / diameter);
    return fmt::format(R"({{"r_unit":"d","r":[{:.6g}],"g":[{:.6g}]}})", fmt::join(radii, ","),
                       fmt::join(distribution.g, ","));
}

void report_structure(const packgen::BrickStructure& structure, double diameter, std::size_t particles,
                      cli::Tool& tool) {
    const ContactStatistics& contacts = structure.contacts;
    tool.report("max_overlap", contacts.max_overlap, "d");
    tool.report("mean_overlap", contacts.mean_overlap, "d");
    tool.report("mean_coordination", contacts.mean_coordination);
    tool.report("backbone_coordination", contacts.backbone_coordination);
    tool.report("rattlers", static_cast<double>(contacts.rattlers) / static_cast<double>(particles));
    tool.report("crystalline", structure.crystalline());
    tool.report("fcc", structure.fcc);
    tool.report("hcp", structure.hcp);
    tool.report("bcc", structure.bcc);
    tool.report("icosahedral", structure.icosahedral);
    tool.report("solid_like", structure.solid_like);
    tool.report("mean_q6", structure.mean_q6);
    tool.report("global_q6", structure.global_q6);
    tool.report("bond_cutoff", structure.bond_cutoff / diameter, "d");
    tool.report_json("radial_distribution", nlohmann::ordered_json::parse(as_json(structure.distribution, diameter)));
}

void run(const Request& request, cli::Tool& tool) {
    const auto progress = tool.progress("compaction", 1.0);
    const packgen::Compaction wanted{.particles = request.particles,
                                     .density = request.density,
                                     .seed_radius = request.seed_radius,
                                     .dispersion = request.dispersion / 100.0,
                                     .aspect = aspect_of(request.aspect),
                                     .periodic = periodic_of(request.periodic),
                                     .random_seed = request.random_seed,
                                     .threads = tool.threads(),
                                     .progress = [&](double done) { progress->update(done); }};
    const packgen::BrickCache cache(request.no_cache ? std::filesystem::path{} : packgen::BrickCache::users_folder());
    const std::optional<packgen::CompactedPacking> kept = cache.find(wanted);
    const packgen::CompactedPacking made = kept ? *kept : packgen::compact(wanted);
    if (!kept) cache.keep(wanted, made);
    const Packing& packing = made.packing;
    write_packing(packing, request.packing, tool.provenance());
    tool.report("particles", request.particles);
    tool.report("density", packing.density());
    tool.report("box_edge_x", packing.box.edges.x(), "mm");
    tool.report("box_edge_y", packing.box.edges.y(), "mm");
    tool.report("box_edge_z", packing.box.edges.z(), "mm");
    if (!packing.radius.empty()) {
        const auto [smallest, largest] = std::minmax_element(packing.radius.begin(), packing.radius.end());
        tool.report("smallest_radius", *smallest, "mm");
        tool.report("largest_radius", *largest, "mm");
    }
    tool.report("steps", made.steps);
    tool.report("residual", made.residual, "k d");
    tool.report("load", made.load, "k d");
    report_structure(packgen::structure_of(packing, tool.threads()), 2.0 * packing.seed_radius, packing.size(), tool);
    tool.report("from_cache", std::int64_t{kept.has_value()});
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
