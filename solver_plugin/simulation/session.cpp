#include "solver_plugin/simulation/session.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "core/base/error.hpp"
#include "solver_plugin/liggghts/registration.hpp"
#include "solver_plugin/simulation/completes_soon.hpp"

namespace tomodem::plugin {
namespace {

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
    MPI_Ibarrier(failures, &request);
    return completes_soon(request);
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
    // From the second one on LIGGGHTS warns of each of its styles that it has them already.
    std::streambuf* const errors = std::cerr.rdbuf(nullptr);
    lmp_ = std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(std::size(words)), arguments, communicator);
    std::cerr.clear();
    std::cerr.rdbuf(errors);
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
