#pragma once
#include <cstddef>
#include <string_view>
#include <vector>

namespace tomodem::cli {

/// The frames that --frames names: "all", "first", "last", a number from 0, or several of these in increasing order
/// with commas between them, as "0,5,last".
/// @throws WrongUsage if it is none of these words, or they are not in order; InvalidInput if there is no such frame
std::vector<std::size_t> chosen_frames(std::string_view choice, std::size_t frame_count);

/// The frame that --frame names: "first", "last" (or -1, its older name) or a number from 0.
/// @throws as chosen_frames
std::size_t chosen_frame(std::string_view choice, std::size_t frame_count);

}  // namespace tomodem::cli
