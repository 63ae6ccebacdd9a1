#include <gmock/gmock.h>
#include <tiffio.h>

#include <fstream>
#include <numeric>

#include "core/base/error.hpp"
#include "core/volume/grey_volume.hpp"
#include "core/volume/volume.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

struct Format {
    int bits = 8;
    int sample_format = SAMPLEFORMAT_UINT;
    int compression = COMPRESSION_NONE;
    const char* mode = "w";
    int tile = 0;  // 0: strips
    bool palette = false;
    int rows_per_strip = 3;
    int predictor = PREDICTOR_NONE;
};

/// Writes slices of width x height values of type T.
template <class T>
void write_tiff(const fs::path& path, int width, int height, const std::vector<T>& voxels, const Format& format = {}) {
    TIFF* tiff = TIFFOpen(path.c_str(), format.mode);
    ASSERT_TRUE(tiff);
    for (std::size_t start = 0; start < voxels.size(); start += std::size_t(width) * height) {
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, format.bits);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format.sample_format);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, format.compression);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, format.palette ? PHOTOMETRIC_PALETTE : PHOTOMETRIC_MINISBLACK);
        if (format.predictor != PREDICTOR_NONE) TIFFSetField(tiff, TIFFTAG_PREDICTOR, format.predictor);
        if (format.palette) {
            std::vector<std::uint16_t> colours(std::size_t{1} << format.bits, 12345);
            TIFFSetField(tiff, TIFFTAG_COLORMAP, colours.data(), colours.data(), colours.data());
        }
        const auto value = [&](int x, int y) {
            return x < width && y < height ? voxels[start + std::size_t(y) * width + x] : T{};
        };
        const auto pack = [&](int x0, int y0, int columns, int rows) {
            std::vector<std::uint8_t> bytes;
            for (int y = y0; y < y0 + rows; ++y)
                if (format.bits < 8) {
                    std::vector<std::uint8_t> line((columns * format.bits + 7) / 8, 0);
                    for (int x = 0; x < columns; ++x)
                        line[x * format.bits / 8] |=
                            static_cast<std::uint8_t>(int(value(x0 + x, y)) << (8 - format.bits - x * format.bits % 8));
                    bytes.insert(bytes.end(), line.begin(), line.end());
                } else {
                    for (int x = x0; x < x0 + columns; ++x) {
                        const T one = value(x, y);
                        const auto* raw = reinterpret_cast<const std::uint8_t*>(&one);
                        bytes.insert(bytes.end(), raw, raw + sizeof(T));
                    }
                }
            return bytes;
        };
        if (format.tile) {
            TIFFSetField(tiff, TIFFTAG_TILEWIDTH, format.tile);
            TIFFSetField(tiff, TIFFTAG_TILELENGTH, format.tile);
            for (int y = 0; y < height; y += format.tile)
                for (int x = 0; x < width; x += format.tile) {
                    auto bytes = pack(x, y, format.tile, format.tile);
                    TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, x, y, 0, 0), bytes.data(), bytes.size());
                }
        } else {
            TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, format.rows_per_strip);
            for (int y = 0, strip = 0; y < height; y += format.rows_per_strip, ++strip) {
                auto bytes = pack(0, y, width, std::min(format.rows_per_strip, height - y));
                TIFFWriteEncodedStrip(tiff, strip, bytes.data(), bytes.size());
            }
        }
        TIFFWriteDirectory(tiff);
    }
    TIFFClose(tiff);
}

VolumeOptions unit_voxels() {
    VolumeOptions options;
    options.voxel_size = Vec3::Ones();
    return options;
}

std::vector<std::int32_t> all_voxels(const LabelVolume& volume) {
    std::vector<std::int32_t> voxels;
    volume.slices(0, volume.size()[2], voxels);
    return voxels;
}

template <class T>
std::vector<T> counting(std::size_t count, int modulo, int first = 0) {
    std::vector<T> voxels(count);
    for (std::size_t i = 0; i < count; ++i) voxels[i] = static_cast<T>(first + static_cast<int>(i * 7 % modulo));
    return voxels;
}

