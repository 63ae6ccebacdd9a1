#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "core/base/error.hpp"
#include "core/volume/volume.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/volume/vdb_writer.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr VoxelIndex size{7, 5, 11};
constexpr int voxel_count = 7 * 5 * 11;

/// A label that encodes where its voxel is, whatever the axes are called.
std::int32_t label_at(int i) {
    return 1 + (i * 37) % 199;
}

std::vector<std::int32_t> labels() {
    std::vector<std::int32_t> all(voxel_count);
    for (int i = 0; i < voxel_count; ++i) all[i] = label_at(i);
    return all;
}

template <class T>
std::string bytes(bool big_endian = false, int first = 0, int count = voxel_count) {
    std::string all;
    for (int i = first; i < first + count; ++i) {
        const T value = static_cast<T>(label_at(i));
        std::string one(reinterpret_cast<const char*>(&value), sizeof value);
        if (big_endian) std::reverse(one.begin(), one.end());
        all += one;
    }
    return all;
}

std::string deflated(const std::string& plain, bool gzip) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 15 + (gzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY);
    std::string packed(plain.size() + 1000, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
    stream.avail_in = static_cast<uInt>(plain.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

template <class T>
void append(std::string& text, T value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// What ImageJ writes for a stack that is too long for pages: one directory at the start, all planes behind it.
std::string imagej(bool big_endian, const std::string& description, const std::string& planes) {
    const auto order = [big_endian](auto value) {
        if (!big_endian) return value;
        auto raw = std::bit_cast<std::array<char, sizeof value>>(value);
        std::reverse(raw.begin(), raw.end());
        return std::bit_cast<decltype(value)>(raw);
    };
    struct Entry {
        std::uint16_t tag, type;
        std::uint32_t count, value;
    };
    constexpr std::uint32_t entries = 11, text_at = 8 + 2 + 12 * entries + 4, ratio_at = text_at + 400;
    constexpr std::uint32_t data_at = ratio_at + 8;
    const auto word = [&](std::uint32_t value) {
        return big_endian ? value << 16 : value;
    };  // a short in a long's place
    const std::vector<Entry> list{{256, 4, 1, 7},        {257, 4, 1, 5},         {258, 3, 1, word(16)},
                                  {262, 3, 1, word(1)},  {270, 2, 400, text_at}, {273, 4, 1, data_at},
                                  {277, 3, 1, word(1)},  {278, 3, 1, word(5)},   {279, 4, 1, 7 * 5 * 2},
                                  {282, 5, 1, ratio_at}, {283, 5, 1, ratio_at}};
    std::string file = big_endian ? "MM" : "II";
    append(file, order(std::uint16_t{42}));
    append(file, order(std::uint32_t{8}));
    append(file, order(static_cast<std::uint16_t>(list.size())));
    for (const Entry& entry : list) {
        append(file, order(entry.tag));
        append(file, order(entry.type));
        append(file, order(entry.count));
        append(file, order(entry.value));
    }
    append(file, std::uint32_t{0});
    file += description;
    file.resize(ratio_at, '\0');
    append(file, order(std::uint32_t{1000}));  // pixels in ...
    append(file, order(std::uint32_t{2400}));  // ... units
    return file + planes;
}

void write_hdf5(const fs::path& path, const std::string& dataset, bool chunked) {
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hsize_t zyx[3] = {11, 5, 7}, chunk[3] = {4, 3, 2};
    const hid_t space = H5Screate_simple(3, zyx, nullptr), how = H5Pcreate(H5P_DATASET_CREATE);
    if (chunked) {
        H5Pset_chunk(how, 3, chunk);
        H5Pset_deflate(how, 4);
    }
    const hid_t data = H5Dcreate2(file, dataset.c_str(), H5T_STD_U16BE, space, links, how, H5P_DEFAULT);
    const std::vector<std::int32_t> values = labels();
    H5Dwrite(data, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    const hsize_t three = 3;
    const hid_t row = H5Screate_simple(1, &three, nullptr);
    const hid_t attribute = H5Acreate2(data, "element_size_um", H5T_NATIVE_DOUBLE, row, H5P_DEFAULT, H5P_DEFAULT);
    const double size_um[3] = {5, 2.4, 2.4};
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, size_um);
    H5Aclose(attribute);
    H5Dclose(data);
    for (const hid_t id : {space, row}) H5Sclose(id);
    for (const hid_t id : {links, how}) H5Pclose(id);
    H5Fclose(file);
}

class Formats : public InTemporaryFolder {
 protected:
    struct Made {
        std::string spec;         // what a user would give
        fs::path data;            // the file to damage
        bool has_header = false;  // the file starts with something to damage
        std::optional<RawLayout> raw = {};
    };

    /// The same volume in every format. All know or ignore the voxel size 2.4 um.
    std::map<std::string, Made> all() {
        std::map<std::string, Made> made;
        const auto add = [&](const std::string& name, const std::string& text) {
            put(folder / name, text);
            return (folder / name).string();
        };
        const std::string size_lines = "NUM_X = 7\nNUM_Y = 5\nNUM_Z = 11\nvoxelSize = 2.4\n";
        add("a.vol.info", "! PyHST_SLAVE VOLUME INFO FILE\n" + size_lines + "BYTEORDER = HIGHBYTEFIRST\n");
        add("b.raw.xml",
            "<tomodb2><reconstruction><listSubVolume><subVolume><SIZEX>7</SIZEX><SIZEY>5</SIZEY>"
            "<SIZEZ>11</SIZEZ><BYTE_ORDER>LOWBYTEFIRST</BYTE_ORDER></subVolume></listSubVolume>"
            "</reconstruction></tomodb2>");
        add("c.raw.info", size_lines);
        const std::string vol = add("a.vol", bytes<float>(true)), raw8 = add("b.raw", bytes<std::uint8_t>()),
                          raw16 = add("c.raw", bytes<std::uint16_t>());
        made["ESRF .vol of big-endian floats"] = {vol, vol};
        made["ESRF .raw with .xml"] = {raw8, raw8};
        made["ESRF .info of 16 bits"] = {raw16 + ".info", raw16};

        const std::string meta =
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 7 5 11\n"
            "ElementSpacing = 2.4 2.4 2.4\n";
        const std::string mha =
            add("d.mha", meta + "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" + bytes<std::int16_t>());
        made["MetaImage in one file"] = {mha, mha, true};
        const std::string d = add("e.zraw", deflated(bytes<std::uint32_t>(), false));
        made["MetaImage, compressed"] = {add("e.mhd", meta + "CompressedData = True\nElementType = MET_UINT\n"
                                                             "ElementDataFile = e.zraw\n"),
                                         d};
        const std::string big = add("f.raw_", "skip" + bytes<std::int32_t>(true));
        made["MetaImage, big-endian behind a header"] = {
            add("f.mhd", meta +
                             "BinaryDataByteOrderMSB = True\nHeaderSize = -1\nElementType = MET_INT\nElementDataFile = "
                             "f.raw_\n"),
            big};
        for (int k = 0; k < 11; ++k) add(fmt::format("g{:02d}.bin", k + 2), bytes<std::uint8_t>(false, 35 * k, 35));
        made["MetaImage of a file for each slice"] = {
            add("g.mhd", meta + "ElementType = MET_UCHAR\nElementDataFile = g%02d.bin 2 12 1\n"), folder / "g07.bin"};

        const std::string nrrd =
            "NRRD0004\n# comment\ntype: unsigned short\ndimension: 3\nsizes: 7 5 11\nendian: big\n";
        const std::string n1 = add("h.nrrd", nrrd + "spacings: 1 1 1\nencoding: raw\n\n" + bytes<std::uint16_t>(true));
        made["NRRD, big-endian"] = {n1, n1, true};
        const std::string n2 = add("i.nrrd", nrrd +
                                                 "space units: \"um\" \"um\" \"um\"\nspace directions: (2.4,0,0) "
                                                 "(0,2.4,0) (0,0,2.4)\nkey:=value\nencoding: gzip\n\n" +
                                                 deflated(bytes<std::uint16_t>(true), true));
        made["NRRD, gzip"] = {n2, n2, true};
        const std::string n3 = add("j.gz", deflated(bytes<std::uint16_t>(true), true));
        made["NRRD with a file beside it"] = {add("j.nhdr", nrrd + "encoding: gzip\ndata file: j.gz\n"), n3};

        write_hdf5(folder / "k.h5", "/exchange/data", true);
        made["HDF5 in chunks"] = {folder / "k.h5", folder / "k.h5", true};
        write_hdf5(folder / "l.h5", "/entry/volume", false);
        made["HDF5 dataset by its name"] = {(folder / "l.h5").string() + ":/entry/volume", folder / "l.h5", true};

        const std::string about = "ImageJ=1.53t\nimages=11\nslices=11\nunit=\\u00B5m\nspacing=2.4\n";
        const std::string j1 = add("m.tif", imagej(true, about, bytes<std::uint16_t>(true)));
        made["ImageJ stack of one page, big-endian"] = {j1, j1, true};
        const std::string j2 = add("n.tif", imagej(false, about, bytes<std::uint16_t>()));
        made["ImageJ stack of one page, little-endian"] = {j2, j2, true};

        const std::string raw = add("o.dat", "head" + bytes<std::int16_t>(true));
        made["raw voxels"] = {raw, raw, false, RawLayout{size, VoxelType::int16, true, 4}};
        write_vdb(folder / "p.vdb", size, labels());
        made["OpenVDB"] = {folder / "p.vdb", folder / "p.vdb", true};
        return made;
    }

    static LabelVolume read(const Made& made) {
        VolumeOptions options;
        options.voxel_size = Vec3(2.4e-3, 2.4e-3, 0);
        options.raw = made.raw;
        if (fs::path(made.spec).extension() == ".vol") {
            // Whole floats as labels: one threshold between each two of them.
            for (int label = 0; label < 200; ++label) options.thresholds.push_back(label + 0.5);
        }
        return read_label_volume(made.spec, options);
    }
};

std::vector<std::int32_t> all_voxels(const LabelVolume& volume) {
    std::vector<std::int32_t> voxels;
    volume.slices(0, volume.size()[2], voxels);
    return voxels;
}

TEST_F(Formats, GiveTheSameVoxels) {
    for (const auto& [name, made] : all()) {
        const LabelVolume volume = read(made);
        EXPECT_EQ(volume.size(), size) << name;
        EXPECT_EQ(all_voxels(volume), labels()) << name;
    }
}

TEST_F(Formats, GiveTheSameRegion) {
    for (const auto& [name, made] : all()) {
        if (fs::path(made.spec).extension() == ".vol") continue;
        VolumeOptions options;
        options.voxel_size = Vec3(2.4e-3, 2.4e-3, 0);
        options.raw = made.raw;
        options.region = {VoxelIndex{2, 1, 3}, VoxelIndex{4, 3, 6}};
        std::vector<std::int32_t> expected;
        for (int z = 3; z < 9; ++z)
            for (int y = 1; y < 4; ++y)
                for (int x = 2; x < 6; ++x) expected.push_back(label_at((z * 5 + y) * 7 + x));
        EXPECT_EQ(all_voxels(read_label_volume(made.spec, options)), expected) << name;
    }
}

TEST_F(Formats, CutAtEverySixteenthAreRefusedInOneLine) {
    for (const auto& [name, made] : all()) {
        const std::string whole = content(made.data);
        for (std::size_t part = 0; part < 16; ++part) {
            // A .info does not say how many bytes a value has: half of 16 bits is a whole of 8.
            if (made.spec.ends_with(".info") && part == 8) continue;
            put(made.data, whole.substr(0, whole.size() * part / 16));
            const auto reading = [one = made] { read(one); };
            EXPECT_THAT(reading,
                        ThrowsMessage<InvalidInput>(AllOf(HasSubstr("cannot read volume"), Not(HasSubstr("\n")))))
                << name << ", " << part << "/16";
        }
        put(made.data, whole);
    }
}

TEST_F(Formats, WithADamagedHeaderAreReadOrRefusedInOneLine) {
    std::uint32_t random = 1;
    const auto next = [&random] { return random = random * 1664525u + 1013904223u; };
    for (const auto& [name, made] : all()) {
        if (!made.has_header) continue;
        const std::string whole = content(made.data);
        // A damaged OpenVDB grid may be a good one of a billion voxels.
        const int attempts = name == "OpenVDB" ? 10 : 100;
        for (int attempt = 0; attempt < attempts; ++attempt) {
            std::string damaged = whole;
            for (int flips = 0; flips < 3; ++flips)
                damaged[next() / 7 % std::min<std::size_t>(whole.size(), 600)] ^=
                    static_cast<char>(1 << next() / 7 % 8);
            put(made.data, damaged);
            try {
                read(made);
            } catch (const InvalidInput& error) {
                EXPECT_THAT(error.what(), Not(HasSubstr("\n"))) << name;
            }
        }
        put(made.data, whole);
    }
}

TEST_F(Formats, KnowTheirVoxelSizeWhereTheyHaveAUnit) {
    const auto made = all();
    for (const char* name : {"ESRF .info of 16 bits", "NRRD, gzip", "ImageJ stack of one page, big-endian"})
        EXPECT_TRUE(read_label_volume(made.at(name).spec, {}).spacing().isApprox(Vec3::Constant(2.4e-3), 1e-6)) << name;
    EXPECT_TRUE(read_label_volume(made.at("HDF5 in chunks").spec, {}).spacing().isApprox(Vec3(2.4e-3, 2.4e-3, 5e-3)))
        << "z, y, x";
    for (const char* name : {"ESRF .raw with .xml", "MetaImage in one file", "NRRD, big-endian", "OpenVDB"})
        EXPECT_THAT([&] { read_label_volume(made.at(name).spec, {}); },
                    ThrowsMessage<InvalidInput>(HasSubstr("give it with --voxel-size")))
            << name;
}

TEST_F(Formats, RefuseAnotherVoxelSizeThanTheirs) {
    const auto made = all();
    VolumeOptions options;
    options.voxel_size = Vec3(3e-3, 3e-3, 0);
    EXPECT_THAT([&] { read_label_volume(made.at("NRRD, gzip").spec, options); },
                ThrowsMessage<InvalidInput>(HasSubstr("voxels are 2.4 x 2.4 x 2.4 um, but 3 um are given")));
    options.voxel_size = Vec3(2.4e-3, 2.4e-3, 5e-3);
    EXPECT_THAT([&] { read_label_volume(made.at("MetaImage in one file").spec, options); },
                ThrowsMessage<InvalidInput>(HasSubstr("given for z")))
        << "no unit, but cubic";
    EXPECT_EQ(read_label_volume(made.at("HDF5 in chunks").spec, options).spacing(), Vec3(2.4e-3, 2.4e-3, 5e-3));
}

TEST_F(Formats, WithoutAUnitKeepTheShapeOfTheirVoxels) {
    put(folder / "flat.mha",
        "NDims = 3\nDimSize = 1 1 2\nElementSpacing = 1 1 20\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nab");
    VolumeOptions options;
    options.voxel_size = Vec3(1e-3, 1e-3, 0);
    EXPECT_EQ(read_label_volume(folder / "flat.mha", options).spacing(), Vec3(1e-3, 1e-3, 20e-3));
}

TEST_F(Formats, TakeTheirPlaceInTheWorldFromTheFile) {
    put(folder / "placed.mha",
        "NDims = 3\nDimSize = 1 1 2\nElementSpacing = 1 1 2\nOffset = 10 20 30\nDistanceUnits = um\n"
        "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nab");
    EXPECT_TRUE(read_label_volume(folder / "placed.mha", {}).origin().isApprox(Vec3(9.5e-3, 19.5e-3, 29e-3)))
        << "the centre of the first voxel is given";
}

TEST_F(Formats, WithMoreOrFewerVoxelsThanTheyAnnounceAreRefused) {
    put(folder / "a.vol.info", "NUM_X = 2\nNUM_Y = 2\nNUM_Z = 2\n");
    put(folder / "a.vol", std::string(4 * 9, '\0'));
    VolumeOptions options;
    options.voxel_size = Vec3::Ones();
    options.thresholds = {0.5};
    EXPECT_THAT([&] { read_label_volume(folder / "a.vol", options); },
                ThrowsMessage<InvalidInput>(HasSubstr("it has 36 bytes, but 2 x 2 x 2 voxels of float32 take 32")));
}

TEST_F(Formats, OfSeveralDatasetsAskWhichIsMeant) {
    const hid_t file = H5Fcreate((folder / "two.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hsize_t zyx[3] = {1, 1, 1};
    const hid_t space = H5Screate_simple(3, zyx, nullptr);
    for (const char* name : {"first", "second"})
        H5Dclose(H5Dcreate2(file, name, H5T_NATIVE_UINT8, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Fclose(file);
    EXPECT_THAT([&] { read_label_volume(folder / "two.h5", {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("say which, as two.h5:/first")));
    EXPECT_THAT([&] { read_label_volume((folder / "two.h5").string() + ":third", {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("no dataset '/third'")));
}

TEST_F(Formats, ImageJHyperstacksOfChannelsAreRefused) {
    put(folder / "a.tif", imagej(false, "ImageJ=1.53t\nimages=22\nchannels=2\nslices=11\n", bytes<std::uint16_t>()));
    EXPECT_THAT([&] { read_label_volume(folder / "a.tif", {}); }, ThrowsMessage<InvalidInput>(HasSubstr("2 channels")));
}

TEST_F(Formats, ThatAreUnknownAreNamedWithTheKnownOnes) {
    put(folder / "a.dat", "something");
    EXPECT_THAT([&] { read_label_volume(folder / "a.dat", {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("of no known format (ESRF")));
    put(folder / "a.vol", "something");
    EXPECT_THAT([&] { read_label_volume(folder / "a.vol", {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("no 'a.vol.info' or '.xml' beside it")));
}

/// A raw volume of floats.
class Grey : public InTemporaryFolder {
 protected:
    VolumeOptions write(const VoxelIndex& of, const std::vector<float>& values) {
        std::ofstream(folder / "grey.dat", std::ios::binary)
            .write(reinterpret_cast<const char*>(values.data()), std::ssize(values) * 4);
        VolumeOptions options;
        options.voxel_size = Vec3::Ones();
        options.raw = RawLayout{of, VoxelType::float32, false, 0};
        return options;
    }
    LabelVolume read(const VolumeOptions& options) { return read_label_volume(folder / "grey.dat", options); }
};

TEST_F(Grey, SeveralThresholdsMakeAsManyLabels) {
    VolumeOptions options = write({5, 1, 1}, {0, 10, 10.5, 20, 30});
    options.thresholds = {10, 20};
    EXPECT_THAT(all_voxels(read(options)), ElementsAre(0, 0, 1, 1, 2));
}

TEST_F(Grey, NotANumberIsBelowTheThreshold) {
    VolumeOptions options = write({3, 1, 1}, {NAN, 1, -INFINITY});
    options.thresholds = {0.5};
    EXPECT_THAT(all_voxels(read(options)), ElementsAre(0, 1, 0));
}

TEST_F(Grey, OtsuCutsBetweenThePeaks) {
    VolumeOptions options = write({8, 1, 1}, {1, 1.1F, 0.9F, 5, 5.1F, 4.9F, 5, 1});
    options.otsu_levels = 1;
    EXPECT_THAT(all_voxels(read(options)), ElementsAre(0, 0, 0, 1, 1, 1, 1, 0));
    options = write({9, 1, 1}, {1, 1.1F, 0.9F, 5, 5.1F, 4.9F, 9, 9, 9.2F});
    options.otsu_levels = 2;
    EXPECT_THAT(all_voxels(read(options)), ElementsAre(0, 0, 0, 1, 1, 1, 2, 2, 2));
    options = write({4, 1, 1}, {3, 3, 3, 3});
    options.otsu_levels = 1;
    EXPECT_THAT([&] { read(options); }, ThrowsMessage<InvalidInput>(HasSubstr("more than 1 grey value")));
    options = write({2, 1, 1}, {NAN, NAN});
    options.otsu_levels = 1;
    EXPECT_THAT([&] { read(options); }, ThrowsMessage<InvalidInput>(HasSubstr("no grey value that is a number")));
}

TEST_F(Grey, BinningTakesTheMeanOfEachBlock) {
    VolumeOptions options = write({5, 2, 2}, {0, 4, 1, 1, 9, 0, 4, 1, 1, 9, 8, 0, 1, 1, 9, 8, 0, 3, 3, 9});
    options.bin = {2, 2, 2};
    options.thresholds = {1.4, 2.9};
    const LabelVolume volume = read(options);
    EXPECT_EQ(volume.size(), (VoxelIndex{2, 1, 1})) << "the fifth column fills no block";
    EXPECT_EQ(volume.spacing(), Vec3::Constant(2));
    EXPECT_THAT(all_voxels(volume), ElementsAre(2, 1)) << "means 3 and 1.5";
}

TEST_F(Grey, LabelsAreBinnedByTheMostFrequentAfterTheirNamesAreChanged) {
    put(folder / "l.dat", {1, 2, 3, 3, 3, 1, 3, 3, 2, 3, 1, 1});
    VolumeOptions options;
    options.voxel_size = Vec3::Ones();
    options.raw = RawLayout{{6, 2, 1}, VoxelType::uint8, false, 0};
    options.bin = {3, 2, 1};
    EXPECT_THAT(all_voxels(read_label_volume(folder / "l.dat", options)), ElementsAre(3, 1)) << "a tie: the smallest";
    options.relabel = {{2, 1}};
    EXPECT_THAT(all_voxels(read_label_volume(folder / "l.dat", options)), ElementsAre(1, 1)) << "3 and 3 of 6: a tie";
    options.bin = {7, 1, 1};
    EXPECT_THAT([&] { read_label_volume(folder / "l.dat", options); },
                ThrowsMessage<InvalidInput>(HasSubstr("6 voxels along x to be binned by 7")));
}

TEST_F(Grey, ValuesAtPointsAreThoseOfTheVoxelsAroundThem) {
    const VolumeOptions options = write({2, 2, 20}, [] {
        std::vector<float> values(80);
        for (int i = 0; i < 80; ++i) values[i] = static_cast<float>(i);
        return values;
    }());
    put(folder / "t.mha", "NDims = 3\nDimSize = 2 2 20\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n" +
                              content(folder / "grey.dat"));
    const std::vector<Vec3> points{{1.5, 0.5, 19.9}, {0, 0, 0}, {0.5, 1.5, 9.5}};
    EXPECT_THAT(read_values_at(folder / "t.mha", folder / "grey.dat", options, points), ElementsAre(77, 0, 38));
    put(folder / "u.mha", "NDims = 3\nDimSize = 1 1 1\nElementType = MET_FLOAT\nElementDataFile = LOCAL\nabcd");
    EXPECT_THAT([&] { read_values_at(folder / "u.mha", folder / "grey.dat", options, points); },
                ThrowsMessage<InvalidInput>(HasSubstr("they must be of one grid")));
}

}  // namespace
}  // namespace tomodem
