#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/volume/grey_volume.hpp"
#include "core/volume/reading/tiff_file.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {

namespace fs = std::filesystem;

namespace {

/// What the pages of a TIFF have in common.
struct Pages {
    VoxelIndex size;
    Vec3 spacing, origin;
    int bits;
    std::uint16_t sample_format;
};

/// @param write_row  stores row y of slice k, called with rising k and y
void write_pages(const fs::path& path, const Pages& pages, Reporter& reporter,
                 const std::function<void(std::int32_t k, std::int32_t y, std::uint8_t* row)>& write_row) {
    const auto& [size, spacing, origin, bits, sample_format] = pages;
    const double bytes = double(size[0]) * size[1] * size[2] * bits / 8;
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
        std::vector<std::uint8_t> row(std::size_t(size[0]) * bits / 8);
        const auto rows_per_strip = static_cast<std::uint32_t>(
            std::clamp<std::int64_t>((1 << 18) / static_cast<std::int64_t>(row.size()), 1, size[1]));
        const auto progress = reporter.progress("writing", size[2]);
        for (std::int32_t k = 0; k < size[2]; ++k) {
            TIFFSetField(handle, TIFFTAG_IMAGEWIDTH, size[0]);
            TIFFSetField(handle, TIFFTAG_IMAGELENGTH, size[1]);
            TIFFSetField(handle, TIFFTAG_BITSPERSAMPLE, bits);
            TIFFSetField(handle, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(handle, TIFFTAG_SAMPLEFORMAT, sample_format);
            TIFFSetField(handle, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(handle, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
            TIFFSetField(handle, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
            TIFFSetField(handle, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
            TIFFSetField(handle, TIFFTAG_ROWSPERSTRIP, rows_per_strip);
            TIFFSetField(handle, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
            TIFFSetField(handle, TIFFTAG_XRESOLUTION, 10 / spacing[0]);
            TIFFSetField(handle, TIFFTAG_YRESOLUTION, 10 / spacing[1]);
            if (k == 0) TIFFSetField(handle, TIFFTAG_IMAGEDESCRIPTION, description.c_str());
            for (std::int32_t y = 0; y < size[1]; ++y) {
                write_row(k, y, row.data());
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

}  // namespace

void write_label_volume(const LabelVolume& volume, const fs::path& path, Reporter& reporter) {
    const VoxelIndex size = volume.size();
    const auto labels = volume.histogram();
    const std::int32_t low = labels.begin()->first, high = labels.rbegin()->first;
    const int bits = low >= 0 && high < 256 ? 8 : low >= 0 && high < 65536 ? 16 : 32;
    const Pages pages{size, volume.spacing(), volume.origin(), bits,
                      static_cast<std::uint16_t>(low < 0 ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT)};
    std::vector<std::int32_t> voxels;
    write_pages(path, pages, reporter, [&](std::int32_t k, std::int32_t y, std::uint8_t* row) {
        const std::int32_t in_slab = k % LabelVolume::slab;
        if (in_slab == 0 && y == 0) volume.slices(k, std::min(LabelVolume::slab, size[2] - k), voxels);
        const std::int32_t* const values = voxels.data() + (std::int64_t{in_slab} * size[1] + y) * size[0];
        if (bits == 8)
            std::copy(values, values + size[0], row);
        else if (bits == 16)
            std::copy(values, values + size[0], reinterpret_cast<std::uint16_t*>(row));
        else
            std::memcpy(row, values, std::size_t(size[0]) * sizeof(std::int32_t));
    });
}

void write_grey_volume(const GreyVolume& volume, const fs::path& path, Reporter& reporter) {
    const VoxelType type = volume.stored_type();
    const Pages pages{
        volume.size, volume.spacing, volume.origin, static_cast<int>(8 * bytes_of(type)),
        static_cast<std::uint16_t>(type == VoxelType::float32                            ? SAMPLEFORMAT_IEEEFP
                                   : type == VoxelType::int8 || type == VoxelType::int16 ? SAMPLEFORMAT_INT
                                                                                         : SAMPLEFORMAT_UINT)};
    const std::int64_t width = volume.size[0];
    write_pages(path, pages, reporter, [&](std::int32_t k, std::int32_t y, std::uint8_t* row) {
        const float* const values = volume.values.data() + (std::int64_t{k} * volume.size[1] + y) * width;
        with_type(type, [&](auto value) {
            using Value = decltype(value);
            auto* const to = reinterpret_cast<Value*>(row);
            for (std::int64_t x = 0; x < width; ++x) {
                if constexpr (std::is_floating_point_v<Value>)
                    to[x] = values[x];
                else
                    to[x] = static_cast<Value>(std::clamp(std::round(static_cast<double>(values[x])),
                                                          static_cast<double>(std::numeric_limits<Value>::min()),
                                                          static_cast<double>(std::numeric_limits<Value>::max())));
            }
        });
    });
}

}  // namespace tomodem
