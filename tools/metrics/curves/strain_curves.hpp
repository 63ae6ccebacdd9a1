#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/packing/packing_file.hpp"

namespace tomodem::curves {

/// Macroscopic curves of a run at the points of its `strain` curve; all arrays have the same length, at least 2.
struct StrainCurves {
    std::vector<double> time;    ///< s, not decreasing
    std::vector<double> strain;  ///< true strain [-], negative in compression
    std::map<std::string, std::vector<double>> value;
};

/// A curve of the run and the unit it must have.
struct CurveName {
    std::string name, unit;
};

/// Reads the strain and the named curves; a curve with other times is interpolated linearly in time.
/// @throws InvalidInput naming the file and the curve: not there, another unit, not finite, fewer than two points
StrainCurves read_strain_curves(const std::filesystem::path& run, const std::vector<CurveName>& names);

/// A function given by points joined by straight lines.
class PiecewiseLinear {
 public:
    /// @param x  not decreasing, as long as y, at least one value
    PiecewiseLinear(std::span<const double> x, std::span<const double> y);
    double at(double x) const;
    /// Mean over from <= x <= to, both within the given points; the value where from = to.
    double mean(double from, double to) const;

 private:
    double integral_to(double x) const;
    std::size_t segment(double x) const;
    std::span<const double> x_, y_;
    std::vector<double> integral_;
};

/// A part of a loading history in which the strain moves in one direction: points first to last, both included.
struct Leg {
    std::size_t first, last;
};

/// Legs of a history; one leg begins with the point that ends the one before. A hold belongs to the leg it interrupts.
std::vector<Leg> legs(std::span<const double> strain);

/// Every point replaced by the mean, over `width` of strain around it, of time, strain and values.
///
/// The mean is over strain (trapezoidal), so that it does not depend on how densely the run was sampled. The window
/// does not reach beyond the leg of its point; strain and values are averaged over the same window, so a straight line
/// stays the same straight line up to its ends. A width of 0 returns the curves as they are.
StrainCurves averaged_over_strain(const StrainCurves& curves, double width);

/// Mean of the absolute value of a curve around a strain.
struct Plateau {
    double mean = 0.0;
    double deviation = 0.0;       ///< standard deviation of the points in the window (0 for fewer than two)
    double highest = 0.0;         ///< largest of the points in the window and the values at its ends
    double rate = 0.0;            ///< |d strain / d time| [1/s], from the two ends of the window
    double from = 0.0, to = 0.0;  ///< what the window covers [|strain|], increasing
};

/// The mean of |value| where |strain| is within `window` of `at`, when the strain gets there for the first time.
///
/// The window is cut off at the ends of the leg.
/// @param at, window  > 0, as absolute strains
/// @throws InvalidInput if no leg gets to `at`, to a tenth of the window, or its time stands still
Plateau plateau(const StrainCurves& curves, const std::string& name, double at, double window);

/// The same where |strain| is between `from` and `to`, the first time that the strain gets there.
/// @throws InvalidInput if the history has no leg that covers it, to a twentieth of the range
Plateau mean_between(const StrainCurves& curves, const std::string& name, double from, double to);

/// Largest |strain| of the history.
double largest_strain(const StrainCurves& curves);

/// |F_top + F_bottom| over the mean of |F_top| and |F_bottom|; the forces act on the sample, tension along z positive,
/// so that they cancel at equilibrium. None where both are zero.
std::optional<double> equilibrium_error(double force_top, double force_bottom);

/// Adds the curve `equilibrium_error` from `force_top` and `force_bottom`; points without any force are left out.
/// @throws InvalidInput if there is a force nowhere
StrainCurves equilibrium_errors(const StrainCurves& forces);

/// True strain at a frame: that of the curve at the frame's time, 0 for a sample (one frame and no curves).
/// @throws InvalidInput if a run has no curve of the strain
double frame_strain(const RunReader& run, std::size_t index);

}  // namespace tomodem::curves
