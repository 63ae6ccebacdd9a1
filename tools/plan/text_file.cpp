#include "tools/plan/text_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "core/base/error.hpp"

namespace tomodem::plan {

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    if (!file || file.bad()) throw InvalidInput(fmt::format("cannot read '{}'", path.string()));
    return text.str();
}

}  // namespace tomodem::plan
