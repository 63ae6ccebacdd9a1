#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/volume/reading/reading.hpp"

namespace tomodem::formats {

void cannot_read(const fs::path& path, const std::string& why) {
    throw InvalidInput(fmt::format("cannot read volume '{}': {}", path.string(), why));
}

void check_size(const fs::path& path, const std::array<std::int64_t, 3>& size) {
    constexpr std::int64_t longest = 1 << 20;
    for (const std::int64_t edge : size)
        if (edge < 1 || edge > longest)
            cannot_read(path, fmt::format("it is {} x {} x {} voxels by its header; each edge must be 1 to {}", size[0],
                                          size[1], size[2], longest));
    constexpr double most = 1e12;
    if (static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) > most)
        cannot_read(path, fmt::format("it is {} x {} x {} voxels by its header; at most {:g} are read", size[0],
                                      size[1], size[2], most));
}

std::string first_bytes(const fs::path& path, std::size_t count) {
    std::ifstream file(path, std::ios::binary);
    if (!file) cannot_read(path, "it cannot be opened; check its permissions");
    std::string bytes(count, '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

std::int64_t file_bytes(const fs::path& path) {
    std::error_code error;
    const auto bytes = fs::file_size(path, error);
    if (error) cannot_read(path, error.message());
    return static_cast<std::int64_t>(bytes);
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

std::string trimmed(const std::string& text) {
    constexpr const char* blank = " \t\r\n";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

double number_in(const fs::path& path, const std::string& field, const std::string& text) {
    double value = 0;
    const std::string word = trimmed(text);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        cannot_read(path, fmt::format("{} is '{}' in its header, which is not a number", field, word.substr(0, 60)));
    return value;
}

std::int64_t whole_number_in(const fs::path& path, const std::string& field, const std::string& text) {
    const double value = number_in(path, field, text);
    if (value != std::floor(value) || std::abs(value) > 1e15)
        cannot_read(path, fmt::format("{} is {:g} in its header, expected a whole number", field, value));
    return static_cast<std::int64_t>(value);
}

std::optional<double> length_unit(const std::string& name) {
    static const std::map<std::string, double> units{
        {"nm", 1e-6},         {"nanometer", 1e-6},  {"nanometre", 1e-6}, {"um", 1e-3},         {"µm", 1e-3},
        {"μm", 1e-3},         {"\xb5m", 1e-3},      {"\\u00b5m", 1e-3},  {"micron", 1e-3},     {"microns", 1e-3},
        {"micrometer", 1e-3}, {"micrometre", 1e-3}, {"mm", 1.0},         {"millimeter", 1.0},  {"millimetre", 1.0},
        {"cm", 10.0},         {"centimeter", 10.0}, {"inch", 25.4},      {"centimetre", 10.0}, {"m", 1e3},
        {"meter", 1e3},       {"metre", 1e3}};
    const auto found = units.find(lower_case(trimmed(name)));
    if (found == units.end()) return {};
    return found->second;
}

}  // namespace tomodem::formats
