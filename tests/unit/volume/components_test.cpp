#include <gmock/gmock.h>

#include <queue>
#include <random>

#include "core/volume/volume.hpp"

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::Pair;

LabelVolume volume_of(VoxelIndex size, const std::vector<std::int32_t>& voxels) {
    LabelVolume volume(size, Vec3::Ones());
    volume.set_slices(0, size[2], voxels);
    return volume;
}

/// Flood fill in raster order: slow, obvious. Neighbours are up to `most_steps` steps along axes away, one along each.
std::vector<std::int32_t> flood_fill(VoxelIndex size, const std::vector<std::int32_t>& voxels,
                                     const std::vector<std::int32_t>& labels, Joining joining, int most_steps) {
    const auto at = [&](int x, int y, int z) { return (std::size_t(z) * size[1] + y) * size[0] + x; };
    const auto wanted = [&](std::int32_t label) { return std::count(labels.begin(), labels.end(), label) > 0; };
    std::vector<std::int32_t> number(voxels.size(), 0);
    std::int32_t components = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) {
                if (!wanted(voxels[at(x, y, z)]) || number[at(x, y, z)]) continue;
                std::queue<VoxelIndex> front;
                front.push({x, y, z});
                number[at(x, y, z)] = ++components;
                while (!front.empty()) {
                    const VoxelIndex here = front.front();
                    front.pop();
                    for (int dz = -1; dz <= 1; ++dz)
                        for (int dy = -1; dy <= 1; ++dy)
                            for (int dx = -1; dx <= 1; ++dx) {
                                if (dx * dx + dy * dy + dz * dz > most_steps) continue;
                                const VoxelIndex there{here[0] + dx, here[1] + dy, here[2] + dz};
                                bool inside = true;
                                for (int axis = 0; axis < 3; ++axis)
                                    inside = inside && there[axis] >= 0 && there[axis] < size[axis];
                                if (!inside) continue;
                                const auto i = at(there[0], there[1], there[2]), j = at(here[0], here[1], here[2]);
                                if (number[i] || !wanted(voxels[i])) continue;
                                if (joining == Joining::same_label && voxels[i] != voxels[j]) continue;
                                number[i] = components;
                                front.push(there);
                            }
                }
            }
    return number;
}

TEST(ConnectedComponents, AreThoseOfAFloodFillOnNoise) {
    const VoxelIndex size{23, 18, 21};
    constexpr std::array connectivities{Connectivity::faces, Connectivity::edges, Connectivity::corners};
    // From crowded to sparse: by corners, few labels are one component.
    for (const int labels_in_all : {4, 8, 20})
        for (unsigned seed = 0; seed < 6; ++seed) {
            std::mt19937 random(seed);
            std::vector<std::int32_t> voxels(23 * 18 * 21);
            for (auto& voxel : voxels) voxel = static_cast<std::int32_t>(random() % labels_in_all);
            for (const auto joining : {Joining::any_label, Joining::same_label})
                for (int steps = 1; steps <= 3; ++steps) {
                    const Components found =
                        connected_components(volume_of(size, voxels), {3, 1}, joining, connectivities[steps - 1]);
                    std::vector<std::int32_t> numbers;
                    found.number.slices(0, size[2], numbers);
                    const auto expected = flood_fill(size, voxels, {1, 3}, joining, steps);
                    ASSERT_EQ(numbers, expected) << labels_in_all << " labels, " << steps << " steps";
                    std::vector<std::int64_t> counts(*std::max_element(expected.begin(), expected.end()), 0);
                    for (auto number : expected)
                        if (number) ++counts[number - 1];
                    EXPECT_EQ(found.voxels, counts);
                }
        }
}

