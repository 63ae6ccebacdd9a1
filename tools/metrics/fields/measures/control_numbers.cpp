// control_numbers: in which regime the packing of a run flows: density, stiffness level, inertia, agitation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/fields/control.hpp"
#include "tools/metrics/fields/run_frames.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, table, curve;
    std::string frames = "all";
    double averaging_strain = 0.01;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"control_numbers",
                      "Dimensionless numbers that show how close the flow of a run is to equilibrium: density, "
                      "stiffness level, inertial number, and the kinetic energy relative to stress (Q) and to elastic "
                      "energy."}
        .input("RUN", request.run, "Run (.h5) written by solve.")
        .output("TABLE", request.table,
                "Table to write, with one row of all particles and one of each phase for each frame.", {".csv"})
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .option("--averaging-strain", request.averaging_strain, cli::Unit::strain, cli::not_negative,
                "Average the energies over a sliding window of strain of this width; 0 does not average. It does not "
                "apply to the forces, which solve averages.")
        .output_option("--curve", request.curve,
                       "Also write the numbers at every recorded strain, not only at the frames; the density, which "
                       "needs a frame, is left out.",
                       {".csv"})
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Control numbers of the packing",
                  .results = {{"density_first", "density D of the packing, first frame", ""},
                              {"density_last", "density D of the packing, last frame", ""},
                              {"stiffness_level_last", "stiffness level k/(P d)", ""},
                              {"inertial_number_last", "inertial number", ""},
                              {"Q_last", "kinetic energy over P d³", ""},
                              {"kinetic_over_elastic_last", "kinetic over elastic energy", ""},
                              {"limits_exceeded", "limits exceeded", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"density", "density D of the packing", ""}}})
        .example("control_numbers run.h5 control.csv --curve control_curve.csv");
}

Table::Cell cell(const std::optional<double>& value) {
    return value ? Table::Cell(*value) : Table::Cell();
}

/// Where a number leaves the range in which the method is known to be quasi-static (docs/measures.md).
struct Limit {
    double max;
    const char* meaning;
};
constexpr Limit inertial_limit{
    1e-2, "inertial number {:.2g} at strain {:.3g}, above {:g}: inertia counts; take a smaller strain_per_step"};
constexpr Limit chi_limit{
    6.0,
    "rate t0^2 / time_step is {:.2g} at strain {:.3g}, above {:g}: packings of BILIN collapse there (thesis, 11.2)"};
constexpr Limit agitation_limit{
    0.1, "E_k / E_p is {:.2g} at strain {:.3g}, above {:g}: the packing is hot; take a smaller strain_per_step"};
constexpr Limit heat_limit{
    10.0, "E_k is {:.2g} times that of the flow at strain {:.3g}, above {:g}: the packing is hot (docs/norton.md)"};
constexpr Limit equilibrium_limit{
    0.01, "the equilibrium error is {:.2g} on average, largest at strain {:.3g}, above {:g}: the thesis' limit (14.2)"};
constexpr double stiffness_limit = 10.0;

struct Worst {
    double value = 0.0, strain = 0.0;
    void see(const std::optional<double>& number, double at) {
        if (!number || *number <= value) return;
        value = *number;
        strain = at;
    }
    /// @return  1 if it warned
    int warn_above(const Limit& limit, cli::Tool& tool) const {
        if (!(value > limit.max)) return 0;
        tool.warn(fmt::format(fmt::runtime(limit.meaning), value, strain, limit.max));
        return 1;
    }
};

double largest_magnitude(const std::vector<double>& values) {
    double largest = 0.0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    return largest;
}

/// While the stress builds up or changes its sign there is no flow yet.
bool flows(double stress, double largest) {
    return stress > 0.0 && stress >= 0.75 * largest;
}

/// Mean of the equilibrium error where the packing flows.
/// @return  the number of limits exceeded, as of the next
int warn_of_imbalance(const RunReader& run, const ControlCurves& curves, cli::Tool& tool) {
    const auto found = run.observables().find("equilibrium_error");
    if (found == run.observables().end()) return 0;
    const std::vector<double>& stress = curves.points.value.at("stress_true");
    const double largest = largest_magnitude(stress);
    Worst worst;
    double sum = 0.0;
    int points = 0;
    for (std::size_t i = 0; i < stress.size(); ++i) {
        if (!flows(std::abs(stress[i]), largest)) continue;
        const double error = value_at(found->second, curves.points.time[i]);
        worst.see(error, curves.points.strain[i]);
        sum += error;
        ++points;
    }
    worst.value = points > 0 ? sum / points : 0.0;
    tool.report("equilibrium_error", worst.value);
    return worst.warn_above(equilibrium_limit, tool);
}