class Tiff : public InTemporaryFolder {
 protected:
    template <class T>
    void expect_round_trip(const std::vector<T>& voxels, const Format& format) {
        const fs::path path = folder / "volume.tif";
        write_tiff(path, 19, 11, voxels, format);
        const auto found = all_voxels(read_label_volume(path, unit_voxels()));
        EXPECT_EQ(found, std::vector<std::int32_t>(voxels.begin(), voxels.end()));
    }
};

constexpr int volume_voxels = 19 * 11 * 10;

TEST_F(Tiff, OfEachIntegerTypeIsReadAsItIs) {
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 250), {.bits = 8});
    expect_round_trip(counting<std::int8_t>(volume_voxels, 250, -120), {.bits = 8, .sample_format = SAMPLEFORMAT_INT});
    expect_round_trip(counting<std::uint16_t>(volume_voxels, 60000), {.bits = 16});
    expect_round_trip(counting<std::int16_t>(volume_voxels, 60000, -30000),
                      {.bits = 16, .sample_format = SAMPLEFORMAT_INT});
    expect_round_trip(counting<std::uint32_t>(volume_voxels, 1 << 30), {.bits = 32});
    expect_round_trip(counting<std::int32_t>(volume_voxels, 1 << 30, -5),
                      {.bits = 32, .sample_format = SAMPLEFORMAT_INT});
}

TEST_F(Tiff, OfFewBitsIsUnpacked) {
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 2), {.bits = 1});
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 4), {.bits = 2});
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 16), {.bits = 4});
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 2), {.bits = 1, .compression = COMPRESSION_CCITTFAX4});
}

TEST_F(Tiff, OfEachCompressionIsRead) {
    for (const int compression : {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS, COMPRESSION_ZSTD})
        if (TIFFIsCODECConfigured(compression)) {
            expect_round_trip(counting<std::uint8_t>(volume_voxels, 5), {.compression = compression});
            expect_round_trip(counting<std::uint16_t>(volume_voxels, 999), {.bits = 16, .compression = compression});
        }
    expect_round_trip(counting<std::uint16_t>(volume_voxels, 999),
                      {.bits = 16, .compression = COMPRESSION_LZW, .predictor = PREDICTOR_HORIZONTAL});
}

TEST_F(Tiff, InTilesIsRead) {
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 200), {.tile = 16});
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 4), {.bits = 2, .tile = 16});
}

TEST_F(Tiff, InOneStripOrInBigEndianOrBigTiffIsRead) {
    expect_round_trip(counting<std::uint16_t>(volume_voxels, 999), {.bits = 16, .mode = "wb", .rows_per_strip = 11});
    expect_round_trip(counting<std::uint16_t>(volume_voxels, 999), {.bits = 16, .mode = "w8"});
    expect_round_trip(counting<std::uint32_t>(volume_voxels, 99999), {.bits = 32, .mode = "w8b"});
}

TEST_F(Tiff, WithPaletteGivesIndicesNotColours) {
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 3), {.palette = true});
    expect_round_trip(counting<std::uint8_t>(volume_voxels, 3), {.bits = 4, .palette = true});
}

TEST_F(Tiff, OfFloatsIsThresholded) {
    const fs::path path = folder / "grey.tif";
    write_tiff<float>(path, 2, 2, {0.4F, 0.5F, 0.6F, std::numeric_limits<float>::quiet_NaN()},
                      {.bits = 32, .sample_format = SAMPLEFORMAT_IEEEFP});
    VolumeOptions options = unit_voxels();
    options.thresholds = {0.5};
    EXPECT_THAT(all_voxels(read_label_volume(path, options)), ElementsAre(0, 0, 1, 0));
    EXPECT_THAT([&] { read_label_volume(path, unit_voxels()); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("grey.tif"), HasSubstr("give --threshold or --otsu"))));
}

