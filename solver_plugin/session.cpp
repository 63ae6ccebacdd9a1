#include "solver_plugin/session.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>
#include <utility>

#include "solver_plugin/registration.hpp"

namespace tomodem::plugin {
namespace {

/// Never destroyed: LIGGGHTS may end the process at any time.
std::string& advice() {
    static auto* const text = new std::string;
    return *text;
}

/// Takes what LIGGGHTS says on its screen, and passes on why it ends the process.
ssize_t listen(void*, const char* text, std::size_t size) {
    const std::string_view said(text, size);
    const auto error = said.find("ERROR");
    if (error != std::string_view::npos) {
        const std::string line(said.substr(error, said.find('\n', error) - error));
        std::fprintf(stderr, "tomodem: LIGGGHTS stopped: %s%s\n", line.c_str(), advice().c_str());
    }
    return static_cast<ssize_t>(size);
}

}  // namespace

Session::Session(MPI_Comm communicator) {
    register_laws();
    std::string words[] = {"liggghts", "-log", "none", "-screen", "none"};
    char* arguments[std::size(words)];
    for (std::size_t k = 0; k < std::size(words); ++k) arguments[k] = words[k].data();
    lmp_ = std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(std::size(words)), arguments, communicator);
    // On every process: an error of one alone is written by that one, on its screen only.
    lmp_->screen = fopencookie(nullptr, "w", {nullptr, &listen, nullptr, nullptr});
    if (lmp_->screen != nullptr) std::setvbuf(lmp_->screen, nullptr, _IOLBF, 0);
    register_fixes(*lmp_);
}

Session::~Session() {
    std::FILE* const screen = std::exchange(lmp_->screen, nullptr);
    lmp_.reset();
    if (screen != nullptr) std::fclose(screen);
}

void Session::command(const std::string& line) {
    lmp_->input->one(line.c_str());
}

void Session::advise(const std::string& text) {
    advice() = text;
}

}  // namespace tomodem::plugin
