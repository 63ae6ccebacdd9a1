#pragma once
#include <stdexcept>
#include <string>

namespace tomodem {

/// Something the user gave cannot be used: a file, a value in it, a combination. The message is one line that says
/// what is wrong, where, and what to do; `cli::main` prints it behind the tool's name and exits with status 1.
class InvalidInput : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/// The command line itself is wrong (exit status 2).
class WrongUsage : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

}  // namespace tomodem
