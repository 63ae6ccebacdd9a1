#include "tools/metrics/curves/volume_series.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem::curves {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

using VolumeSeries = InTemporaryFolder;

TEST_F(VolumeSeries, FollowsAKnownChangeOfVolume) {
    const auto path = folder / "run.h5";
    synthetic::write_run(synthetic::sample(synthetic::cube(6, 1.0)), path,
                         {.strain = 0.1, .frames = 5, .volume_factor = 0.95});
    const RunReader run(path);
    const std::vector<FrameVolume> frames = volume_series(run, 1.0, 1, {});
    ASSERT_EQ(frames.size(), 5u);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(frames[i].volume, 216.0 * (1.0 - 0.05 * i / 4.0), 1e-9);
    EXPECT_NEAR(frames[0].area, 216.0, 1e-9);
    EXPECT_EQ(frames[4].components, 1u);
}

TEST_F(VolumeSeries, IsTheSameOnAnyNumberOfThreads) {
    const auto path = folder / "run.h5";
    synthetic::write_run(synthetic::sample(synthetic::ellipsoid({5, 4, 3}, 0.9)), path, {.frames = 7});
    const RunReader run(path);
    const std::vector<FrameVolume> one = volume_series(run, 1.0, 1, {}), four = volume_series(run, 1.0, 4, {});
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].volume, four[i].volume);
        EXPECT_EQ(one[i].area, four[i].area);
    }
}

TEST_F(VolumeSeries, NamesTheFrameThatHasNoVolume) {
    const Packing packing = synthetic::sample(synthetic::cube(2, 1.0));
    const auto path = folder / "run.h5";
    {
        RunWriter writer(packing, path, {});
        writer.add_frame({0, 0.0, packing.position});
        writer.add_frame({1, 1.0, std::vector<Vec3>(packing.size(), Vec3(1, 2, 3))});
        writer.commit();
    }
    const RunReader run(path);
    EXPECT_THAT([&] { volume_series(run, 1.0, 2, {}); }, ThrowsMessage<InvalidInput>(HasSubstr("frame 1: ")));
}

}  // namespace
}  // namespace tomodem::curves
