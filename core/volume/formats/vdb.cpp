#include <openvdb/openvdb.h>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

/// Scalar grids by the type that their voxels are handed on as.
template <class Visit>
bool with_grid(const openvdb::GridBase::Ptr& grid, const Visit& visit) {
    if (const auto found = openvdb::gridPtrCast<openvdb::Int32Grid>(grid)) return visit(*found, std::int32_t{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return visit(*found, float{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid)) return visit(*found, double{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::Int64Grid>(grid)) return visit(*found, std::int64_t{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::BoolGrid>(grid)) return visit(*found, std::uint8_t{}), true;
    return false;
}

VoxelType type_of(std::int32_t) {
    return VoxelType::int32;
}
VoxelType type_of(float) {
    return VoxelType::float32;
}
VoxelType type_of(double) {
    return VoxelType::float64;
}
VoxelType type_of(std::int64_t) {
    return VoxelType::int64;
}
VoxelType type_of(std::uint8_t) {
    return VoxelType::uint8;
}

openvdb::GridBase::Ptr only_grid(const fs::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    constexpr bool delayed_loading = false;
    file.open(delayed_loading);
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    if (grids->size() != 1)
        cannot_read(path, fmt::format("it holds {} grids; save the one that is meant by itself", grids->size()));
    return grids->front();
}

/// Without threads: TBB's do not survive a fork.
class VdbSource : public VolumeSource {
 public:
    explicit VdbSource(const fs::path& path) : grid_(only_grid(path)), box_(grid_->evalActiveVoxelBoundingBox()) {
        if (box_.empty()) cannot_read(path, "its grid has no active voxel");
        header_.format = fmt::format("OpenVDB grid '{}'", grid_->getName());
        const openvdb::Coord size = box_.dim();
        header_.size = {size.x(), size.y(), size.z()};
        if (!with_grid(grid_, [this](const auto&, auto value) { header_.type = type_of(value); }))
            cannot_read(path, fmt::format("its grid holds values of type {}; a volume has one number a voxel",
                                          grid_->valueType()));
        const openvdb::Vec3d edges = grid_->voxelSize();
        const Vec3 spacing(edges.x(), edges.y(), edges.z());
        if ((spacing.array() > 0).all() && spacing.allFinite()) header_.spacing = spacing;
    }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        with_grid(grid_, [&](const auto& grid, auto value) {
            auto* to = reinterpret_cast<decltype(value)*>(voxels);
            const auto accessor = grid.getConstAccessor();
            for (std::int32_t z = k; z < k + count; ++z)
                for (std::int64_t y = window.y; y < window.y + window.height; ++y)
                    for (std::int64_t x = window.x; x < window.x + window.width; ++x)
                        *to++ = static_cast<decltype(value)>(
                            accessor.getValue(box_.min().offsetBy(static_cast<int>(x), static_cast<int>(y), z)));
        });
    }

 private:
    openvdb::GridBase::Ptr grid_;
    openvdb::CoordBBox box_;
};

const RegisteredFormat openvdb_format{{
    .name = "OpenVDB",
    .extensions = {".vdb"},
    .open = [](const fs::path& file, const std::string&) -> Source {
        return in_own_process(file, "OpenVDB", [&file] { return std::make_unique<VdbSource>(file); });
    },
}};

}  // namespace

}  // namespace tomodem::formats
