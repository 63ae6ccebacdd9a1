// norton_fit: K and M of sigma = K rate^M from runs at different rates.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "tools/metrics/curves/norton_regression.hpp"
#include "tools/metrics/curves/strain_curves.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;

struct Request {
    std::vector<std::filesystem::path> runs;
    std::filesystem::path table;
    double at = 0.3, window = 0.05;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"norton_fit", "Norton law sigma = K rate^M of runs at different strain rates."}
        .inputs("RUN", request.runs, "Two or more runs (.h5) at different strain rates.")
        .output("TABLE", request.table, "Table to write, with the rate, flow stress and fit of each run.", {".csv"})
        .option("--at", request.at, cli::Unit::strain, cli::positive, "Measure the flow stress at this |strain|.")
        .option("--window", request.window, cli::Unit::strain, cli::positive,
                "Half-width of the window of |strain| around --at; the flow stress is the mean stress in this window.")
        .step(cli::Step::measure)
        .example("norton_fit slow.h5 middle.h5 fast.h5 norton.csv --at 0.3");
}

Plateau flow_of(const std::filesystem::path& run, const Request& request) {
    const StrainCurves curves = read_strain_curves(run, {{"stress_true", "Pa"}});
    try {
        return plateau(curves, "stress_true", request.at, request.window);
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("'{}': {}", run.string(), error.what()));
    }
}

void run(const Request& request, cli::Tool& tool) {
    constexpr double pascals_per_megapascal = 1e6;
    std::vector<double> rates, stresses;
    for (const auto& path : request.runs) {
        const Plateau flow = flow_of(path, request);
        rates.push_back(flow.rate);
        stresses.push_back(flow.mean / pascals_per_megapascal);
    }
    const NortonFit fit = norton_fit(rates, stresses);

    Table table({"run", "rate [1/s]", "flow_stress [MPa]", "fit [MPa]", "deviation [-]"});
    for (std::size_t i = 0; i < rates.size(); ++i) {
        const double fitted = fit.K * std::pow(rates[i], fit.M);
        table.add({request.runs[i].string(), rates[i], stresses[i], fitted, stresses[i] / fitted - 1.0});
    }
    table.write(request.table);

    tool.report("runs", std::int64_t(rates.size()));
    tool.report("K", fit.K, "MPa.s^M");
    tool.report("M", fit.M);
    if (fit.M_interval) {
        tool.report("K_low", fit.K_interval->low, "MPa.s^M");
        tool.report("K_high", fit.K_interval->high, "MPa.s^M");
        tool.report("M_low", fit.M_interval->low);
        tool.report("M_high", fit.M_interval->high);
    } else {
        tool.note("two runs give no confidence interval; add a third");
    }
    tool.report("residual", fit.residual);
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