TEST_F(Tiff, OfDoublesAndIntegersIsThresholded) {
    VolumeOptions options = unit_voxels();
    options.thresholds = {100};
    write_tiff<double>(folder / "a.tif", 2, 1, {100.0, 100.0001}, {.bits = 64, .sample_format = SAMPLEFORMAT_IEEEFP});
    EXPECT_THAT(all_voxels(read_label_volume(folder / "a.tif", options)), ElementsAre(0, 1));
    write_tiff<std::uint8_t>(folder / "b.tif", 2, 1, {100, 101});
    EXPECT_THAT(all_voxels(read_label_volume(folder / "b.tif", options)), ElementsAre(0, 1));
    write_tiff<std::uint32_t>(folder / "c.tif", 2, 1, {100, 4000000000}, {.bits = 32});
    EXPECT_THAT(all_voxels(read_label_volume(folder / "c.tif", options)), ElementsAre(0, 1));
}

TEST_F(Tiff, LabelsAreRenamedOnReading) {
    write_tiff<std::uint16_t>(folder / "a.tif", 4, 1, {0, 255, 7, 1000}, {.bits = 16});
    VolumeOptions options = unit_voxels();
    options.relabel = {{255, 1}, {1000, 2}};
    EXPECT_THAT(all_voxels(read_label_volume(folder / "a.tif", options)), ElementsAre(0, 1, 7, 2));
}

TEST_F(Tiff, RegionGivesTheSameVoxelsInTheSamePlace) {
    const auto voxels = counting<std::uint8_t>(volume_voxels, 250);
    for (const Format& format : {Format{}, Format{.tile = 16}}) {
        write_tiff(folder / "a.tif", 19, 11, voxels, format);
        VolumeOptions options = unit_voxels();
        options.voxel_size = Vec3(1, 2, 3);
        options.origin = Vec3(100, 0, 0);
        options.region = {VoxelIndex{3, 4, 1}, VoxelIndex{15, 5, 9}};
        const LabelVolume part = read_label_volume(folder / "a.tif", options);
        EXPECT_EQ(part.size(), (VoxelIndex{15, 5, 9}));
        EXPECT_EQ(part.origin(), Vec3(103, 8, 3));
        const LabelVolume::Sampler sampler(part);
        for (int z = 0; z < 9; ++z)
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 15; ++x)
                    ASSERT_EQ(sampler.at({x, y, z}), voxels[((z + 1) * 11 + y + 4) * 19 + x + 3]);
    }
}

TEST_F(Tiff, RejectsARegionOutsideTheVolume) {
    write_tiff(folder / "a.tif", 19, 11, counting<std::uint8_t>(volume_voxels, 9));
    VolumeOptions options = unit_voxels();
    options.region = {VoxelIndex{0, 0, 5}, VoxelIndex{19, 11, 6}};
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", options); },
                ThrowsMessage<InvalidInput>(HasSubstr("region 5:11 along z")));
}

