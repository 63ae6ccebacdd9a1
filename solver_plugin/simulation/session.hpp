#pragma once
#include <memory>
#include <string>

#include "solver_plugin/liggghts/liggghts.hpp"

namespace tomodem::plugin {

/// One LIGGGHTS with tomodem's styles, driven by its input commands and silent on the screen.
///
/// An error of LIGGGHTS becomes an InvalidInput on every process. Where only some processes meet it, so that the others
/// wait for them for ever, one line on stderr says so and all are ended.
class Session {
 public:
    explicit Session(MPI_Comm communicator);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void command(const std::string& line);
    LAMMPS_NS::LAMMPS& lmp() { return *lmp_; }

    /// What that line ends with: where the run is kept.
    static void advise(const std::string& text);

 private:
    std::unique_ptr<LAMMPS_NS::LAMMPS> lmp_;
};

}  // namespace tomodem::plugin