/// Of BILIN and TRILIN; in law NORTON the cores hardly touch and the mass is chosen by the stress.
int warn_of_leaving(const ControlCurves& curves, const std::vector<PhaseConstants>& phases, std::size_t particles,
                    double diameter, cli::Tool& tool) {
    Worst inertial, agitation, softness, chi;
    const double largest = largest_magnitude(curves.points.value.at("stress_true"));
    for (std::size_t i = 0; i < curves.points.time.size(); ++i) {
        const double strain = curves.points.strain[i];
        const ControlNumbers numbers = curves.at(curves.points.time[i], phases, particles, diameter);
        if (!flows(numbers.stress, largest)) continue;
        inertial.see(numbers.max_inertial_number, strain);
        agitation.see(numbers.kinetic_over_elastic, strain);
        if (numbers.min_stiffness_level) softness.see(1.0 / *numbers.min_stiffness_level, strain);
        for (const auto& phase : numbers.phases) chi.see(phase.chi, strain);
    }
    const int exceeded = inertial.warn_above(inertial_limit, tool) + agitation.warn_above(agitation_limit, tool) +
                         chi.warn_above(chi_limit, tool);
    if (!(softness.value > 1.0 / stiffness_limit)) return exceeded;
    tool.warn(fmt::format(
        "stiffness level {:.3g} at strain {:.3g}, below {:g}: particles overlap by more than a tenth of their "
        "diameter",
        1.0 / softness.value, softness.strain, stiffness_limit));
    return exceeded + 1;
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, frames.run().frame_count());
    const Packing& packing = frames.packing();
    const ControlCurves curves(request.run, request.averaging_strain);
    const std::vector<PhaseConstants> phases = phase_constants(frames);
    const double diameter = 2.0 * packing.seed_radius;

    std::vector<std::optional<Density>> density(chosen.size());
    std::vector<double> flow(chosen.size());
    const auto progress = tool.progress("frames", double(chosen.size()));
    std::mutex mutex;
    double done = 0.0;
    parallel_for(std::int64_t(chosen.size()), tool.threads(), [&](std::int64_t k) {
        const Frame frame = frames.run().frame(chosen[std::size_t(k)]);
        try {
            density[std::size_t(k)] = deformed_density(frames.at(frame, chosen[std::size_t(k)]));
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("frame {}: {}", chosen[std::size_t(k)], error.what()));
        }
        const double rate = curves.at(frame.time, phases, packing.size(), diameter).rate;
        flow[std::size_t(k)] = flow_energy(frame.position, packing.species, frames.axis(), rate, phases, frame.time);
        const std::scoped_lock lock(mutex);
        progress->update(++done);
    });

    Table table(
        RunFrames::columns({"species [-]", "phase [-]", "particles [-]", "density [-]", "volume [mm^3]", "stress [Pa]",
                            "rate [1/s]", "stiffness [uN/mm]", "mass [g]", "chi [-]", "stiffness_level [-]",
                            "inertial_number [-]", "Q [-]", "kinetic_over_elastic [-]", "kinetic_over_flow [-]"}));
    ControlNumbers last;
    Worst heat;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        const double time = frames.run().frame_time(chosen[k]);
        last = curves.at(time, phases, packing.size(), diameter);
        const double kinetic = PiecewiseLinear(curves.points.time, curves.points.value.at("kinetic_energy")).at(time);
        if (flow[k] > 0.0) heat.see(kinetic / flow[k], frames.strain(chosen[k]).value_or(0.0));
        const auto& d = density[k];
        const Table::Cell none;
        std::vector<Table::Cell> all{none, none, std::int64_t(packing.size())};
        all.push_back(d ? Table::Cell(d->density) : none);
        all.push_back(d ? Table::Cell(d->volume) : none);
        all.insert(all.end(), {last.stress, last.rate, none, none, none});
        for (const auto& number :
             {last.min_stiffness_level, last.max_inertial_number, last.kinetic_number, last.kinetic_over_elastic})
            all.push_back(cell(number));
        all.push_back(flow[k] > 0.0 ? Table::Cell(kinetic / flow[k]) : none);
        table.add(frames.row(chosen[k], all));
        for (const ControlNumbers::OfPhase& phase : last.phases)
            table.add(frames.row(chosen[k],
                                 {std::int64_t(phase.label),
                                  frames.phase_name(phase.label),
                                  std::int64_t(std::count(packing.species.begin(), packing.species.end(), phase.label)),
                                  {},
                                  {},
                                  {},
                                  {},
                                  phase.stiffness,
                                  phase.mass,
                                  phase.chi > 0.0 ? Table::Cell(phase.chi) : Table::Cell(),
                                  cell(phase.stiffness_level),
                                  cell(phase.inertial_number),
                                  {},
                                  {},
                                  {}}));
    }
    Table points({"time [s]", "strain [-]", "abs_strain [-]", "stress [Pa]", "rate [1/s]", "stiffness_level [-]",
                  "inertial_number [-]", "Q [-]", "kinetic_over_elastic [-]"});
    for (std::size_t i = 0; !request.curve.empty() && i < curves.points.time.size(); ++i) {
        const ControlNumbers numbers = curves.at(curves.points.time[i], phases, packing.size(), diameter);
        points.add({curves.points.time[i], curves.points.strain[i], std::abs(curves.points.strain[i]), numbers.stress,
                    numbers.rate, cell(numbers.min_stiffness_level), cell(numbers.max_inertial_number),
                    cell(numbers.kinetic_number), cell(numbers.kinetic_over_elastic)});
    }
    table.write(request.table);
    if (!request.curve.empty()) points.write(request.curve);
    tool.report("frames", std::int64_t(chosen.size()));
    const auto report = [&](const char* key, const std::optional<double>& value) {
        if (value) tool.report(key, *value);
    };
    if (density.front()) tool.report("density_first", density.front()->density);
    if (density.back()) tool.report("density_last", density.back()->density);
    report("stiffness_level_last", last.min_stiffness_level);
    report("inertial_number_last", last.max_inertial_number);
    report("Q_last", last.kinetic_number);
    report("kinetic_over_elastic_last", last.kinetic_over_elastic);
    std::int64_t exceeded = warn_of_imbalance(frames.run(), curves, tool);
    exceeded += std::isfinite(frames.scene()->law().traits().max_heat)
                    ? heat.warn_above(heat_limit, tool)
                    : warn_of_leaving(curves, phases, packing.size(), diameter, tool);
    tool.report("limits_exceeded", exceeded);
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
