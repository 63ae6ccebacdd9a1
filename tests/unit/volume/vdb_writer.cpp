#include "tests/unit/volume/vdb_writer.hpp"

#include <openvdb/openvdb.h>

namespace tomodem {

void write_vdb(const std::filesystem::path& path, const VoxelIndex& size, const std::vector<std::int32_t>& labels) {
    openvdb::initialize();
    const auto grid = openvdb::Int32Grid::create(0);
    auto accessor = grid->getAccessor();
    std::size_t at = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) accessor.setValue({x - 3, y, z + 100}, labels[at++]);
    openvdb::io::File(path.string()).write({grid});
}

}  // namespace tomodem
