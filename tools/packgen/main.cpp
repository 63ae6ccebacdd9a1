// packgen: a random dense packing of spheres, the brick that vol2pack cuts a sample from.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "core/scene/law.hpp"
#include "tools/packgen/brick_cache.hpp"
#include "tools/packgen/brick_structure.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem::packgen {
namespace {

struct Request {
    std::filesystem::path packing;
    std::int64_t particles = 0;
    double density = 0.0;
    std::string law;
    double seed_radius = 0.5;  // mm
    double dispersion = 0.0;   // percent
    std::string aspect = "1:1:1", periodic = "xyz";
    std::int64_t random_seed = 1;
    bool no_cache = false;
};

std::vector<std::string> names_of_laws() {
    std::vector<std::string> names;
    for (const Law* law : laws()) names.push_back(law->name());
    return names;
}

std::string density_help() {
    std::string densities;
    for (const Law* law : laws())
        densities +=
            fmt::format("{}{:.2f} {}", densities.empty() ? "" : ", ", law->traits().packing_density, law->name());
    return fmt::format("Instead of --density, that at which this law is calibrated: {}.", densities);
}

cli::Usage usage(Request& request) {
    return cli::Usage("packgen", "Make a random dense packing of spheres: the brick that vol2pack cuts a sample from.")
        .output("BRICK", request.packing, "Packing to write.", {".h5"})
        .required("--particles", request.particles, cli::Unit::particles, {1, 1e9}, "Number of spheres.")
        .option("--density", request.density, cli::Unit::none, {lowest_density, highest_density},
                "Volume of the spheres, overlaps counted twice, over that of the box. Random close packing of equal "
                "spheres is 0.64; at a higher density they overlap more.")
        .choice("--law", request.law, names_of_laws(), density_help())
        .exclusive({"--density", "--law"})
        .option("--seed-radius", request.seed_radius, cli::Unit::length, cli::positive,
                "Radius of the spheres; their mean radius with --dispersion.")
        .option("--dispersion", request.dispersion, cli::Unit::percent, {0, 100 * highest_dispersion},
                "Standard deviation of the radii over their mean. Radii are normally distributed, up to three standard "
                "deviations from the mean.")
        .option("--aspect", request.aspect, "Proportions of the edges of the box as x:y:z, such as 1:1:10.")
        .option("--periodic", request.periodic,
                "Axes along which the packing is periodic, such as xy, or none. Flat walls hold it along the others.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers. The same seed gives the same packing.")
        .flag("--no-cache", request.no_cache,
              "Do not use the cache of packings ($XDG_CACHE_HOME/tomodem, or ~/.cache/tomodem). Without this option, a "
              "packing made before with the same options is taken from it.")
        .step(cli::Step::sample)
        .threads()
        .example("packgen brick.h5 --particles 20000 --law norton")
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

nlohmann::ordered_json as_json(const RadialDistribution& distribution, double diameter) {
    std::vector<double> radii;
    for (std::size_t k = 0; k < distribution.g.size(); ++k) radii.push_back(distribution.radius(k) / diameter);
    return {{"r_unit", "d"}, {"r", radii}, {"g", distribution.g}};
}

void report_structure(const BrickStructure& structure, double diameter, std::size_t particles, cli::Tool& tool) {
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
    tool.report_json("radial_distribution", as_json(structure.distribution, diameter));
}

void run(const Request& request, cli::Tool& tool) {
    if (!tool.given("--density") && !tool.given("--law"))
        throw WrongUsage("give --density, or the --law that the samples are made for");
    const double density = tool.given("--law") ? find_law(request.law)->traits().packing_density : request.density;
    const auto progress = tool.progress("compaction", 1.0);
    const Compaction wanted{.particles = request.particles,
                            .density = density,
                            .seed_radius = request.seed_radius,
                            .dispersion = request.dispersion / 100.0,
                            .aspect = aspect_of(request.aspect),
                            .periodic = periodic_of(request.periodic),
                            .random_seed = request.random_seed,
                            .threads = tool.threads(),
                            .progress = [&](double done) { progress->update(done); }};
    const BrickCache cache(request.no_cache ? std::filesystem::path{} : BrickCache::users_folder());
    const std::optional<CompactedPacking> cached = cache.find(wanted);
    const CompactedPacking made = cached ? *cached : compact(wanted);
    if (!cached) cache.keep(wanted, made);
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
    report_structure(structure_of(packing, tool.threads()), 2.0 * packing.seed_radius, packing.size(), tool);
    tool.report("from_cache", std::int64_t{cached.has_value()});
}
}  // namespace
}  // namespace tomodem::packgen

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::packgen::usage, tomodem::packgen::run);
}
