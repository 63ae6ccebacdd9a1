#include "core/cli/frames_cli.hpp"

#include <fmt/format.h>

#include <charconv>
#include <numeric>

#include "core/base/error.hpp"

namespace tomodem::cli {
namespace {

std::size_t frame_number(const char* flag, const char* words, std::string_view choice, std::size_t frame_count) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), index);
    if (error != std::errc{} || end != choice.data() + choice.size())
        throw WrongUsage(fmt::format("{} '{}': give {} or a number from 0", flag, choice, words));
    if (index >= frame_count)
        throw InvalidInput(fmt::format("{} {}: the file has frames 0 to {}", flag, index, frame_count - 1));
    return index;
}

}  // namespace

std::vector<std::size_t> chosen_frames(std::string_view choice, std::size_t frame_count) {
    if (choice == "first") return {0};
    if (choice == "last") return {frame_count - 1};
    if (const std::size_t comma = choice.find(','); comma != std::string_view::npos) {
        std::vector<std::size_t> frames = chosen_frames(choice.substr(0, comma), frame_count);
        const std::vector<std::size_t> others = chosen_frames(choice.substr(comma + 1), frame_count);
        if (frames.back() >= others.front())
            throw WrongUsage(fmt::format("--frames: {} comes before {}; give each frame once, in increasing order",
                                         frames.back(), others.front()));
        frames.insert(frames.end(), others.begin(), others.end());
        return frames;
    }
    if (choice == "all") {
        std::vector<std::size_t> frames(frame_count);
        std::iota(frames.begin(), frames.end(), 0);
        return frames;
    }
    return {frame_number("--frames", "all, first, last", choice, frame_count)};
}

std::size_t chosen_frame(std::string_view choice, std::size_t frame_count) {
    if (choice == "first") return 0;
    if (choice == "last" || choice == "-1") return frame_count - 1;
    return frame_number("--frame", "first, last", choice, frame_count);
}

}  // namespace tomodem::cli
