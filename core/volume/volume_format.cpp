#include "core/volume/volume_format.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace tomodem {
namespace {

std::vector<VolumeFormat>& registry() {
    static std::vector<VolumeFormat> formats;
    return formats;
}

}  // namespace

RegisteredFormat::RegisteredFormat(VolumeFormat format) {
    // Sorted: the order of the sources in the program must not matter.
    const auto after = std::upper_bound(registry().begin(), registry().end(), format,
                                        [](const auto& a, const auto& b) { return a.name < b.name; });
    registry().insert(after, std::move(format));
}

const std::vector<VolumeFormat>& volume_formats() {
    return registry();
}

std::string volume_format_names() {
    std::vector<std::string> names;
    for (const VolumeFormat& format : volume_formats()) names.push_back(format.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace tomodem
