#include "tools/plan/trade_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <Eigen/Dense>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/toml_reader.hpp"
#include "tools/plan/text_file.hpp"
#include "tools/plan/toml_text.hpp"

namespace tomodem::plan {
namespace {

constexpr const char* base_filter = "level-set";
constexpr const char* not_survived = "none";
/// Rate of the load over the one of the constants: the sweeps have these.
constexpr double own_rate = 1, slow_rate = 0.1;
/// Two time steps that differ by less are the same one.
constexpr double same_time_step = 0.01;

/// Measured quantities that one of the table is made of.
std::vector<std::string> parts_of(Quantity quantity) {
    if (quantity == Quantity::pore_volume) return {"pore_start", "pore_pressed"};
    return {name_of(quantity)};
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard deviation; 0 of one value.
double spread_of(const std::vector<double>& values) {
    if (values.size() < 2) return 0;
    const double mean = mean_of(values);
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// Slope of the straight line of least squares; 0 where all x are one.
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
    const double mean_x = mean_of(x), mean_y = mean_of(y);
    double both = 0, squares = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        both += (x[k] - mean_x) * (y[k] - mean_y);
        squares += (x[k] - mean_x) * (x[k] - mean_x);
    }
    return squares > 0 ? both / squares : 0;
}

/// Each at least as large as those behind it.
void let_fall(std::vector<double>& values) {
    for (std::size_t k = values.size(); k-- > 1;) values[k - 1] = std::max(values[k - 1], values[k]);
}

using Rows = std::vector<const SweepRow*>;

std::vector<double> of_each(const Rows& rows, const std::function<double(const SweepRow&)>& value) {
    std::vector<double> values;
    for (const SweepRow* row : rows) values.push_back(value(*row));
    return values;
}

/// Which rows: what is not given may be anything.
struct Wanted {
    std::optional<std::string> law = {};
    std::vector<std::string> quantities = {};
    std::optional<double> size = {}, step = {}, rate = {};
    bool base_filter_only = false;
    std::string scene = {};
    bool has(const SweepRow& row) const {
        const auto is = [](const auto& wanted, const auto& value) { return !wanted || *wanted == value; };
        return is(law, row.law) && is(size, row.size) && is(step, row.step) && is(rate, row.rate) &&
               (!base_filter_only || row.filter == base_filter) && (scene.empty() || row.scene == scene) &&
               (quantities.empty() || std::count(quantities.begin(), quantities.end(), row.quantity) > 0);
    }
};

class Sweep {
 public:
    Sweep(const std::vector<SweepRow>& rows, const References& references) : rows_(rows), references_(references) {}

    Rows of(const Wanted& wanted) const {
        Rows found;
        for (const SweepRow& row : rows_)
            if (wanted.has(row)) found.push_back(&row);
        return found;
    }

    std::optional<TradeCurve> curve(Quantity quantity, const std::string& law) const {
        const std::vector<std::string> parts = parts_of(quantity);
        Wanted measured{.law = law, .quantities = parts, .rate = own_rate, .base_filter_only = true};
        const Rows rows = of(measured);
        if (rows.empty()) return {};
        const double base = base_step(rows);
        const Rows failed =
            of({.law = law, .quantities = {not_survived}, .rate = own_rate, .scene = rows.front()->scene});

        // A size that some packing does not survive at the base step is none to propose, nor is a step that does not
        // hold the other sizes.
        std::set<double> sizes, steps;
        for (const SweepRow* row : rows) {
            if (row->step == base) sizes.insert(row->size);
            steps.insert(row->step);
        }
        for (const SweepRow* row : failed)
            if (row->step == base) sizes.erase(row->size);
        if (sizes.empty()) return {};
        for (const SweepRow* row : failed)
            if (sizes.contains(row->size)) steps.erase(row->step);

        TradeCurve curve;
        curve.resolution.assign(sizes.begin(), sizes.end());
        measured.step = base;
        for (const double size : sizes) {
            double bias = 0, spread = 0;
            for (const std::string& part : parts) {
                measured.quantities = {part};
                measured.size = size;
                const std::vector<double> found = errors(measured);
                bias = std::max(bias, std::abs(mean_of(found)));
                spread = std::max(spread, spread_of(found));
            }
            curve.bias.push_back(bias);
            curve.spread.push_back(spread);
        }
        let_fall(curve.spread);
        if (quantity != Quantity::flow_stress) let_fall(curve.bias);
        curve.step.assign(steps.begin(), steps.end());
        curve.step_error = step_errors(parts, law, base, curve.step);
        curve.rate_error = rate_error(parts, law, base);
        curve.particle_step =
            median_of(of_each(rows, [](const SweepRow& row) { return row.cpu_solve / row.particles / row.steps; }));
        curve.bytes = memory(rows, law);
        curve.prepare = prepare_cost(rows);
        return curve;
    }

