#include "tools/calibrate/calibration_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <tuple>

#include "core/base/error.hpp"
#include "core/packing/packing_file.hpp"
#include "core/scene/model.hpp"
#include "tools/metrics/curves/norton_regression.hpp"
#include "tools/metrics/curves/strain_curves.hpp"

namespace tomodem::calibrate {
using namespace curves;
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Of the stress that the window of strain is found from.
constexpr double smoothing = 0.04;

/// A wanted M above that of the steepest decade, or beside TRILIN's, by no more than this is given it.
constexpr double sensitivity_tolerance = 0.03;

/// The same number but for what was rounded on the way.
double rounded(double value) {
    return std::stod(fmt::format("{:.5g}", value));
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

/// Standard deviation over the mean; 0 of one value.
double spread_of(const std::vector<double>& values) {
    if (values.size() < 2) return 0;
    const double mean = mean_of(values);
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1)) / mean;
}

double most_common(const std::vector<MeasuredRun>& runs, const std::function<double(const MeasuredRun&)>& of) {
    std::map<double, int> counts;
    for (const MeasuredRun& run : runs) ++counts[of(run)];
    return std::max_element(counts.begin(), counts.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
}

/// Runs that differ by their packing alone.
struct Row {
    std::vector<const MeasuredRun*> runs;
    std::vector<double> flows() const {
        std::vector<double> values;
        for (const MeasuredRun* run : runs) values.push_back(run->flow);
        return values;
    }
    double flow() const { return mean_of(flows()); }
    double spread() const { return spread_of(flows()); }
};

/// Control, rate and direction; BILIN's flow depends on the rate by chi alone.
using RowKey = std::tuple<double, double, bool>;

std::map<RowKey, Row> rows_of(const std::vector<MeasuredRun>& runs, double particles, double strain_per_step) {
    std::map<RowKey, Row> rows;
    for (const MeasuredRun& run : runs) {
        if (run.particles != particles || (run.law == "bilin" && run.strain_per_step != strain_per_step)) continue;
        rows[{run.control, run.law == "norton" ? run.rate : 0, run.tension}].runs.push_back(&run);
    }
    return rows;
}

/// Largest change (with its sign) of the rows that both have, over those of the table; none in common: none.
std::optional<double> change(const std::map<RowKey, Row>& rows, const std::map<RowKey, Row>& table) {
    std::optional<double> largest;
    for (const auto& [key, row] : rows) {
        const auto same = table.find(key);
        if (same == table.end()) continue;
        const double ratio = row.flow() / same->second.flow() - 1;
        if (!largest || std::abs(ratio) > std::abs(*largest)) largest = ratio;
    }
    return largest;
}

/// |strain| around the flow strain over which the mean stress of every row keeps to its flow stress.
std::array<double, 2> strain_window(const std::map<RowKey, Row>& rows, const FitOptions& options) {
    const auto worst = [&](std::size_t k) {
        double largest = 0;
        for (const auto& [key, row] : rows) {
            std::vector<double> ratios;
            for (const MeasuredRun* run : row.runs)
                if (k >= run->ratio.size() || std::isnan(run->ratio[k]))
                    return std::numeric_limits<double>::infinity();
                else
                    ratios.push_back(run->ratio[k]);
            largest = std::max(largest, std::abs(mean_of(ratios) - 1));
        }
        return largest;
    };
    const auto centre = static_cast<std::size_t>(std::lround(options.where.at / ratio_spacing));
    std::size_t first = centre, last = centre;
    while (first > 0 && worst(first - 1) <= options.strain_error) --first;
    while (worst(last + 1) <= options.strain_error) ++last;
    return {rounded(static_cast<double>(first) * ratio_spacing), rounded(static_cast<double>(last) * ratio_spacing)};
}

std::map<RowKey, Row> in_direction(std::map<RowKey, Row> rows, bool tension) {
    std::erase_if(rows, [&](const auto& row) { return std::get<2>(row.first) != tension; });
    return rows;
}

struct Sweep {
    double particles = 0, strain_per_step = 0;
    std::map<RowKey, Row> rows;
};

/// Chooses what belongs to the table, and fills what every law has.
Sweep sweep_of(const std::vector<MeasuredRun>& runs, const FitOptions& options, CalibrationWindow& window) {
    Sweep sweep;
    sweep.particles = options.particles > 0 ? options.particles
                                            : most_common(runs, [](const MeasuredRun& run) { return run.particles; });
    if (runs.front().law == "bilin")
        sweep.strain_per_step = options.strain_per_step > 0
                                    ? rounded(options.strain_per_step)
                                    : most_common(runs, [](const MeasuredRun& run) { return run.strain_per_step; });
    sweep.rows = rows_of(runs, sweep.particles, sweep.strain_per_step);
    if (sweep.rows.empty())
        throw InvalidInput(fmt::format(
            "no run has {:g} particles{}; give another --particles or --strain-per-step", sweep.particles,
            sweep.strain_per_step > 0 ? fmt::format(" and a strain of {:g} in a time step", sweep.strain_per_step)
                                      : std::string()));
    const MeasuredRun& one = *sweep.rows.begin()->second.runs.front();
    window.packings = std::numeric_limits<int>::max();
    std::map<double, double> sizes;
    for (const MeasuredRun& run : runs) {
        if (run.crown != one.crown || run.stiffness_ratio != one.stiffness_ratio)
            throw InvalidInput(fmt::format("'{}' and '{}' have another crown or stiffness_ratio: make a table of each",
                                           one.file, run.file));
        if (const auto by_size = change(rows_of(runs, run.particles, sweep.strain_per_step), sweep.rows))
            sizes[run.particles] = *by_size;
    }
    for (const auto& [particles, by_size] : sizes) {
        window.particles.push_back(particles);
        window.size.push_back(by_size);
    }
    for (const auto& [key, row] : sweep.rows)
        window.packings = std::min(window.packings, static_cast<int>(row.runs.size()));
    window.density = one.density;
    const std::map<RowKey, Row> compression = in_direction(sweep.rows, false), tension = in_direction(sweep.rows, true);
    if (compression.empty()) throw InvalidInput("no run presses: a table needs compression, tension is the rest");
    window.strain = strain_window(compression, options);
    if (!tension.empty()) window.strain_tension = strain_window(tension, options);
    window.strain_error = options.strain_error;
    if (one.law == "norton") return sweep;
    window.crown = one.crown;
    window.stiffness_ratio = one.stiffness_ratio;
    return sweep;
}

/// Of each chi, the largest change by another time step; those that were not looked at lie between their neighbours.
std::vector<double> time_step_errors(const std::vector<MeasuredRun>& runs, const Sweep& sweep,
                                     BilinCalibration& found) {
    std::map<double, double> looked_at;  // by the logarithm of chi
    for (const MeasuredRun& run : runs) {
        if (run.particles != sweep.particles || run.strain_per_step == sweep.strain_per_step) continue;
        for (const auto& [key, row] : rows_of(runs, run.particles, run.strain_per_step)) {
            const auto same = sweep.rows.find(key);
            if (same == sweep.rows.end()) continue;
            double& error = looked_at[std::log(std::get<0>(key))];
            error = std::max(error, std::abs(row.flow() / same->second.flow() - 1));
            found.strain_per_step[0] = std::min(found.strain_per_step[0], run.strain_per_step);
            found.strain_per_step[1] = std::max(found.strain_per_step[1], run.strain_per_step);
        }
    }
    if (looked_at.empty()) return std::vector<double>(found.curve.chi.size(), 0.0);
    std::vector<double> x, y, errors;
    for (const auto& [chi, error] : looked_at) {
        x.push_back(chi);
        y.push_back(error);
    }
    const PiecewiseLinear between(x, y);
    for (const double chi : found.curve.chi)
        errors.push_back(between.at(std::clamp(std::log(chi), x.front(), x.back())));
    return errors;
}

BilinCalibration fit_bilin(const std::vector<MeasuredRun>& runs, const FitOptions& options) {
    BilinCalibration found;
    const Sweep sweep = sweep_of(runs, options, found);
    for (const auto& [key, row] : sweep.rows) {
        found.curve.chi.push_back(std::get<0>(key));
        found.curve.flow.push_back(row.flow());
        found.spread.push_back(row.spread());
    }
    if (found.curve.chi.size() < 2)
        throw InvalidInput(
            "the runs of law \"bilin\" have one chi: a master curve needs two or more, better over three decades");
    double steepest = 0;
    for (const double chi : found.curve.chi) steepest = std::max(steepest, found.curve.sensitivity(chi));
    found.curve.max_sensitivity = steepest + sensitivity_tolerance;
    found.strain_per_step = {sweep.strain_per_step, sweep.strain_per_step};
    found.time_step_error = time_step_errors(runs, sweep, found);
    return found;
}

/// Largest deviation of a row from what the law says of it, with twice its spread beside.
DirectedErrors errors_of(const std::map<RowKey, Row>& rows, const std::function<double(double)>& law) {
    DirectedErrors found;
    for (const auto& [key, row] : rows) {
        std::optional<double>& error = std::get<2>(key) ? found.tension : found.compression;
        error = std::max(error.value_or(0), std::abs(row.flow() / law(std::get<0>(key)) - 1) + 2 * row.spread());
    }
    return found;
}

TrilinCalibration fit_trilin(const std::vector<MeasuredRun>& runs, const FitOptions& options) {
    TrilinCalibration found;
    const Sweep sweep = sweep_of(runs, options, found);
    std::map<double, std::vector<double>> directions;
    for (const auto& [key, row] : sweep.rows) directions[std::get<0>(key)].push_back(row.flow());
    std::vector<double> rates, flows;
    for (const auto& [rate, both] : directions) {
        rates.push_back(rate);
        flows.push_back(mean_of(both));
    }
    if (rates.size() < 2)
        throw InvalidInput("the runs of law \"trilin\" have one rate times period: its M needs two or more");
    const NortonFit fit = norton_fit(rates, flows);
    found.flow = {fit.K, fit.M, sensitivity_tolerance};
    found.rate = {rates.front(), rates.back()};
    found.error = errors_of(sweep.rows, [&](double rate) { return found.flow.at(rate); });
    return found;
}

NortonCalibration fit_norton(const std::vector<MeasuredRun>& runs, const FitOptions& options) {
    NortonCalibration found;
    const Sweep sweep = sweep_of(runs, options, found);
    std::vector<double> flows, rates;
    for (const auto& [key, row] : sweep.rows) {
        flows.push_back(row.flow());
        rates.push_back(std::get<1>(key));
    }
    found.flow = mean_of(flows);
    found.sensitivity = {std::get<0>(sweep.rows.begin()->first), std::get<0>(sweep.rows.rbegin()->first)};
    const auto [low, high] = std::minmax_element(rates.begin(), rates.end());
    found.rate_ratio = rounded(*high / *low);
    found.error = errors_of(sweep.rows, [&](double) { return found.flow; });
    return found;
}

}  // namespace

