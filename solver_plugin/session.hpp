#pragma once
#include <memory>
#include <string>

#include "solver_plugin/liggghts.hpp"

namespace tomodem::plugin {

/// One LIGGGHTS with tomodem's styles, driven by its input commands and silent on the screen.
///
/// LIGGGHTS ends the process itself on an error; its message then reaches stderr as one line of ours.
class Session {
 public:
    explicit Session(MPI_Comm communicator);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void command(const std::string& line);
    LAMMPS_NS::LAMMPS& lmp() { return *lmp_; }

    /// What that line ends with: how to go on.
    static void advise(const std::string& text);

 private:
    std::unique_ptr<LAMMPS_NS::LAMMPS> lmp_;
};

}  // namespace tomodem::plugin