 private:
    /// The step of the sweep over sizes: that of most rows, of those the smallest.
    static double base_step(const Rows& rows) {
        std::map<double, int> counts;
        for (const SweepRow* row : rows) ++counts[row->step];
        return std::max_element(counts.begin(), counts.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; })
            ->first;
    }

    /// The right value; of what has no reference the mean of the finest step of the finest size of NORTON.
    double truth(const std::string& part, double rate) const {
        if (const auto known = references_.find(part); known != references_.end())
            if (const auto value = known->second.find(rate); value != known->second.end()) return value->second;
        Wanted wanted{.law = "norton", .quantities = {part}};
        if (of(wanted).empty()) wanted.law = rows_.front().law;
        wanted.rate = rate;
        wanted.base_filter_only = true;
        const Rows rows = of(wanted);
        if (rows.empty())
            throw InvalidInput(
                fmt::format("'{}' has no reference at the rate {:g}, and no run of law \"{}\" to count its errors from",
                            part, rate, *wanted.law));
        const auto fineness = [](const SweepRow* row) { return std::pair(row->size, -row->step); };
        const auto finest = fineness(*std::max_element(
            rows.begin(), rows.end(), [&](const auto* a, const auto* b) { return fineness(a) < fineness(b); }));
        std::vector<double> values;
        for (const SweepRow* row : rows)
            if (fineness(row) == finest) values.push_back(row->value);
        return mean_of(values);
    }

    /// Error of each packing, as a share with its sign; of one measured quantity.
    std::vector<double> errors(const Wanted& wanted) const {
        const std::string& part = wanted.quantities.front();
        const double right = truth(part, wanted.rate.value_or(own_rate));
        std::vector<double> found = of_each(of(wanted), [&](const SweepRow& row) { return row.value / right - 1; });
        if (found.empty())
            throw InvalidInput(fmt::format("no run of law \"{}\" measured '{}' at size {:g}, step {:g} and rate {:g}",
                                           *wanted.law, part, wanted.size.value_or(0), wanted.step.value_or(0),
                                           wanted.rate.value_or(own_rate)));
        return found;
    }

    /// What a step changes against the base one in the same samples, in the finest size that has both and where it is
    /// another time step; 0 where there is none.
    double change(const std::string& part, const std::string& law, double step, double base) const {
        std::map<double, std::array<std::map<std::string, const SweepRow*>, 2>, std::greater<>> sizes;
        for (const SweepRow* row : of({.law = law, .quantities = {part}, .rate = own_rate, .base_filter_only = true})) {
            if (row->step == step) sizes[row->size][0][row->packing] = row;
            if (row->step == base) sizes[row->size][1][row->packing] = row;
        }
        for (const auto& [size, both] : sizes) {
            std::vector<double> changes;
            for (const auto& [packing, row] : both[0]) {
                const auto other = both[1].find(packing);
                if (other != both[1].end() && std::abs(row->time_step / other->second->time_step - 1) > same_time_step)
                    changes.push_back(row->value / other->second->value - 1);
            }
            if (!changes.empty()) return std::abs(mean_of(changes));
        }
        return 0;
    }

    /// The largest over what was measured; further from the base step it is no smaller.
    ///
    /// Where errors are counted from NORTON itself, its base step has the error that the finest one takes away.
    std::vector<double> step_errors(const std::vector<std::string>& parts, const std::string& law, double base,
                                    const std::vector<double>& steps) const {
        std::vector<double> found;
        for (const double step : steps) {
            double largest = 0;
            for (const std::string& part : parts) largest = std::max(largest, change(part, law, step, base));
            found.push_back(largest);
        }
        const auto at = static_cast<std::size_t>(std::find(steps.begin(), steps.end(), base) - steps.begin());
        for (std::size_t k = at; k-- > 1;) found[k - 1] = std::max(found[k - 1], found[k]);
        found[at] = 0;
        for (std::size_t k = at + 2; k < found.size(); ++k) found[k] = std::max(found[k], found[k - 1]);
        const bool known = std::all_of(parts.begin(), parts.end(),
                                       [&](const std::string& part) { return references_.contains(part); });
        if (law == "norton" && !known) {
            const double of_base = found.front();
            for (std::size_t k = 0; k < found.size(); ++k) found[k] = k < at ? of_base - found[k] : of_base + found[k];
        }
        return found;
    }

