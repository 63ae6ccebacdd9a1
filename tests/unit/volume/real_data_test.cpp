// Check values from the README beside each volume of the shared data.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "core/volume/volume.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::Pair;

class RealVolume : public testing::Test {
 protected:
    void SetUp() override {
        const char* shared = std::getenv("TOMODEM_SHARED");
        data = (shared ? fs::path(shared) : fs::path(TOMODEM_SOURCE) / ".." / "shared") / "data";
        if (!fs::is_directory(data)) GTEST_SKIP() << "no real volumes at " << data << " (set TOMODEM_SHARED)";
    }

    LabelVolume read(const std::string& name, std::optional<double> threshold = {}) {
        VolumeOptions options;
        options.voxel_size = Vec3::Constant(0.003);
        if (threshold) options.thresholds = {*threshold};
        return read_label_volume(data / name, options);
    }

    static std::array<std::int64_t, 3> plane_sums(const LabelVolume& volume, int x, int y, int z) {
        const VoxelIndex size = volume.size();
        std::vector<std::int32_t> voxels;
        std::array<std::int64_t, 3> sums{};
        for (int k = 0; k < size[2]; ++k) {
            volume.slice(k, voxels);
            for (int j = 0; j < size[1]; ++j) sums[0] += voxels[std::size_t(j) * size[0] + x];
            for (int i = 0; i < size[0]; ++i) sums[1] += voxels[std::size_t(y) * size[0] + i];
            if (k == z)
                for (auto voxel : voxels) sums[2] += voxel;
        }
        return sums;
    }

    static std::array<std::int64_t, 2> components(const LabelVolume& volume, const std::vector<std::int32_t>& labels) {
        const Components found = connected_components(volume, labels);
        return {static_cast<std::int64_t>(found.voxels.size()),
                std::count_if(found.voxels.begin(), found.voxels.end(), [](auto voxels) { return voxels >= 27; })};
    }

    fs::path data;
};

TEST_F(RealVolume, CastIronSlicesMatchTheirReadme) {
    const LabelVolume volume = read("nodular_cast_iron/labels");
    EXPECT_EQ(volume.size(), (VoxelIndex{300, 300, 300}));
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(1, 2861044), Pair(2, 24138956)));
    EXPECT_THAT(plane_sums(volume, 75, 75, 75), ElementsAre(168333, 169418, 171020));
    const LabelVolume::Sampler sampler(volume);
    EXPECT_EQ(sampler.at({0, 0, 0}), 2);
    EXPECT_EQ(sampler.at({299, 0, 0}), 2);
    EXPECT_EQ(sampler.at({0, 299, 0}), 1);
    EXPECT_EQ(sampler.at({0, 0, 299}), 1);
    EXPECT_EQ(sampler.at({150, 150, 150}), 2);
    EXPECT_EQ(sampler.at({100, 75, 60}), 1);
    EXPECT_THAT(components(volume, {1}), ElementsAre(216, 211));
    EXPECT_THAT(components(volume, {2}), ElementsAre(1, 1));
}

TEST_F(RealVolume, PaletteSliceHasTheIndicesOfTheGreySlice) {
    const LabelVolume palette = read("nodular_cast_iron/original_palette_slice_000.tif");
    const LabelVolume grey = read("nodular_cast_iron/labels/slice_000.tif");
    std::vector<std::int32_t> a, b;
    palette.slice(0, a);
    grey.slice(0, b);
    EXPECT_EQ(a, b);
}

TEST_F(RealVolume, TrabecularBoneMatchesItsReadme) {
    const LabelVolume labels = read("trabecular_bone/bone_labels.tif");
    EXPECT_EQ(labels.size(), (VoxelIndex{200, 200, 200}));
    EXPECT_THAT(labels.histogram(), ElementsAre(Pair(0, 6507094), Pair(1, 1492906)));
    EXPECT_THAT(plane_sums(labels, 50, 50, 50), ElementsAre(8466, 6601, 6657));
    EXPECT_THAT(components(labels, {1}), ElementsAre(20, 5));
    EXPECT_THAT(components(labels, {0}), ElementsAre(1, 1));
    const LabelVolume grey = read("trabecular_bone/bone_grey.tif");
    EXPECT_THAT(plane_sums(grey, 50, 50, 50), ElementsAre(2049792, 1751488, 1754251));
    const LabelVolume::Sampler sampler(grey);
    EXPECT_EQ(sampler.at({0, 0, 0}), 50);
    EXPECT_EQ(sampler.at({0, 199, 0}), 32);
    EXPECT_EQ(sampler.at({66, 50, 40}), 21);
}

TEST_F(RealVolume, BigTiffOfFibresMatchesItsReadme) {
    const LabelVolume grey = read("polymer_fibres/fibres_grey_bigtiff.tif");
    EXPECT_THAT(plane_sums(grey, 32, 32, 32), ElementsAre(1563897, 1635970, 1591780));
    const LabelVolume::Sampler sampler(grey);
    EXPECT_EQ(sampler.at({127, 0, 0}), 77);
    EXPECT_EQ(sampler.at({0, 0, 127}), 188);
    const LabelVolume labels = read("polymer_fibres/fibres_labels.tif");
    EXPECT_THAT(labels.histogram(), ElementsAre(Pair(0, 1795821), Pair(1, 301331)));
    EXPECT_THAT(components(labels, {1}), ElementsAre(70, 15));
    EXPECT_THAT(components(labels, {0}), ElementsAre(3, 1));
    EXPECT_EQ(read("polymer_fibres/fibres_grey_bigtiff.tif", 127).histogram(), labels.histogram());
}

TEST_F(RealVolume, FloatFoamAboveItsThresholdIsItsLabels) {
    const LabelVolume grey = read("liquid_foam/foam_grey_float32.tif", 125.010);
    const LabelVolume labels = read("liquid_foam/foam_labels.tif");
    std::vector<std::int32_t> a, b;
    grey.slices(0, 100, a);
    labels.slices(0, 100, b);
    EXPECT_EQ(a, b);
    EXPECT_THAT(labels.histogram(), ElementsAre(Pair(0, 848024), Pair(1, 151976)));
    EXPECT_THAT(plane_sums(labels, 25, 25, 25), ElementsAre(1495, 1577, 1556));
    EXPECT_THAT(components(labels, {1}), ElementsAre(33, 1));
    EXPECT_THAT(components(labels, {0}), ElementsAre(5, 1));
}

}  // namespace
}  // namespace tomodem