TEST_F(Tiff, RejectsWhatIsNotThere) {
    EXPECT_THAT([&] { read_label_volume(folder / "none.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("none.tif"), HasSubstr("does not exist"))));
}

TEST_F(Tiff, RejectsWhatIsNotATiff) {
    std::ofstream(folder / "a.tif") << "once upon a time";
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("not a TIFF")));
    std::ofstream(folder / "b.tif") << "";
    EXPECT_THAT([&] { read_label_volume(folder / "b.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("empty")));
}

TEST_F(Tiff, CutAnywhereIsRejectedInOneLine) {
    const fs::path path = folder / "a.tif";
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
        write_tiff(path, 19, 11, counting<std::uint8_t>(volume_voxels, 200), {.compression = compression});
        const auto size = fs::file_size(path);
        for (int part = 1; part < 40; ++part) {
            write_tiff(path, 19, 11, counting<std::uint8_t>(volume_voxels, 200), {.compression = compression});
            fs::resize_file(path, size * part / 40);
            EXPECT_THAT([&] { read_label_volume(path, unit_voxels()); },
                        ThrowsMessage<InvalidInput>(AllOf(HasSubstr("cut or damaged"), Not(HasSubstr("\n")))))
                << part << "/40";
        }
    }
}

TEST_F(Tiff, CutBehindItsDirectoryIsRejected) {
    // 4 x 4 voxels whose directory comes first, as tomographs and ImageJ write them.
    std::string bytes("II*\0\x08\0\0\0", 8);
    const auto number = [&bytes](std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i);
    };
    const std::vector<std::array<std::uint32_t, 2>> entries{{256, 4},   {257, 4}, {258, 8}, {259, 1}, {262, 1},
                                                            {273, 122}, {277, 1}, {278, 4}, {279, 16}};
    number(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, value] : entries) {
        number(tag, 2);
        number(4, 2);  // a 32-bit number
        number(1, 4);
        number(value, 4);
    }
    bytes.resize(122, '\0');
    for (int i = 0; i < 16; ++i) bytes += static_cast<char>(i);
    const auto write = [&](std::size_t size) {
        std::ofstream(folder / "a.tif", std::ios::binary) << bytes.substr(0, size);
    };
    write(bytes.size());
    EXPECT_EQ(LabelVolume::Sampler(read_label_volume(folder / "a.tif", unit_voxels())).at({3, 3, 0}), 15);
    for (const std::size_t size : {bytes.size() - 1, std::size_t{123}, std::size_t{60}}) {
        write(size);
        EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                    ThrowsMessage<InvalidInput>(AllOf(HasSubstr("cut or damaged"), Not(HasSubstr("\n")))))
            << size;
    }
}

TEST_F(Tiff, WithDamagedVoxelsIsRejected) {
    const fs::path path = folder / "a.tif";
    write_tiff(path, 19, 11, counting<std::uint8_t>(volume_voxels, 200), {.compression = COMPRESSION_ADOBE_DEFLATE});
    std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(8) << "damaged damaged";
    EXPECT_THAT([&] { read_label_volume(path, unit_voxels()); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("slice 0"), HasSubstr("damaged in piece"))));
}

TEST_F(Tiff, RejectsPagesOfDifferentSize) {
    write_tiff(folder / "a.tif", 19, 11, counting<std::uint8_t>(19 * 11 * 2, 9));
    write_tiff(folder / "a.tif", 18, 11, counting<std::uint8_t>(18 * 11, 9), {.mode = "a"});
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("slice 2 is 18 x 11"), HasSubstr("slice 0 is 19 x 11"))));
}

TEST_F(Tiff, RejectsColours) {
    TIFF* tiff = TIFFOpen((folder / "a.tif").c_str(), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    std::vector<std::uint8_t> row(6, 1);
    TIFFWriteScanline(tiff, row.data(), 0, 0);
    TIFFClose(tiff);
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("3 values a voxel")));
}

TEST_F(Tiff, RejectsLabelsBeyondTheLargest) {
    write_tiff<std::uint32_t>(folder / "a.tif", 2, 1, {1, 3000000000}, {.bits = 32});
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("above 2147483647")));
}

TEST_F(Tiff, RejectsAnImageJStackWithoutThePlanesThatItAnnounces) {
    TIFF* tiff = TIFFOpen((folder / "a.tif").c_str(), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, "ImageJ=1.53t\nimages=3\nslices=3\n");
    std::vector<std::uint8_t> row(2, 1);
    TIFFWriteScanline(tiff, row.data(), 0, 0);
    TIFFClose(tiff);
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("says that it holds 3 slices but there is one page")));
}

TEST_F(Tiff, RejectsPagesOfDifferentType) {
    write_tiff(folder / "a.tif", 2, 2, std::vector<std::uint8_t>(4), {});
    write_tiff(folder / "a.tif", 2, 2, std::vector<std::uint16_t>(4), {.bits = 16, .mode = "a"});
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", unit_voxels()); },
                ThrowsMessage<InvalidInput>(HasSubstr("slice 1 holds uint16 but slice 0 holds uint8")));
}

