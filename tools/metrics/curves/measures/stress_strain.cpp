// stress_strain: the stress-strain curve of a run, averaged over strain, and its flow stress.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/curves/stress_resolution.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;

struct Request {
    std::filesystem::path run, table;
    double averaging_strain = 0.01;
    double at = 0.3, window = 0.05;
};

/// Where the flow stress is measured.
struct FlowWindow {
    double at, half_width;
};

/// As asked for; of a run that ends before the default, at its end and as wide in proportion.
FlowWindow flow_window(const Request& request, double largest, cli::Tool& tool) {
    if (tool.given("--at") || largest >= request.at - 0.1 * request.window) return {request.at, request.window};
    return {largest, tool.given("--window") ? request.window : largest * request.window / request.at};
}

cli::Usage usage(Request& request) {
    return cli::Usage{"stress_strain", "Stress-strain curve of a run, averaged over a window of strain."}
        .input("RUN", request.run, "Run (.h5) whose curve is measured.")
        .output("TABLE", request.table, "Table to write, with one row for each point of the curve.", {".csv"})
        .option("--averaging-strain", request.averaging_strain, cli::Unit::strain, cli::not_negative,
                "Average the curve over a sliding window of this width; 0 writes every point as it is.")
        .option("--at", request.at, cli::Unit::strain, cli::positive,
                "Measure the flow stress at this |strain|. Without the option, that of a run which ends before the "
                "default value is measured at its end, in a window as wide in proportion.")
        .option("--window", request.window, cli::Unit::strain, cli::positive,
                "Half-width of the window of |strain| around --at; the flow stress is the mean stress in this window.")
        .step(cli::Step::measure)
        .measure({.heading = "Stress and strain",
                  .results = {{"flow_stress", "flow stress", "MPa", 1e-6},
                              {"flow_stress_unreliable", "flow stress, unreliable (see the warnings)", "MPa", 1e-6},
                              {"flow_stress_deviation", "scatter of the flow stress", "MPa", 1e-6},
                              {"flow_stress_engineering", "flow stress, engineering", "MPa", 1e-6},
                              {"flow_abs_strain_from", "flow stress measured from |strain|", ""},
                              {"flow_abs_strain_to", "flow stress measured to |strain|", ""},
                              {"flow_strain_rate", "strain rate there", "1/s"},
                              {"plane_force_difference", "difference of the planes' forces there", "%", 100},
                              {"particles_across", "particles across the parts of the solid", ""},
                              {"particles_that_would_do", "particles of a sample that would do", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"stress_true", "true stress", "MPa", 1e-6},
                             {"stress_engineering", "engineering stress", "MPa", 1e-6}}})
        .example("stress_strain run.h5 curve.csv --averaging-strain 0.01 --at 0.3 --window 0.05");
}

/// What the stress rests on, and a warning where that is too little.
void report_resolution(const StressResolution& resolution, cli::Tool& tool) {
    tool.report("stress_reliable", std::string(resolution.reliable() ? "yes" : "no"));
    tool.report("particles_across", resolution.particles_across);
    if (!std::isnan(resolution.plane_difference)) tool.report("plane_force_difference", resolution.plane_difference);
    if (!resolution.in_equilibrium())
        tool.warn(fmt::format(
            "the stress is unreliable: the forces of the two planes differ by {:.0f} % (10 % at most): the load is "
            "not carried from one to the other; take a smaller time step or rate, and look at the contacts if the "
            "parts of the sample are loose",
            100.0 * resolution.plane_difference));
    if (resolution.fine_enough()) return;
    tool.report("particles_that_would_do", resolution.particles_to_do);
    tool.warn(fmt::format(
        "the stress is unreliable: the parts of the solid are {:.1f} particles across, and its law needs {:g} to carry "
        "a stress (docs/measures.md); some {} particles would do, made with {:.2g} times the --pixels-per-seed of this "
        "sample",
        resolution.particles_across, resolution.particles_needed, resolution.particles_to_do,
        resolution.particles_across / resolution.particles_needed));
}

void run(const Request& request, cli::Tool& tool) {
    const StrainCurves curves = read_strain_curves(
        request.run, {{"stress_true", "Pa"}, {"stress_engineering", "Pa"}, {"equilibrium_error", ""}});
    const StrainCurves averaged = averaged_over_strain(curves, request.averaging_strain);

    Table table({"time [s]", "strain [-]", "abs_strain [-]", "stress_true [Pa]", "abs_stress_true [Pa]",
                 "stress_engineering [Pa]", "abs_stress_engineering [Pa]", "equilibrium_error [-]"});
    const auto& stress_true = averaged.value.at("stress_true");
    const auto& stress_engineering = averaged.value.at("stress_engineering");
    const auto& equilibrium_error = averaged.value.at("equilibrium_error");
    for (std::size_t i = 0; i < averaged.strain.size(); ++i)
        table.add({averaged.time[i], averaged.strain[i], std::abs(averaged.strain[i]), stress_true[i],
                   std::abs(stress_true[i]), stress_engineering[i], std::abs(stress_engineering[i]),
                   equilibrium_error[i]});

    const RunReader reader(request.run);
    StressResolution resolution;
    const double largest = largest_strain(curves);
    tool.report("points", std::int64_t(table.rows()));
    tool.report("largest_abs_strain", largest);
    if (largest > 0) {
        const auto [at, half_width] = flow_window(request, largest, tool);
        const Plateau flow = plateau(curves, "stress_true", at, half_width);
        const Plateau engineering = plateau(curves, "stress_engineering", at, half_width);
        resolution = stress_resolution(reader, plateau(curves, "equilibrium_error", at, half_width).mean);
        tool.report("flow_stress", flow.mean, "Pa");
        if (!resolution.reliable()) tool.report("flow_stress_unreliable", flow.mean, "Pa");
        tool.report("flow_stress_deviation", flow.deviation, "Pa");
        tool.report("flow_stress_engineering", engineering.mean, "Pa");
        tool.report("flow_strain_rate", flow.rate, "1/s");
        tool.report("flow_abs_strain_from", flow.from);
        tool.report("flow_abs_strain_to", flow.to);
    } else {
        resolution = stress_resolution(reader, std::numeric_limits<double>::quiet_NaN());
        tool.note("the strain does not leave 0: no flow stress");
    }
    report_resolution(resolution, tool);
    table.write(request.table);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
