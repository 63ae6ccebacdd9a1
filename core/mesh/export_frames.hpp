#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/packing/packing_file.hpp"

namespace tomodem {

/// Called after each frame with the number of frames done.
using FrameDone = std::function<void(std::size_t)>;

/// All chosen frames in one LAMMPS text dump: `id type x y z radius object`, lengths in mm; type is the label, object 0
/// where the packing has no objects. Then the fields of the run: NAME, NAME_x ... of a vector (vx vy vz of the
/// velocity), NAME_xx ... of a tensor. Numbers have the digits that give the same double again.
/// @see https://docs.lammps.org/dump.html
void export_dump(const RunReader& run, const std::vector<std::size_t>& frames, const std::filesystem::path& output,
                 const FrameDone& done = {});

/// One frame: `output` (.vtp) with the particles as points and arrays species, id, radius, object, and the fields of
/// the run (the components of a tensor in VTK's order: xx yy zz xy yz xz). Several frames: NAME_0000.vtp, NAME_0001.vtp
/// ... beside `output`, and NAME.pvd, written last, with their times. An `output` that ends in .pvd always gives the
/// second form.
/// @return the files written
std::vector<std::filesystem::path> export_vtp(const RunReader& run, const std::vector<std::size_t>& frames,
                                              const std::filesystem::path& output, const FrameDone& done = {});

}  // namespace tomodem
