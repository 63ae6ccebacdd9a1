// calibration_table: from runs of one material under a law to the table that turns norton = { K, M } into constants.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/output_file.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "tools/calibrate/calibration_fit.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::calibrate;

struct Request {
    std::vector<std::filesystem::path> runs;
    std::filesystem::path table, curve;
    FitOptions options;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"calibration_table", "Table of the flow stress of the laws from runs of one material."}
        .step(cli::Step::plan)
        .inputs("RUN", request.runs,
                "Runs (.h5) of one dense phase, each at one rate; runs of several laws may be mixed.")
        .output("TABLE", request.table,
                "Table to write; a scene uses it where the key calibration in its section [accuracy] names this "
                "file.",
                {".toml"})
        .option("--particles", request.options.particles, cli::Unit::particles, cli::positive,
                "Make the table from the runs with this number of particles; the others say what the size changes. The "
                "default is the number that most runs have.")
        .option("--strain-per-step", request.options.strain_per_step, cli::Unit::strain, cli::positive,
                "Make the table of law bilin from the runs with this strain in a time step; the others say what the "
                "time step changes. The default is the one that most runs have.")
        .option("--at", request.options.where.at, cli::Unit::strain, cli::positive,
                "Measure the flow stress at this |strain|.")
        .option("--window", request.options.where.window, cli::Unit::strain, cli::positive,
                "Half-width of the window of |strain| around --at; the flow stress is the mean stress in this window.")
        .option("--strain-error", request.options.strain_error, cli::Unit::fraction, cli::positive,
                "Limit the table to the strains around --at at which the mean stress of every row differs from its "
                "flow stress by at most this fraction.")
        .option("--name", request.options.name,
                "Name stored in the table; solve prints it. The default is the name of the file.")
        .output_option("--compare", request.curve,
                       "Also write every row beside the table that tomodem ships, with the spread over the packings.",
                       {".csv"})
        .example("calibration_table runs/*.h5 my_table.toml --compare my_table.csv");
}

/// One measured flow beside what the shipped table has there.
struct Compared {
    std::string law;
    double control, flow, spread, shipped, shipped_spread;
    std::string measure = "spread";  ///< what the two are: of TRILIN and NORTON the error of the law fitted
    double difference() const { return flow / shipped - 1; }
    double both() const { return std::hypot(spread, shipped_spread); }
};

std::vector<Compared> beside_the_shipped(const Calibration& table) {
    const Calibration& shipped = shipped_calibration();
    std::vector<Compared> rows;
    if (const auto* const bilin = table.find<BilinCalibration>())
        for (std::size_t k = 0; k < bilin->curve.chi.size(); ++k) {
            const double chi = bilin->curve.chi[k];
            if (chi < shipped.find<BilinCalibration>()->curve.chi.front() ||
                chi > shipped.find<BilinCalibration>()->curve.chi.back())
                continue;
            rows.push_back({"bilin", chi, bilin->curve.flow[k], bilin->spread[k],
                            shipped.find<BilinCalibration>()->curve.at(chi),
                            shipped.find<BilinCalibration>()->spread_at(chi)});
        }
    if (const auto* const trilin = table.find<TrilinCalibration>())
        for (const double rate : trilin->rate)
            rows.push_back({"trilin", rate, trilin->flow.at(rate), trilin->error.compression.value_or(0),
                            shipped.find<TrilinCalibration>()->flow.at(rate),
                            shipped.find<TrilinCalibration>()->error.compression.value_or(0), "error"});
    if (const auto* const norton = table.find<NortonCalibration>())
        rows.push_back({"norton", norton->sensitivity[1], norton->flow, norton->error.compression.value_or(0),
                        shipped.find<NortonCalibration>()->flow,
                        shipped.find<NortonCalibration>()->error.compression.value_or(0), "error"});
    return rows;
}

void report_window(const CalibrationWindow& window, const std::string& law, cli::Tool& tool) {
    tool.report(law + "_packings", static_cast<std::int64_t>(window.packings));
    tool.report(law + "_strain_from", window.strain[0]);
    tool.report(law + "_strain_to", window.strain[1]);
    if (window.strain_tension) tool.report(law + "_strain_to_tension", (*window.strain_tension)[1]);
    if (window.packings < 2)
        tool.note(fmt::format("law \"{}\": one packing has no spread, so the errors of the table are too small", law));
}

void report_errors(const DirectedErrors& error, const std::string& law, cli::Tool& tool) {
    if (error.compression) tool.report(law + "_error_compression", 100 * *error.compression, "%");
    if (error.tension) tool.report(law + "_error_tension", 100 * *error.tension, "%");
}

void run(const Request& request, cli::Tool& tool) {
    std::vector<MeasuredRun> runs;
    for (const auto& path : request.runs) runs.push_back(measure_run(path, request.options.where));
    FitOptions options = request.options;
    if (options.name.empty()) options.name = request.table.stem().string();
    const Calibration table = fit_calibration(runs, options);
    const std::string text = calibration_text(table);
    parse_calibration(text, request.table.string());  // what no scene could read is not written

    Table rows({"law", "control [-]", "flow [-]", "spread_or_error [-]", "shipped [-]", "shipped_spread_or_error [-]",
                "difference [-]", "verdict"});
    for (const Compared& one : beside_the_shipped(table)) {
        const std::string verdict =
            fmt::format("{} than the {}", std::abs(one.difference()) < one.both() ? "smaller" : "larger", one.measure);
        rows.add(
            {one.law, one.control, one.flow, one.spread, one.shipped, one.shipped_spread, one.difference(), verdict});
        tool.report(fmt::format("{}_{:g}", one.law, one.control),
                    fmt::format("{:.4g} +- {:.1f} %, shipped {:.4g}: {:+.1f} %, {} ({:.1f} %)", one.flow,
                                100 * one.spread, one.shipped, 100 * one.difference(), verdict, 100 * one.both()));
    }
    if (!request.curve.empty()) rows.write(request.curve);
    write_text(request.table, text);

    tool.report("runs", static_cast<std::int64_t>(runs.size()));
    if (const auto* const bilin = table.find<BilinCalibration>()) {
        report_window(*bilin, "bilin", tool);
        tool.report("bilin_time_step_error",
                    100 * *std::max_element(bilin->time_step_error.begin(), bilin->time_step_error.end()), "%");
    }
    if (const auto* const trilin = table.find<TrilinCalibration>()) {
        report_window(*trilin, "trilin", tool);
        report_errors(trilin->error, "trilin", tool);
    }
    if (const auto* const norton = table.find<NortonCalibration>()) {
        report_window(*norton, "norton", tool);
        report_errors(norton->error, "norton", tool);
    }
    tool.report_json("rows", rows.json());
}

}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
