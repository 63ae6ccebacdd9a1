#include "tools/plan/text_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"

namespace tomodem::plan {

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    if (!file || file.bad()) throw InvalidInput(fmt::format("cannot read '{}'", path.string()));
    return text.str();
}

void write_if_changed(const std::filesystem::path& path, const std::string& text) {
    if (std::filesystem::is_regular_file(path) && read_text(path) == text) return;
    write_text(path, text);
}

}  // namespace tomodem::plan