class SliceFolder : public InTemporaryFolder {
 protected:
    void slice(const std::string& name, std::uint8_t value) {
        write_tiff<std::uint8_t>(folder / name, 2, 1, {value, value});
    }
    void expect_refused(const std::string& part) {
        EXPECT_THAT([&] { read_label_volume(folder, unit_voxels()); },
                    ThrowsMessage<InvalidInput>(AllOf(HasSubstr(folder.string()), HasSubstr(part))));
    }
};

TEST_F(SliceFolder, IsReadInTheOrderOfNumbersAmongOtherFiles) {
    for (int i = 8; i <= 11; ++i) slice("img3_" + std::to_string(i) + "_of_20.TIFF", i);
    std::ofstream(folder / "README.md") << "300 slices";
    std::ofstream(folder / "LICENSE.txt") << "";
    std::ofstream(folder / "._img3_8_of_20.TIFF") << "left by a Mac";
    fs::create_directory(folder / "thumbs.tif");
    EXPECT_THAT(all_voxels(read_label_volume(folder, unit_voxels())), ElementsAre(8, 8, 9, 9, 10, 10, 11, 11));
    EXPECT_EQ(read_label_volume(folder / "", unit_voxels()).size()[2], 4) << "with a slash at its end";
}

TEST_F(SliceFolder, OfOneSliceIsAVolumeOfOneSlice) {
    slice("only.tif", 4);
    EXPECT_EQ(read_label_volume(folder, unit_voxels()).size(), (VoxelIndex{2, 1, 1}));
}

TEST_F(SliceFolder, RejectsNoSlices) {
    expect_refused("no slice");
}

TEST_F(SliceFolder, NamesTheMissingSlice) {
    for (int i : {0, 1, 2, 4, 5}) slice("s_00" + std::to_string(i) + ".tif", 1);
    expect_refused("slice number 3 is missing");
    fs::remove(folder / "s_004.tif");
    expect_refused("slice numbers 3 to 4 are missing");
}

TEST_F(SliceFolder, RejectsTwoSeries) {
    slice("a_0.tif", 1);
    slice("b_0.tif", 1);
    expect_refused("'a_0.tif' and 'b_0.tif' are not slices of one series");
    fs::remove(folder / "b_0.tif");
    slice("a_1.tif", 1);
    slice("a_01.tif", 1);
    expect_refused("same number");
}

TEST_F(SliceFolder, RejectsNamesThatDifferInTwoNumbers) {
    slice("t1_z0.tif", 1);
    slice("t1_z1.tif", 1);
    slice("t2_z0.tif", 1);
    expect_refused("more than one number");
}

TEST_F(SliceFolder, RejectsSlicesOfDifferentSize) {
    slice("a_0.tif", 1);
    slice("a_1.tif", 1);
    write_tiff<std::uint8_t>(folder / "a_1.tif", 3, 1, {1, 2, 3});
    expect_refused("slice 'a_1.tif' is 3 x 1 pixels but slice 'a_0.tif' is 2 x 1");
}

TEST_F(SliceFolder, RejectsASliceThatIsCutOrNoTiff) {
    slice("a_0.tif", 1);
    slice("a_1.tif", 1);
    fs::resize_file(folder / "a_1.tif", 40);
    expect_refused("a_1.tif': the file is cut or damaged");
    std::ofstream(folder / "a_1.tif") << "text";
    expect_refused("a_1.tif': it is not a TIFF");
}

TEST_F(SliceFolder, RejectsSlicesOfSeveralPages) {
    slice("a_0.tif", 1);
    write_tiff<std::uint8_t>(folder / "a_1.tif", 2, 1, {1, 2, 3, 4});
    expect_refused("several pages");
}