    /// What has to be added, as a square, to the mean error at the rate of the constants to have that at a tenth of it.
    std::optional<double> rate_error(const std::vector<std::string>& parts, const std::string& law, double base) const {
        std::optional<double> largest;
        for (const std::string& part : parts) {
            std::set<double> sizes;
            for (const SweepRow* row : of({.law = law, .quantities = {part}, .rate = slow_rate}))
                sizes.insert(row->size);
            for (const double size : sizes) {
                const auto mean_error = [&](double rate) {
                    return mean_of(errors({.law = law,
                                           .quantities = {part},
                                           .size = size,
                                           .step = base,
                                           .rate = rate,
                                           .base_filter_only = true}));
                };
                const double slow = mean_error(slow_rate), fast = mean_error(own_rate);
                largest = std::max(largest.value_or(0), std::sqrt(std::max(0.0, slow * slow - fast * fast)));
            }
        }
        return largest;
    }

    /// Bytes without particles, and of each particle: those of dense samples, as an image's own share hides them
    /// elsewhere.
    std::array<double, 2> memory(const Rows& rows, const std::string& law) const {
        Rows dense = of({.law = law, .quantities = {name_of(Quantity::flow_stress)}});
        if (dense.empty()) dense = rows;
        const auto particles = [](const SweepRow& row) { return row.particles; };
        const auto bytes = [](const SweepRow& row) { return row.peak_bytes; };
        const double each = std::max(0.0, slope_of(of_each(dense, particles), of_each(dense, bytes)));
        const std::vector<double> rest =
            of_each(rows, [&](const SweepRow& row) { return row.peak_bytes - each * row.particles; });
        return {*std::max_element(rest.begin(), rest.end()), each};
    }

    /// a and b of CPU seconds a + b N (N / 1000)^(1/3), with the least squares of the relative errors: a relaxation
    /// takes as many periods as the sample is wide.
    static std::array<double, 2> prepare_cost(const Rows& rows) {
        Eigen::MatrixX2d terms(rows.size(), 2);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double particles = rows[k]->particles, seconds = rows[k]->cpu_prepare;
            terms.row(static_cast<Eigen::Index>(k)) << 1 / seconds, particles * std::cbrt(particles / 1000) / seconds;
        }
        // Of the smallest norm where all samples have one size.
        const Eigen::Vector2d cost = terms.completeOrthogonalDecomposition().solve(Eigen::VectorXd::Ones(terms.rows()));
        if (cost[0] >= 0 && cost[1] >= 0) return {cost[0], cost[1]};
        return {0, terms.col(1).sum() / terms.col(1).squaredNorm()};
    }

    const std::vector<SweepRow>& rows_;
    const References& references_;
};

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    for (std::size_t begin = 0;;) {
        const std::size_t end = line.find(',', begin);
        cells.push_back(line.substr(begin, end - begin));
        if (end == std::string::npos) return cells;
        begin = end + 1;
    }
}

std::string list(const std::vector<double>& values) {
    std::vector<std::string> words;
    for (const double value : values) words.push_back(fmt::format("{:.4g}", value));
    return fmt::format("[{}]", fmt::join(words, ", "));
}

}  // namespace

