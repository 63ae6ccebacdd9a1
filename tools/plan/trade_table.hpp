#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

/// What accuracy costs, as measured (docs/trade.md): errors of what a simulation is made for, against resolution and
/// time step of each law, and what a step of it takes.
namespace tomodem::plan {

/// What a user may want to be right.
enum class Quantity {
    flow_stress,       ///< of one dense material; resolution counts the particles of the sample
    composite_stress,  ///< engineering stress of two phases; particles across an object, as the next
    shape_factor,      ///< of the objects of a phase
    pore_volume,       ///< of closed pores, at the start and pressed; particles across a pore
    foam_stress,       ///< particles across a strut
};
inline constexpr std::array quantities{Quantity::flow_stress, Quantity::composite_stress, Quantity::shape_factor,
                                       Quantity::pore_volume, Quantity::foam_stress};
const char* name_of(Quantity quantity);
bool is_stress(Quantity quantity);

/// An error in the parts that have nothing to do with each other; shares of the quantity.
struct ErrorParts {
    double resolution = 0;  ///< of the mean over packings
    double time_step = 0;
    double packings = 0;  ///< twice the standard deviation from one packing to another
    double rates = 0;     ///< where the rate of the load falls below the one that constants are chosen for
    /// Root of the sum of their squares: what 19 runs of 20 keep within.
    double total() const;
    /// Name of the largest part, in words.
    const char* largest() const;
};

/// Errors of one quantity under one law.
struct TradeCurve {
    std::vector<double> resolution;    ///< rising
    std::vector<double> bias, spread;  ///< of each: |mean error| and standard deviation over the packings
    std::vector<double> step,
        step_error;  ///< rising: strain_per_step; and what it changes
    /// Where the rate falls to a tenth of the one that constants are chosen for; none: not measured.
    std::optional<double> rate_error;
    double particle_step = 0;  ///< CPU time of a particle in one computation of all pair forces (an explicit step) [s]
    std::array<double, 2> bytes{0, 0};    ///< of memory, at most: of an empty process, and of each particle
    std::array<double, 2> prepare{0, 0};  ///< CPU time of filling and relaxing: a + b N (N / 1000)^(1/3) [s]

    /// Straight between the points in the logarithm of resolution and step, constant beyond the finest ones.
    /// @throws std::out_of_range beyond the coarsest ones: nothing is known there
    ErrorParts error(double at_resolution, double at_step) const;
};

struct LawTrade {
    double density = 0;  ///< D of the brick
    std::map<Quantity, TradeCurve> curve;
};

struct TradeTable {
    std::string name, processor;
    std::map<std::string, LawTrade, std::less<>> law;
};

/// @param file  stands for the text in errors
/// @throws InvalidInput with the line: syntax, unknown or missing key, lists that do not fit together, wrong range
TradeTable parse_trade(const std::string& text, const std::string& file);

/// The one that tomodem ships (tools/plan/trade.toml).
const TradeTable& shipped_trade();

}  // namespace tomodem::plan
