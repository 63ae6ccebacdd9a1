#include "solver_plugin/session.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "solver_plugin/registration.hpp"

namespace tomodem::plugin {
namespace {

/// Log of the LIGGGHTS that is alive; empty when there is none. Never destroyed: read when the process ends.
std::filesystem::path& live_log() {
    static auto* const path = new std::filesystem::path;
    return *path;
}

/// Runs when the process ends: a log that is still live means that LIGGGHTS ended it.
void tell_last_error() {
    if (live_log().empty()) return;
    std::ifstream log(live_log());
    std::string line, last;
    while (std::getline(log, line))
        if (line.find("ERROR") != std::string::npos) last = line;
    if (!last.empty()) std::fprintf(stderr, "tomodem: LIGGGHTS stopped: %s\n", last.c_str());
    std::error_code ignored;
    std::filesystem::remove(live_log(), ignored);
}

}  // namespace

Session::Session(MPI_Comm communicator) {
    register_laws();
    static const bool watched = std::atexit(tell_last_error) == 0;
    (void)watched;
    log_ = std::filesystem::temp_directory_path() / fmt::format("tomodem-liggghts-{}.log", getpid());
    live_log() = log_;
    std::string words[] = {"liggghts", "-log", log_.string(), "-screen", "none"};
    char* arguments[std::size(words)];
    for (std::size_t k = 0; k < std::size(words); ++k) arguments[k] = words[k].data();
    lmp_ = std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(std::size(words)), arguments, communicator);
    register_fixes(*lmp_);
}

Session::~Session() {
    lmp_.reset();
    live_log().clear();
    std::error_code ignored;
    std::filesystem::remove(log_, ignored);
}

void Session::command(const std::string& line) {
    lmp_->input->one(line.c_str());
}

}  // namespace tomodem::plugin
