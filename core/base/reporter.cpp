#include "core/base/reporter.hpp"

namespace tomodem {
namespace {

class NoProgress final : public Progress {
    void update(double) override {}
};

class Silent final : public Reporter {
    void report(const std::string&, double, const std::string&) override {}
    void report(const std::string&, std::int64_t, const std::string&) override {}
    void report(const std::string&, const std::string&) override {}
    void report_json(const std::string&, const nlohmann::ordered_json&) override {}
    void note(const std::string&) override {}
    void warn(const std::string&) override {}
    std::unique_ptr<Progress> progress(const std::string&, double) override { return std::make_unique<NoProgress>(); }
};

}  // namespace

Reporter& silent_reporter() {
    static Silent silent;
    return silent;
}

}  // namespace tomodem