class WrittenVolume : public InTemporaryFolder {
 protected:
    int bits_of(const fs::path& path) {
        TIFF* tiff = TIFFOpen(path.c_str(), "r");
        std::uint16_t bits = 0;
        TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
        TIFFClose(tiff);
        return bits;
    }
    void expect_round_trip(const std::vector<std::int32_t>& voxels, int bits) {
        LabelVolume volume({5, 4, 9}, Vec3::Ones());
        volume.set_slices(0, 9, voxels);
        write_label_volume(volume, folder / "a.tif");
        EXPECT_EQ(all_voxels(read_label_volume(folder / "a.tif", unit_voxels())), voxels);
        EXPECT_EQ(bits_of(folder / "a.tif"), bits);
    }
};

TEST_F(WrittenVolume, IsReadBackWithTheFewestBits) {
    expect_round_trip(counting<std::int32_t>(180, 200), 8);
    expect_round_trip(counting<std::int32_t>(180, 1200), 16);
    expect_round_trip(counting<std::int32_t>(180, 200, 70000), 32);
    expect_round_trip(counting<std::int32_t>(180, 200, -3), 32);
}

TEST_F(WrittenVolume, LeavesNothingBehindWhenTheFolderIsNotThere) {
    EXPECT_THAT(
        [&] {
            write_label_volume(LabelVolume({1, 1, 1}, Vec3::Ones()), folder / "none" / "a.tif");
        },
        ThrowsMessage<InvalidInput>(HasSubstr("none")));
}

TEST_F(WrittenVolume, OfGreyValuesIsRoundedAndCutToTheTypeOfItsFileAndKeepsItsPlace) {
    struct Case {
        VoxelType type;
        std::vector<float> written;
    };
    const std::vector<float> values{-300.4F, -3.5F, 0.4F, 127.6F, 300.2F, 70000.F};
    for (const Case& one :
         {Case{VoxelType::uint8, {0, 0, 0, 128, 255, 255}}, Case{VoxelType::int8, {-128, -4, 0, 127, 127, 127}},
          Case{VoxelType::uint16, {0, 0, 0, 128, 300, 65535}}, Case{VoxelType::int16, {-300, -4, 0, 128, 300, 32767}},
          Case{VoxelType::float64, values}, Case{VoxelType::int32, values}}) {
        GreyVolume grey{{3, 1, 2}, Vec3(0.002, 0.002, 0.005), Vec3(1, 2, 3), one.type, values, ""};
        write_grey_volume(grey, folder / "grey.tif", silent_reporter());
        const GreyVolume found = read_grey_volume(folder / "grey.tif", {}, 2, silent_reporter());
        EXPECT_EQ(found.values, one.written) << name_of(one.type);
        EXPECT_EQ(found.type, grey.stored_type());
        EXPECT_EQ(found.size, grey.size);
        EXPECT_EQ(found.spacing, grey.spacing);
        EXPECT_EQ(found.origin, grey.origin);
    }
}

TEST_F(WrittenVolume, OfARegionOfGreyValuesInBlocksHoldsTheirMeansAtTheirPlace) {
    GreyVolume grey{{4, 4, 2}, Vec3::Constant(0.5), Vec3::Zero(), VoxelType::uint8, std::vector<float>(32), ""};
    for (std::size_t i = 0; i < grey.values.size(); ++i) grey.values[i] = static_cast<float>(i);
    write_grey_volume(grey, folder / "grey.tif", silent_reporter());
    VolumeOptions options;
    options.region = {{VoxelIndex{2, 0, 0}, VoxelIndex{2, 4, 2}}};
    options.bin = {2, 2, 2};
    const GreyVolume found = read_grey_volume(folder / "grey.tif", options, 1, silent_reporter());
    EXPECT_THAT(found.values, ElementsAre(12.5F, 20.5F));  // of 2, 3, 6, 7, 18, 19, 22, 23, and 8 more than each
    EXPECT_EQ(found.spacing, Vec3::Constant(1));
    EXPECT_EQ(found.origin, Vec3(1, 0, 0));
    EXPECT_EQ(found.stored_type(), VoxelType::float32);
}

}  // namespace
}  // namespace tomodem
