#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem {

/// What the XDMF text needs to know of a packing or run file.
struct XdmfContent {
    std::string h5_name;  ///< file name of the HDF5 file, which lies in the same folder
    std::size_t particles = 0;
    std::vector<double> times;  ///< s, one a frame; more than one makes a temporal collection
    bool has_objects = false;
    std::vector<ParticleField> fields{};
};

/// The text of the small XML file that tells ParaView and VTK where a packing file's arrays are.
/// @see https://www.xdmf.org/index.php/XDMF_Model_and_Format
std::string xdmf_text(const XdmfContent& content);

}  // namespace tomodem
