#include <algorithm>

#include "core/volume/reading/reading.hpp"

namespace tomodem::formats {
namespace {

/// A file name cut into text and numbers: "img_007.tif" -> {"img_", 7, ".tif"}.
struct NumberedName {
    fs::path path;
    std::vector<std::string> texts;
    std::vector<std::uint64_t> numbers;

    std::string text() const { return path.filename().string(); }
};

NumberedName cut_name(const fs::path& path) {
    NumberedName name{path, {""}, {}};
    const std::string stem = path.stem().string();
    for (std::size_t i = 0; i < stem.size();) {
        if (!std::isdigit(static_cast<unsigned char>(stem[i]))) {
            name.texts.back() += stem[i++];
            continue;
        }
        std::uint64_t number = 0;
        for (; i < stem.size() && std::isdigit(static_cast<unsigned char>(stem[i])); ++i)
            number = number > 99'999'999'999'999'999 ? number : number * 10 + (stem[i] - '0');
        name.numbers.push_back(number);
        name.texts.emplace_back();
    }
    return name;
}

/// Which of the numbers in the names counts the slices.
std::size_t slice_number_of(const std::vector<NumberedName>& names, const std::string& series) {
    const NumberedName& model = names.front();
    std::size_t slice_number = model.numbers.empty() ? 0 : model.numbers.size() - 1;
    bool found = false;
    for (const auto& name : names) {
        if (name.texts != model.texts)
            cannot_read(series, fmt::format("'{}' and '{}' are not slices of one series; put each series into a folder "
                                            "of its own",
                                            model.text(), name.text()));
        for (std::size_t i = 0; i < name.numbers.size(); ++i) {
            if (name.numbers[i] == model.numbers[i]) continue;
            if (found && i != slice_number)
                cannot_read(series,
                            fmt::format("the names of the slices differ in more than one number ('{}' and '{}'); "
                                        "put each series into a folder of its own",
                                        model.text(), name.text()));
            found = true;
            slice_number = i;
        }
    }
    return slice_number;
}

}  // namespace

std::vector<fs::path> in_order_of_numbers(std::vector<fs::path> files, const std::string& series) {
    if (files.size() < 2) return files;
    std::vector<NumberedName> names;
    std::sort(files.begin(), files.end());
    for (const auto& file : files) names.push_back(cut_name(file));
    const std::size_t slice_number = slice_number_of(names, series);
    if (names.front().numbers.empty())
        cannot_read(series, "the names of the slices have no number; number them from 0");

    const auto number = [slice_number](const NumberedName& name) { return name.numbers[slice_number]; };
    std::sort(names.begin(), names.end(), [&](const auto& a, const auto& b) { return number(a) < number(b); });
    for (std::size_t i = 1; i < names.size(); ++i) {
        const std::uint64_t before = number(names[i - 1]), now = number(names[i]);
        if (now == before)
            cannot_read(series,
                        fmt::format("'{}' and '{}' have the same number", names[i - 1].text(), names[i].text()));
        if (now == before + 2)
            cannot_read(series, fmt::format("slice number {} is missing (between '{}' and '{}')", before + 1,
                                            names[i - 1].text(), names[i].text()));
        if (now > before + 2)
            cannot_read(series, fmt::format("slice numbers {} to {} are missing (between '{}' and '{}')", before + 1,
                                            now - 1, names[i - 1].text(), names[i].text()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) files[i] = names[i].path;
    return files;
}

}  // namespace tomodem::formats
