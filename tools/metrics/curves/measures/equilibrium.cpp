// equilibrium: difference of the forces on the two planes, relative to their mean.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "tools/metrics/curves/strain_curves.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;

struct Request {
    std::filesystem::path run, table;
    double averaging_strain = 0.01;
    double from = 0.2, to = 0.0;  // to: 0 is the end of the run
};

cli::Usage usage(Request& request) {
    return cli::Usage{"equilibrium", "Equilibrium error of a run: |F_top + F_bottom| / mean |F|."}
        .input("RUN", request.run, "Run (.h5) whose forces are compared.")
        .output("TABLE", request.table,
                "Table to write, with the forces on the two planes and the equilibrium error at each recorded "
                "strain.",
                {".csv"})
        .option("--averaging-strain", request.averaging_strain, cli::Unit::strain, cli::not_negative,
                "Average each force over a sliding window of this width before the two are compared; 0 does not "
                "average.")
        .option("--from", request.from, cli::Unit::strain, cli::not_negative,
                "Average the error from this |strain| on; choose it beyond the transient at the beginning.")
        .option("--to", request.to, cli::Unit::strain, cli::positive,
                "Average the error up to this |strain|; the default is the largest of the run.")
        .step(cli::Step::measure)
        .measure({.heading = "Equilibrium",
                  .results = {{"equilibrium_error", "equilibrium error", "%", 100},
                              {"equilibrium_error_max", "equilibrium error, largest", "%", 100},
                              {"abs_strain_from", "averaged from |strain|", ""},
                              {"abs_strain_to", "averaged to |strain|", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"equilibrium_error", "equilibrium error", "%", 100}}})
        .example("equilibrium run.h5 equilibrium.csv --from 0.2 --to 0.3");
}

void run(const Request& request, cli::Tool& tool) {
    const StrainCurves forces = averaged_over_strain(
        read_strain_curves(request.run, {{"force_top", "uN"}, {"force_bottom", "uN"}}), request.averaging_strain);
    const StrainCurves errors = equilibrium_errors(forces);

    Table table(
        {"time [s]", "strain [-]", "abs_strain [-]", "force_top [uN]", "force_bottom [uN]", "equilibrium_error [-]"});
    for (std::size_t i = 0; i < errors.strain.size(); ++i)
        table.add({errors.time[i], errors.strain[i], std::abs(errors.strain[i]), errors.value.at("force_top")[i],
                   errors.value.at("force_bottom")[i], errors.value.at("equilibrium_error")[i]});

    const double to = tool.given("--to") ? request.to : largest_strain(forces);
    const Plateau mean = mean_between(errors, "equilibrium_error", request.from, to);
    tool.report("points", std::int64_t(table.rows()));
    tool.report("points_without_force", std::int64_t(forces.strain.size() - errors.strain.size()));
    tool.report("equilibrium_error", mean.mean);
    tool.report("equilibrium_error_max", mean.highest);
    tool.report("abs_strain_from", mean.from);
    tool.report("abs_strain_to", mean.to);
    table.write(request.table);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
