#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/volume/reading/tiff_file.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {

namespace fs = std::filesystem;

void write_label_volume(const LabelVolume& volume, const fs::path& path, Reporter& reporter) {
    const VoxelIndex size = volume.size();
    const auto labels = volume.histogram();
    const std::int32_t low = labels.begin()->first, high = labels.rbegin()->first;
    const int bits = low >= 0 && high < 256 ? 8 : low >= 0 && high < 65536 ? 16 : 32;
    const double bytes = double(size[0]) * size[1] * size[2] * bits / 8;
    const Vec3 spacing = volume.spacing(), origin = volume.origin();
    const std::string description = fmt::format("{{\"spacing_mm\": [{}, {}, {}], \"origin_mm\": [{}, {}, {}]}}",
                                                spacing[0], spacing[1], spacing[2], origin[0], origin[1], origin[2]);

    OutputFile output(path);
    const auto check = [&](bool good, const formats::TiffFile& tiff) {
        if (!good)
            throw InvalidInput(fmt::format("cannot write volume '{}': {}", path.string(),
                                           tiff.error().empty() ? "is the disk full?" : tiff.error()));
    };
    {
        formats::TiffFile tiff(output.path(), bytes > 3e9 ? "w8" : "w");
        check(bool(tiff), tiff);
        TIFF* const handle = tiff.handle();
        std::vector<std::int32_t> voxels;
        std::vector<std::uint8_t> row(std::size_t(size[0]) * bits / 8);
        const auto rows_per_strip = static_cast<std::uint32_t>(
            std::clamp<std::int64_t>((1 << 18) / static_cast<std::int64_t>(row.size()), 1, size[1]));
        const auto progress = reporter.progress("writing", size[2]);
        for (std::int32_t k = 0; k < size[2]; ++k) {
            const std::int32_t in_slab = k % LabelVolume::slab;
            if (in_slab == 0) volume.slices(k, std::min(LabelVolume::slab, size[2] - k), voxels);
            TIFFSetField(handle, TIFFTAG_IMAGEWIDTH, size[0]);
            TIFFSetField(handle, TIFFTAG_IMAGELENGTH, size[1]);
            TIFFSetField(handle, TIFFTAG_BITSPERSAMPLE, bits);
            TIFFSetField(handle, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(handle, TIFFTAG_SAMPLEFORMAT, low < 0 ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT);
            TIFFSetField(handle, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(handle, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
            TIFFSetField(handle, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
            TIFFSetField(handle, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
            TIFFSetField(handle, TIFFTAG_ROWSPERSTRIP, rows_per_strip);
            TIFFSetField(handle, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
            TIFFSetField(handle, TIFFTAG_XRESOLUTION, 10 / spacing[0]);
            TIFFSetField(handle, TIFFTAG_YRESOLUTION, 10 / spacing[1]);
            if (k == 0) TIFFSetField(handle, TIFFTAG_IMAGEDESCRIPTION, description.c_str());
            const std::int32_t* values = voxels.data() + std::int64_t{in_slab} * size[0] * size[1];
            for (std::int32_t y = 0; y < size[1]; ++y, values += size[0]) {
                if (bits == 8)
                    std::copy(values, values + size[0], row.begin());
                else if (bits == 16)
                    std::copy(values, values + size[0], reinterpret_cast<std::uint16_t*>(row.data()));
                else
                    std::memcpy(row.data(), values, row.size());
                check(TIFFWriteScanline(handle, row.data(), y, 0) == 1, tiff);
            }
            check(TIFFWriteDirectory(handle) == 1, tiff);
            progress->update(k + 1);
        }
        // libtiff reports a failure while closing through the handler only.
        tiff.close();
        check(tiff.error().empty(), tiff);
    }
    output.commit();
}

}  // namespace tomodem
