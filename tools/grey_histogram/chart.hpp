#pragma once
#include <filesystem>
#include <vector>

#include "core/volume/grey_histogram.hpp"

namespace tomodem::grey_histogram {

/// Draws a histogram with a logarithmic axis of counts and a vertical line at each threshold, as a PNG.
/// @throws InvalidInput if the picture cannot be written
void draw_histogram(const GreyHistogram& histogram, const std::vector<double>& thresholds,
                    const std::filesystem::path& picture, int threads);

}  // namespace tomodem::grey_histogram