std::vector<SweepRow> read_sweep(const std::filesystem::path& table) {
    std::istringstream text(read_text(table));
    std::string line;
    std::getline(text, line);
    const auto without_return = [](std::string& one) {
        if (one.ends_with('\r')) one.pop_back();
    };
    without_return(line);
    const std::vector<std::string> head = cells_of(line);
    std::vector<SweepRow> rows;
    for (int number = 2; std::getline(text, line); ++number) {
        without_return(line);
        if (line.empty()) continue;
        const std::vector<std::string> cells = cells_of(line);
        const auto fail = [&](const std::string& what) {
            throw InvalidInput(fmt::format("results '{}' line {}: {}", table.string(), number, what));
        };
        if (cells.size() != head.size()) fail(fmt::format("{} cells below {} names", cells.size(), head.size()));
        const auto word = [&](const std::string& name) -> const std::string& {
            const auto at = std::find(head.begin(), head.end(), name);
            if (at == head.end()) fail(fmt::format("there is no column '{}'", name));
            return cells[static_cast<std::size_t>(at - head.begin())];
        };
        const auto value = [&](const std::string& name) {
            const std::string& cell = word(name);
            if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
            double found = 0;
            const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), found);
            if (error != std::errc() || end != cell.data() + cell.size())
                fail(fmt::format("{} '{}' is not a number", name, cell));
            return found;
        };
        if (find_law(word("law")) == nullptr) fail(fmt::format("there is no law '{}'", word("law")));
        rows.push_back({.scene = word("scene"),
                        .law = word("law"),
                        .size = value("size"),
                        .step = value("step"),
                        .rate = value("rate"),
                        .filter = word("filter"),
                        .packing = word("packing"),
                        .quantity = word("quantity"),
                        .value = value("value"),
                        .particles = value("particles"),
                        .steps = value("steps"),
                        .time_step = value("time_step"),
                        .cpu_solve = value("cpu_solve"),
                        .cpu_prepare = value("cpu_prepare"),
                        .peak_bytes = value("peak_bytes")});
    }
    if (rows.empty()) throw InvalidInput(fmt::format("results '{}' have no rows", table.string()));
    return rows;
}

References read_references(const std::filesystem::path& file) {
    const std::string name = fmt::format("references '{}'", file.string());
    References references;
    const toml::table root = parse_toml(read_text(file), name);
    TomlReader all(root, "", name);
    for (const auto& [key, node] : root) {
        const std::string quantity(key.str());
        auto reader = all.table(quantity);
        if (!reader) continue;
        reader->text("source");
        for (const auto& [rate, value] : *node.as_table()) {
            if (rate.str() == "source") continue;
            const std::string text(rate.str());
            double number = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (error != std::errc() || end != text.data() + text.size())
                reader->fail(value, fmt::format("'{}' in [{}] is not a rate", text, quantity));
            references[quantity][number] = reader->number(text);
        }
        reader->refuse_unknown();
    }
    return references;
}

TradeTable fit_trade(const std::vector<SweepRow>& rows, const References& references,
                     const std::map<std::string, double>& densities) {
    const Sweep sweep(rows, references);
    TradeTable table;
    for (const auto& [law, density] : densities) {
        LawTrade trade{density, {}};
        for (const Quantity quantity : quantities)
            if (auto curve = sweep.curve(quantity, law)) trade.curve[quantity] = std::move(*curve);
        if (!trade.curve.empty()) table.law[law] = std::move(trade);
    }
    if (table.law.empty())
        throw InvalidInput("no law of --densities has runs that a table could be made of; run more of the sweep");
    return table;
}

std::string trade_text(const TradeTable& table) {
    std::string text = fmt::format(
        "# What accuracy costs, measured by pipelines/trade: docs/trade.md says what each key means.\n"
        "[trade]\nformat = 1\nname = \"{}\"\nprocessor = \"{}\"   # whose seconds these are\n",
        table.name, table.processor);
    for (const Law* known : laws()) {
        const auto held = table.law.find(known->name());
        if (held == table.law.end()) continue;
        const auto& [law, trade] = *held;
        text += fmt::format("\n[trade.{}]\ndensity = {:g}\n", law, trade.density);
        for (const Quantity quantity : quantities) {
            const auto found = trade.curve.find(quantity);
            if (found == trade.curve.end()) continue;
            const TradeCurve& curve = found->second;
            text +=
                fmt::format("\n[trade.{}.{}]\nresolution = {}\nbias = {}\nspread = {}\nstep = {}\nstep_error = {}\n",
                            law, name_of(quantity), list(curve.resolution), list(curve.bias), list(curve.spread),
                            list(curve.step), list(curve.step_error));
            if (curve.rate_error) text += fmt::format("rate_error = {:.3g}\n", *curve.rate_error);
            text += fmt::format("particle_step = {:.3g}\nbytes = {}\nprepare = {}\n", curve.particle_step,
                                list({curve.bytes[0], curve.bytes[1]}), list({curve.prepare[0], curve.prepare[1]}));
        }
    }
    return text;
}

}  // namespace tomodem::plan
