#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tomodem::cli {

class Usage;

/// A parsed command line, without the values that the usage's own targets received.
struct CommandLine {
    std::string answer;           ///< text that --help, --version or the like asks for; the rest is then not filled in
    std::set<std::string> given;  ///< options on the command line, as "--threshold"
    std::map<std::string, std::vector<std::filesystem::path>> inputs;  ///< the files of each input, by its name
    std::filesystem::path json;                                        ///< --json; empty: not given
    std::int64_t threads = 0;                                          ///< --threads; 0: not given
    bool quiet = false;
};

/// Splits the command line, checks it against the usage and stores every value in its target.
/// @throws WrongUsage   if it does not follow the usage
/// @throws InvalidInput if an input does not exist or an output cannot be written
CommandLine parse(const Usage& usage, int argc, const char* const* argv);

}  // namespace tomodem::cli
