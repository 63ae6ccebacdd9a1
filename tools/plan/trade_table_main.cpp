// trade_table: from the runs of pipelines/trade to the table that plan uses.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/cli/cli.hpp"
#include "tools/plan/trade_fit.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::plan;

struct Request {
    std::filesystem::path results, references, table;
    std::string densities, name = "pipelines/trade";
};

cli::Usage usage(Request& request) {
    return cli::Usage{"trade_table",
                      "Make the table by which plan predicts error, time and memory, from the simulations of "
                      "pipelines/trade."}
        .step(cli::Step::plan)
        .input("RESULTS", request.results, "Results (.csv) of the sweeps, one row for each run and measured quantity.")
        .input("REFERENCES", request.references, "Right values (.toml) of the quantities that have one.")
        .output("TABLE", request.table, "Table to write; plan reads it with --table.", {".toml"})
        .required("--densities", request.densities,
                  "Laws that the table holds, each with the density D of the packing its simulations started from, as "
                  "bilin=0.70,norton=0.64.")
        .option("--name", request.name, "Name stored in the table; plan prints it.")
        .example("trade_table results.csv reference.toml trade.toml --densities bilin=0.70,trilin=0.74,norton=0.64");
}

std::map<std::string, double> parse_densities(const std::string& text) {
    std::map<std::string, double> densities;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const std::size_t equals = part.find('=');
        const std::string name = part.substr(0, equals);
        double density = 0;
        std::size_t used = 0;
        try {
            if (equals != std::string::npos) density = std::stod(part.substr(equals + 1), &used);
        } catch (const std::exception&) {
            density = 0;
        }
        if (find_law(name) != nullptr) densities[name] = density;
        if (find_law(name) == nullptr || !(density > 0) || density > 1 || used != part.size() - equals - 1)
            throw WrongUsage(
                fmt::format("--densities '{}': expected LAW=DENSITY separated by commas, as bilin=0.70", text));
    }
    return densities;
}

/// Its name, as Linux has it.
std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "an unknown processor";
}

void run(const Request& request, cli::Tool& tool) {
    const std::vector<SweepRow> rows = read_sweep(request.results);
    TradeTable table = fit_trade(rows, read_references(request.references), parse_densities(request.densities));
    table.name = request.name;
    table.processor = processor();
    const std::string text = trade_text(table);
    parse_trade(text, request.table.string());  // what plan could not read is not written
    write_text(request.table, text);
    tool.report("rows", static_cast<std::int64_t>(rows.size()));
    for (const auto& [law, trade] : table.law)
        tool.report(fmt::format("quantities_{}", law), static_cast<std::int64_t>(trade.curve.size()));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
