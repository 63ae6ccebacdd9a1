#include "solver_plugin/session.hpp"

#include <fmt/format.h>

#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "core/error.hpp"
#include "solver_plugin/registration.hpp"

namespace tomodem::plugin {
namespace {

/// How long a process that failed waits for the others to fail alike.
constexpr int patience_hundredths = 500;

/// For the agreement on failures alone: the others may be inside any other call.
MPI_Comm failures = MPI_COMM_NULL;

std::string& advice() {
    static std::string text;
    return text;
}

std::string reason(const char* file, int line, const char* text) {
    return fmt::format("LIGGGHTS stopped: {} ({}:{})", text, std::filesystem::path(file).filename().string(), line);
}

bool all_failed() {
    if (failures == MPI_COMM_NULL) return false;
    MPI_Request request;
    int arrived = 0;
    MPI_Ibarrier(failures, &request);
    for (int waited = 0; waited < patience_hundredths; ++waited) {
        MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
        if (arrived) return true;
        const timespec pause{0, 10'000'000};
        nanosleep(&pause, nullptr);
    }
    return false;
}

}  // namespace
}  // namespace tomodem::plugin

// LIGGGHTS' own versions end the process with a text that nobody sees. An executable's symbols go before those of a
// shared library, so these serve LIGGGHTS too.
namespace LAMMPS_NS {

/// Called by all processes.
void Error::all(const char* file, int line, const char* text) {
    throw tomodem::InvalidInput(tomodem::plugin::reason(file, line, text));
}

/// Called by one process, or by several on the same occasion.
void Error::one(const char* file, int line, const char* text) {
    const std::string reason = tomodem::plugin::reason(file, line, text);
    if (tomodem::plugin::all_failed()) throw tomodem::InvalidInput(reason);
    std::fprintf(stderr, "tomodem: %s%s\n", reason.c_str(), tomodem::plugin::advice().c_str());
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::abort();
}

}  // namespace LAMMPS_NS

namespace tomodem::plugin {

Session::Session(MPI_Comm communicator) {
    register_laws();
    MPI_Comm_dup(communicator, &failures);
    std::string words[] = {"liggghts", "-log", "none", "-screen", "none"};
    char* arguments[std::size(words)];
    for (std::size_t k = 0; k < std::size(words); ++k) arguments[k] = words[k].data();
    lmp_ = std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(std::size(words)), arguments, communicator);
    register_fixes(*lmp_);
}

Session::~Session() {
    lmp_.reset();
    MPI_Comm_free(&failures);
}

void Session::command(const std::string& line) {
    lmp_->input->one(line.c_str());
}

void Session::advise(const std::string& text) {
    advice() = text;
}

}  // namespace tomodem::plugin