TEST(ConnectedComponents, JoinOverEdgesOrCornersWhereAskedTo) {
    const auto edge = volume_of({2, 2, 1}, {1, 0, 0, 1});
    EXPECT_THAT(connected_components(edge, {1}, Joining::any_label, Connectivity::edges).voxels, ElementsAre(2));
    const auto corner = volume_of({2, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 1});
    EXPECT_THAT(connected_components(corner, {1}, Joining::any_label, Connectivity::edges).voxels, ElementsAre(1, 1));
    EXPECT_THAT(connected_components(corner, {1}, Joining::any_label, Connectivity::corners).voxels, ElementsAre(2));
}

TEST(ConnectedComponents, DoNotJoinOverEdgesOrCorners) {
    const auto volume = volume_of({2, 2, 2}, {1, 0, 0, 1, 0, 1, 1, 0});
    EXPECT_THAT(connected_components(volume, {1}).voxels, ElementsAre(1, 1, 1, 1));
}

TEST(ConnectedComponents, JoinTheArmsOfAUAtItsLastSlice) {
    const auto volume = volume_of({3, 1, 10}, [] {
        std::vector<std::int32_t> voxels;
        for (int z = 0; z < 10; ++z) voxels.insert(voxels.end(), {1, z == 9 ? 1 : 0, 1});
        return voxels;
    }());
    EXPECT_THAT(connected_components(volume, {1}).voxels, ElementsAre(21));
}

TEST(ConnectedComponents, OfVoidAreCountedToo) {
    const auto volume = volume_of({3, 1, 1}, {0, 1, 0});
    const Components found = connected_components(volume, {0});
    EXPECT_THAT(found.voxels, ElementsAre(1, 1));
    EXPECT_THAT(found.label, ElementsAre(0, 0));
}

TEST(ConnectedComponents, DoNotJoinTheEndOfARowWithTheStartOfTheNext) {
    const auto volume = volume_of({3, 2, 1}, {1, 2, 0, 0, 0, 2});
    EXPECT_THAT(connected_components(volume, {1, 2}).voxels, ElementsAre(2, 1));
    const auto shifted = volume_of({3, 2, 1}, {1, 1, 0, 0, 0, 2});
    EXPECT_THAT(connected_components(shifted, {1, 2}).voxels, ElementsAre(2, 1));
}

TEST(SmallComponents, TakeTheLabelOfWhatSurroundsThem) {
    // A speck of 1 in 2, a speck of 2 in void, and a large 2.
    auto volume = volume_of({7, 3, 1}, {2, 2, 2, 2, 0, 0, 0,  //
                                        2, 1, 2, 2, 0, 2, 0,  //
                                        2, 2, 2, 2, 0, 0, 0});
    EXPECT_EQ(remove_small_components(volume, {1, 2}, 2), 2);
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(0, 9), Pair(2, 12)));
}

TEST(SmallComponents, StayWhenTheyAreAsLargeAsAsked) {
    auto volume = volume_of({3, 1, 1}, {0, 1, 1});
    EXPECT_EQ(remove_small_components(volume, {1}, 2), 0);
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(0, 1), Pair(1, 2)));
}

TEST(SmallComponents, AreWholeByTheConnectivityAskedFor) {
    auto volume = volume_of({2, 2, 1}, {1, 2, 2, 1});
    EXPECT_EQ(remove_small_components(volume, {1}, 2, Connectivity::edges), 0);
    EXPECT_EQ(remove_small_components(volume, {1}, 2, Connectivity::faces), 2);
}

TEST(SmallComponents, AcrossTheBordersOfSlabsAreSeenWhole) {
    LabelVolume volume({1, 1, 20}, Vec3::Ones());
    std::vector<std::int32_t> voxels(20, 3);
    voxels[7] = voxels[8] = 1;
    volume.set_slices(0, 20, voxels);
    EXPECT_EQ(remove_small_components(volume, {1}, 2), 0);
    EXPECT_EQ(remove_small_components(volume, {1}, 3), 1);
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(3, 20)));
}

}  // namespace
}  // namespace tomodem
