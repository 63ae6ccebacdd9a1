#pragma once
#include <string>

#include "core/cli/cli.hpp"

/// What a Usage says of itself. Internal to core: tools need only cli.hpp.
namespace tomodem::cli {

/// True for an argument without a flag, known by its place.
bool positional(const Argument& argument);

/// The text of --help.
std::string help_text(const Usage& usage);

/// The tool's section of the reference page, in Markdown.
std::string reference_page(const Usage& usage);

nlohmann::ordered_json description(const Display& display);

/// All of it for programs (`--describe`): name, purpose, step, arguments, threads, examples, display.
nlohmann::ordered_json description(const Usage& usage);

}  // namespace tomodem::cli
