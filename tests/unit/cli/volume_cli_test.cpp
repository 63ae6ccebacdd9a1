#include "core/cli/volume_cli.hpp"

#include <gmock/gmock.h>

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

TEST(VolumeOptions, AreReadFromTheirTexts) {
    VolumeRequest request;
    request.voxel_size = 0.01;
    request.origin = "1mm, 0mm,500um";
    request.relabel = "255=1,2=0";
    request.roi = "0:10,5:7,1:100";
    const VolumeOptions options = volume_options(request);
    EXPECT_EQ(options.voxel_size, Vec3(0.01, 0.01, 0)) << "z: as the file says, or as x";
    EXPECT_TRUE(options.origin->isApprox(Vec3(1, 0, 0.5)));
    EXPECT_THAT(options.relabel, ElementsAre(Pair(2, 0), Pair(255, 1)));
    EXPECT_EQ((*options.region)[0], (VoxelIndex{0, 5, 1}));
    EXPECT_EQ((*options.region)[1], (VoxelIndex{10, 2, 99}));
}

TEST(VolumeOptions, TakeTheSliceSpacingWhereItIsGiven) {
    VolumeRequest request;
    request.voxel_size = 0.01;
    request.slice_spacing = 0.05;
    EXPECT_EQ(volume_options(request).voxel_size, Vec3(0.01, 0.01, 0.05));
}

TEST(VolumeOptions, RejectAnOriginWithoutUnit) {
    VolumeRequest request;
    request.voxel_size = 0.01;
    request.origin = "1,0,0";
    EXPECT_THAT([&] { volume_options(request); }, ThrowsMessage<WrongUsage>(HasSubstr("--origin")));
    request.origin = "1mm,0mm";
    EXPECT_THAT([&] { volume_options(request); }, ThrowsMessage<WrongUsage>(HasSubstr("three lengths")));
}

TEST(RegionOfInterest, RejectsWhatIsEmptyOrBackward) {
    for (const char* text :
         {"", "0:1,0:1", "0:1,0:1,0:1,0:1", "1:1,0:1,0:1", "3:1,0:1,0:1", "-1:1,0:1,0:1", "0-1,0:1,0:1", "a:b,0:1,0:1"})
        EXPECT_THAT([&] { parse_roi("--roi", text); }, ThrowsMessage<WrongUsage>(HasSubstr("x0:x1"))) << text;
}

TEST(LabelNames, AreReadAndChecked) {
    EXPECT_THAT(parse_label_names("--labels", "1=matrix, 2=inclusion"),
                ElementsAre(Pair(1, "matrix"), Pair(2, "inclusion")));
    EXPECT_THAT([] { parse_label_names("--labels", "1=a,1=b"); },
                ThrowsMessage<WrongUsage>(HasSubstr("label 1 is named twice")));
    EXPECT_THAT([] { parse_label_names("--labels", "1=a,2=a"); },
                ThrowsMessage<WrongUsage>(HasSubstr("the same name")));
    EXPECT_THAT([] { parse_label_names("--labels", "1="); }, ThrowsMessage<WrongUsage>(HasSubstr("LABEL=NAME")));
}

TEST(Relabelling, RejectsALabelNamedTwice) {
    EXPECT_THAT([] { parse_relabel("--relabel", "1=2,1=3"); },
                ThrowsMessage<WrongUsage>(HasSubstr("label 1 is named twice")));
}

TEST(Properties, AreNamesAndVolumes) {
    EXPECT_THAT(parse_properties("--property", "t=a.tif, damage_2=d.h5:/x"),
                ElementsAre(Pair("damage_2", "d.h5:/x"), Pair("t", "a.tif")));
    for (const char* text : {"", "t", "=a.tif", "t=", "a b=c.tif", "t=a.tif,"})
        EXPECT_THAT([&] { parse_properties("--property", text); }, ThrowsMessage<WrongUsage>(HasSubstr("NAME=VOLUME")))
            << text;
    EXPECT_THAT([&] { parse_properties("--property", "t=a,t=b"); },
                ThrowsMessage<WrongUsage>(HasSubstr("t is named twice")));
}

TEST(Thresholds, RiseAndAreNumbers) {
    EXPECT_THAT(parse_thresholds("--threshold", "83, 140.5"), ElementsAre(83, 140.5));
    for (const char* text : {"", "a", "140,83", "1,1", "nan", "1e999"})
        EXPECT_THAT([&] { parse_thresholds("--threshold", text); },
                    ThrowsMessage<WrongUsage>(HasSubstr("numbers that rise")))
            << text;
}

TEST(VolumeOptions, OfRawVoxelsNeedSizeAndType) {
    VolumeRequest request;
    request.raw_size = "2x3x4";
    EXPECT_THAT([&] { volume_options(request); },
                ThrowsMessage<WrongUsage>(HasSubstr("both --raw-size and --raw-type")));
    request.raw_type = "u16";
    request.raw_byte_order = "big";
    request.raw_offset = 512;
    const RawLayout raw = volume_options(request).raw.value();
    EXPECT_EQ(raw.size, (VoxelIndex{2, 3, 4}));
    EXPECT_EQ(raw.type, VoxelType::uint16);
    EXPECT_TRUE(raw.big_endian);
    EXPECT_EQ(raw.offset, 512);
    request.raw_type = "bits";
    EXPECT_THAT([&] { volume_options(request); }, ThrowsMessage<WrongUsage>(HasSubstr("--raw-type 'bits'")));
}

TEST(Labels, AreSortedAndUnique) {
    EXPECT_THAT(parse_labels("--objects", "3, 1,3"), ElementsAre(1, 3));
}

TEST(Size, IsOneNumberOrThree) {
    EXPECT_EQ(parse_size("--size", "60"), (VoxelIndex{60, 60, 60}));
    EXPECT_EQ(parse_size("--size", "60x70x80"), (VoxelIndex{60, 70, 80}));
    EXPECT_THAT([] { parse_size("--size", "60x70"); }, ThrowsMessage<WrongUsage>(HasSubstr("number of voxels")));
    EXPECT_THAT([] { parse_size("--size", "0"); }, ThrowsMessage<WrongUsage>(HasSubstr("number of voxels")));
}

TEST(LabelObjects, AreRangesOfLabels) {
    const auto ranges = parse_label_objects("--label-objects", "501:600=2,2:500=1");
    ASSERT_EQ(ranges.size(), 2U);
    EXPECT_EQ(ranges[0].first, 2);
    EXPECT_EQ(ranges[0].last, 500);
    EXPECT_EQ(ranges[0].species, 1);
    EXPECT_EQ(ranges[1].first, 501);
    const auto refused = [](const std::string& text, const std::string& part) {
        EXPECT_THAT([&] { parse_label_objects("--label-objects", text); }, ThrowsMessage<WrongUsage>(HasSubstr(part)));
    };
    refused("2:5", "FIRST:LAST=LABEL");
    refused("2=1", "FIRST:LAST=LABEL");
    refused("0:5=1", "FIRST:LAST=LABEL");
    refused("2:5=1x", "FIRST:LAST=LABEL");
    refused("5:2=1", "smaller than the first");
    refused("2:5=1,4:8=2", "in two ranges");
}

}  // namespace
}  // namespace tomodem
