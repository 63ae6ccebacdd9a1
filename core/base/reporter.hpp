#pragma once
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

/// How a library reports to its caller while it works. A library never prints: it gets a reporter as an argument.
namespace tomodem {

/// How far a long computation has come; what shows it disappears with the object.
class Progress {
 public:
    virtual ~Progress() = default;
    /// @param done  in the units of the total, from any thread but one at a time
    virtual void update(double done) = 0;
};

class Reporter {
 public:
    virtual ~Reporter() = default;
    /// One result of the running tool, under a key in snake_case, its unit beside it.
    virtual void report(const std::string& key, double value, const std::string& unit = "") = 0;
    virtual void report(const std::string& key, std::int64_t value, const std::string& unit = "") = 0;
    virtual void report(const std::string& key, const std::string& value) = 0;
    /// A result that is a table or a list.
    virtual void report_json(const std::string& key, const nlohmann::ordered_json& value) = 0;
    /// One line for the user, without consequence for the result.
    virtual void note(const std::string& line) = 0;
    /// One line about a result that may be less than the user expects.
    virtual void warn(const std::string& line) = 0;
    /// @param label  such as "reading"
    /// @param total  the value of update() at the end, above 0
    virtual std::unique_ptr<Progress> progress(const std::string& label, double total) = 0;
};

/// Drops everything; for tests and for callers that do not want to know.
Reporter& silent_reporter();

}  // namespace tomodem
