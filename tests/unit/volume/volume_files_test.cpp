#include "core/volume/volume_files.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "core/volume/volume.hpp"
#include "core/volume/volume_format.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

class VolumeFiles : public InTemporaryFolder {
 protected:
    fs::path add(const std::string& name, const std::string& text = "some bytes") {
        fs::create_directories((folder / name).parent_path());
        put(folder / name, text);
        return folder / name;
    }
    std::vector<std::string> found() const {
        std::vector<std::string> names;
        for (const fs::path& path : find_volumes(folder)) names.push_back(path.filename().string());
        return names;
    }
    static std::string meta(const std::string& data) {
        return "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = " + data + "\n";
    }
};

/// toy_format.cpp is linked into this test.
class FormatOfOneSource : public VolumeFiles {
 protected:
    fs::path toy = add("a.toy", "TOYVOL 2 2 1 3 values.txt"), values = add("values.txt", "0 1 2 3");
};

TEST_F(FormatOfOneSource, IsRead) {
    const LabelVolume volume = read_label_volume(toy, {});
    std::vector<std::int32_t> voxels;
    volume.slices(0, 1, voxels);
    EXPECT_THAT(voxels, ElementsAre(0, 1, 2, 3));
    EXPECT_DOUBLE_EQ(volume.spacing()[2], 3e-3);
}

TEST_F(FormatOfOneSource, IsRecognisedByItsFirstBytes) {
    fs::rename(toy, folder / "a.dat");
    EXPECT_EQ(read_label_volume(folder / "a.dat", {}).size(), (VoxelIndex{2, 2, 1}));
}

TEST_F(FormatOfOneSource, IsListedWithTheOthers) {
    EXPECT_EQ(volume_format_names(),
              "ESRF .vol or .raw with .info or .xml, HDF5, MetaImage, NRRD, OpenVDB, TIFF, Toy text");
    EXPECT_THAT([&] { read_label_volume(add("a.unknown"), {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("of no known format (ESRF .vol or .raw with .info or .xml, HDF5, "
                                                      "MetaImage, NRRD, OpenVDB, TIFF, Toy text)")));
}

TEST_F(FormatOfOneSource, BringsItsCompanion) {
    EXPECT_THAT(volume_files(toy), ElementsAre(toy, values));
    EXPECT_THAT(found(), ElementsAre("a.toy"));
}

TEST_F(FormatOfOneSource, IsRefusedInOneLineWhereItIsDamaged) {
    for (const std::string line : {"TOYVOL", "TOYVOL 2 2", "TOYVOL 2 2 1 3 none.txt", "TOYVOL -2 2 1 3 values.txt",
                                   "TOYVOL 9 9 9 3 values.txt", "TOYVOL 2 2 x 3 values.txt", "nothing"}) {
        put(toy, line);
        EXPECT_THAT([&] { read_label_volume(toy, {}); },
                    ThrowsMessage<InvalidInput>(AllOf(HasSubstr("cannot read volume"), Not(HasSubstr("\n")))))
            << line;
        EXPECT_THAT(volume_files(toy), testing::Contains(toy)) << line;
    }
}

TEST_F(VolumeFiles, AHeaderBringsItsData) {
    const fs::path header = add("a.mhd", meta("other.raw")), data = add("other.raw");
    EXPECT_THAT(volume_files(header), ElementsAre(header, data));
    const fs::path nrrd = add("b.nhdr", "NRRD0004\ndata file: b.gz\n"), packed = add("b.gz");
    EXPECT_THAT(volume_files(nrrd), ElementsAre(nrrd, packed));
    const fs::path several = add("c.mhd", meta("c%d.bin 1 2 1")), one = add("c1.bin"), two = add("c2.bin");
    EXPECT_THAT(volume_files(several), ElementsAre(several, one, two));
}

TEST_F(VolumeFiles, AnEsrfVolumeIsTheSameFromEachOfItsFiles) {
    const fs::path data = add("a.vol"), info = add("a.vol.info");
    EXPECT_THAT(volume_files(data), ElementsAre(info, data));
    EXPECT_THAT(volume_files(info), ElementsAre(info, data));
}

TEST_F(VolumeFiles, OfAFolderAreItsSlices) {
    const fs::path first = add("s/1.tif"), second = add("s/2.tif");
    add("s/notes.txt");
    EXPECT_THAT(volume_files(folder / "s"), ElementsAre(first, second));
    EXPECT_THAT(volume_files((folder / "s/*.tif").string()), ElementsAre(first, second));
    fs::create_directory(folder / "empty");
    EXPECT_THAT(volume_files(folder / "empty"), ElementsAre(folder / "empty"));
}

TEST_F(VolumeFiles, OfADatasetAreItsFile) {
    const fs::path file = add("a.h5");
    EXPECT_THAT(volume_files(file.string() + ":/exchange/data"), ElementsAre(file));
}

TEST_F(VolumeFiles, AreThoseThatAreThere) {
    EXPECT_THAT(volume_files(folder / "none.tif"), IsEmpty());
    EXPECT_THAT(volume_files((folder / "*.tif").string()), IsEmpty());
    const fs::path header = add("a.mhd", meta("none.raw"));
    EXPECT_THAT(volume_files(header), ElementsAre(header));
    const fs::path damaged = add("b.mhd", "damaged");
    EXPECT_THAT(volume_files(damaged), ElementsAre(damaged));
}

TEST_F(VolumeFiles, EachVolumeOfAFolderIsFoundOnce) {
    add("a.tif");
    add("B.TIFF");
    add("c.mhd", meta("other.raw"));
    add("other.raw");
    add("d.vol");
    add("d.vol.info");
    add("e.raw");
    add("f.h5");
    add("slices/1.tif");
    add("no_slices/1.txt");
    add("notes.xml");
    add("notes.txt");
    add(".hidden.tif");
    EXPECT_THAT(found(), ElementsAre("B.TIFF", "a.tif", "c.mhd", "d.vol", "e.raw", "f.h5", "slices"));
    EXPECT_THAT([&] { find_volumes(folder / "a.tif"); }, ThrowsMessage<InvalidInput>(HasSubstr("a.tif")));
}

}  // namespace
}  // namespace tomodem