MeasuredRun measure_run(const std::filesystem::path& path, const FlowStrain& where) {
    const auto fail = [&](const std::string& what) {
        throw InvalidInput(fmt::format("'{}': {}", path.string(), what));
    };
    const RunReader reader(path);
    if (reader.provenance().scene.empty()) fail("the file holds no scene; give runs that solve wrote");
    const Scene scene = parse_stored_scene(reader.provenance().scene, "of " + path.string());
    if (scene.phases.size() != 1) fail("a calibration is of one phase, its scene has several");
    const Phase& phase = scene.phases.front();
    if (phase.hardening) fail("a calibration is of a material that does not harden in time");
    if (scene.steps.empty()) fail("its scene has no steps in [load]");
    for (const LoadStep& step : scene.steps)
        if (step.rate.size() > 1 || step.rate.front() != scene.steps.front().rate.front())
            fail("a calibration is of runs at one rate each");
    const Model model = compile_model(scene, reader.packing());
    const StrainCurves curves = read_strain_curves(path, {{"stress_true", "Pa"}});
    Plateau plateau;
    try {
        plateau = curves::plateau(curves, "stress_true", where.at, where.window);
    } catch (const InvalidInput& error) {
        fail(error.what());
    }
    const PhaseModel& constants = model.phases.front();
    const double rate = scene.highest_rate();
    MeasuredRun run;
    run.file = path.string();
    run.law = scene.law().name();
    run.tension = scene.steps.back().strain > 0;
    run.particles = static_cast<double>(reader.packing().size());
    run.density = reader.packing().density();
    run.crown = rounded(scene.crown_radius / scene.seed_radius);
    run.stiffness_ratio = rounded(phase.stiffness_ratio);
    run.rate = rounded(rate);
    run.strain_per_step = rounded(rate * model.time_step);
    if (run.law == "norton") {
        run.control = phase.norton->rate_sensitivity;
        // The law was given K over the flow of the table that it used.
        run.flow = plateau.mean / (phase.norton->stress(rate) * pascal_per_megapascal) *
                   scene.flow_table().find<NortonCalibration>()->flow;
    } else {
        run.control = rounded(run.law == "bilin" ? constants.chi : rate * constants.natural_period);
        run.flow = plateau.mean * 2 * model.seed_radius / constants.pair.repulsive_stiffness;
    }
    for (double strain = 0; strain <= largest_strain(curves); strain += ratio_spacing) {
        double ratio = missing;
        try {
            ratio = curves::plateau(curves, "stress_true", std::max(strain, ratio_spacing / 2), smoothing / 2).mean /
                    plateau.mean;
        } catch (const InvalidInput&) {  // before the strain of a leg that came later
        }
        run.ratio.push_back(ratio);
    }
    return run;
}

Calibration fit_calibration(const std::vector<MeasuredRun>& runs, const FitOptions& options) {
    Calibration found;
    found.name = options.name;
    const auto of = [&](const char* law) {
        std::vector<MeasuredRun> some;
        std::copy_if(runs.begin(), runs.end(), std::back_inserter(some), [&](auto& run) { return run.law == law; });
        return some;
    };
    if (const auto some = of("bilin"); !some.empty()) found.add(fit_bilin(some, options));
    if (const auto some = of("trilin"); !some.empty()) found.add(fit_trilin(some, options));
    if (const auto some = of("norton"); !some.empty()) found.add(fit_norton(some, options));
    return found;
}

}  // namespace tomodem::calibrate
