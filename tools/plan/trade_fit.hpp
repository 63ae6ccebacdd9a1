#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/plan/trade_table.hpp"

/// From the runs of pipelines/trade to the table that says what accuracy costs (docs/trade.md).
namespace tomodem::plan {

/// What one run of a sweep measured and cost: a row of the sweep's results.csv.
struct SweepRow {
    std::string scene;
    std::string law = "bilin";
    double size = 0;       ///< resolution that the run was made for: particles across the feature, or of the sample
    double step = 0;       ///< strain_per_step; of NORTON inertia_share
    double rate = 0;       ///< rate of the load over the one that the constants were chosen for
    std::string filter;    ///< of vol2pack
    std::string packing;   ///< random seed of the brick
    std::string quantity;  ///< what was measured; "none": the run did not survive, and has no numbers below
    double value = 0;
    double particles = 0, steps = 0, time_step = 0;
    double cpu_solve = 0, cpu_prepare = 0;  ///< s
    double peak_bytes = 0;
};

/// Right values that do not come from a run: measured quantity -> rate (as in SweepRow) -> value.
using References = std::map<std::string, std::map<double, double>>;

/// @throws InvalidInput naming file and line: a missing column, a number that is none, an unknown law
std::vector<SweepRow> read_sweep(const std::filesystem::path& table);
/// @throws InvalidInput naming file and line
References read_references(const std::filesystem::path& file);

/// The errors and costs of each quantity under each law that has runs in the sweep and a density.
///
/// For each size at the base step (the step of most runs): |mean error| and standard deviation over the packings, the
/// larger of the measured quantities that the table's quantity is made of. A size is not said to be better than the
/// finer ones, because a few packings say little of a spread and an error may pass through 0; only the bias of the flow
/// stress may rise, which was calibrated at some size. A step's error is the mean change from the base step in the same
/// samples, of the finest size that has both. Quantities without a reference are compared with the finest runs of
/// NORTON. CPU time and memory are fitted by least squares.
///
/// @param densities  of the brick of each law
/// @throws InvalidInput if a quantity lacks a run that its error is counted from
TradeTable fit_trade(const std::vector<SweepRow>& rows, const References& references,
                     const std::map<std::string, double>& densities);

/// The table as TOML text, which parse_trade reads.
std::string trade_text(const TradeTable& table);

}  // namespace tomodem::plan
