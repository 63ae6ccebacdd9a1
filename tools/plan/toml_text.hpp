#pragma once
#include <fmt/format.h>

#include <toml++/toml.h>
#include <string>

#include "core/base/error.hpp"

/// Includes toml++, so for .cpp files alone.
namespace tomodem::plan {

/// @param file  how errors name the text, as "table 'mine.toml'"
/// @throws InvalidInput with the line, if it is not TOML
inline toml::table parse_toml(const std::string& text, const std::string& file) {
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        throw InvalidInput(fmt::format("{} line {}: {}", file, error.source().begin.line, error.description()));
    }
}

}  // namespace tomodem::plan
