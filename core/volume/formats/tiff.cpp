#include <tiffio.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/parallel.hpp"
#include "core/volume/reading/reading.hpp"
#include "core/volume/reading/tiff_file.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

/// Where one slice is: its file and the offset of its directory there.
struct Page {
    fs::path path;
    std::uint64_t directory = 0;
    std::string name;  // for messages
};

/// How the voxels of a slice are stored.
struct Layout {
    std::uint32_t width = 0, height = 0;
    int bits = 8;
    VoxelType type = VoxelType::uint8;
};

void check_magic(const fs::path& path) {
    const std::string found = first_bytes(path, 4);
    if (found.empty()) cannot_read(path, "the file is empty");
    if (!is_tiff(found))
        cannot_read(path, "it is not a TIFF; give a multipage TIFF or a folder of numbered TIFF slices");
}

std::optional<VoxelType> type_of(int format, int bits) {
    if (format == SAMPLEFORMAT_IEEEFP)
        return bits == 32   ? std::optional(VoxelType::float32)
               : bits == 64 ? std::optional(VoxelType::float64)
                            : std::nullopt;
    if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_INT && format != SAMPLEFORMAT_VOID) return {};
    const bool sign = format == SAMPLEFORMAT_INT;
    switch (bits) {
        case 1:
        case 2:
        case 4:
        case 8:
            return sign ? VoxelType::int8 : VoxelType::uint8;
        case 16:
            return sign ? VoxelType::int16 : VoxelType::uint16;
        case 32:
            return sign ? VoxelType::int32 : VoxelType::uint32;
        default:
            return {};
    }
}

/// @throws InvalidInput if the slice is stored in a way that no volume is
Layout read_layout(const TiffFile& tiff, const std::string& name) {
    Layout layout;
    layout.width = tiff.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
    layout.height = tiff.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
    layout.bits = tiff.tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
    const int format = tiff.tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    const int samples = tiff.tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
    const auto compression = tiff.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    if (samples != 1)
        cannot_read(tiff.path(),
                    fmt::format("{} has {} values a voxel (colours?); save it as grey or palette labels, one "
                                "value a voxel",
                                name, samples));
    constexpr std::uint32_t most = 1 << 20;
    if (layout.width == 0 || layout.height == 0 || layout.width > most || layout.height > most)
        cannot_read(tiff.path(), fmt::format("{} is {} x {} pixels by its header; the file is damaged", name,
                                             layout.width, layout.height));
    if (!TIFFIsCODECConfigured(compression))
        cannot_read(tiff.path(),
                    fmt::format("{} has compression {}, which libtiff cannot read here; save it with LZW or "
                                "Deflate",
                                name, compression));
    const auto type = type_of(format, layout.bits);
    if (!type)
        cannot_read(tiff.path(), fmt::format("{} has {}-bit values of TIFF sample format {}; 1 to 32-bit integers and "
                                             "32 or 64-bit floats are read",
                                             name, layout.bits, format));
    layout.type = *type;
    // Memory for a slab is asked for before anything is decoded. Nothing packs labels of any use a thousandfold.
    const double bytes = static_cast<double>(layout.width) * layout.height * layout.bits / 8;
    if (bytes > 1e8 && bytes > 1e3 * static_cast<double>(file_bytes(tiff.path())))
        cannot_read(tiff.path(), fmt::format("{} is {} x {} pixels by its header, too many for a file of {} bytes; the "
                                             "file is cut or damaged",
                                             name, layout.width, layout.height, file_bytes(tiff.path())));
    return layout;
}

/// Copies `count` values of a stored row from the `first` on; those of less than 8 bits are unpacked.
void copy_row(const std::uint8_t* row, const Layout& layout, std::int64_t first, std::int64_t count, std::byte* to) {
    if (layout.bits >= 8) {
        const auto size = static_cast<std::int64_t>(bytes_of(layout.type));
        std::memcpy(to, row + first * size, static_cast<std::size_t>(count * size));
        return;
    }
    const int per_byte = 8 / layout.bits, mask = (1 << layout.bits) - 1;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t at = first + i;
        int value = row[at / per_byte] >> (8 - layout.bits * static_cast<int>(at % per_byte + 1)) & mask;
        if (layout.type == VoxelType::int8 && value > mask / 2) value -= mask + 1;
        to[i] = static_cast<std::byte>(value);
    }
}

/// Decodes the window of the slice that `tiff` stands at.
void decode(const TiffFile& tiff, const Layout& layout, const Window& window, const std::string& name,
            std::byte* voxels) {
    TIFF* const handle = tiff.handle();
    const auto damaged = [&](std::uint32_t piece) {
        cannot_read(tiff.path(), fmt::format("{} is cut or damaged in piece {} ({}); copy or write it again", name,
                                             piece, tiff.error().empty() ? "too few bytes" : tiff.error()));
    };
    const bool tiled = TIFFIsTiled(handle);
    std::int64_t piece_width = layout.width, piece_height;
    if (tiled) {
        piece_width = tiff.tag<std::uint32_t>(TIFFTAG_TILEWIDTH, 0);
        piece_height = tiff.tag<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
    } else {
        piece_height = std::min(tiff.tag<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, layout.height), layout.height);
    }
    constexpr std::int64_t most = 1 << 21;  // pixels an edge, and a guard against sizes that only damage explains
    if (piece_width < 1 || piece_height < 1 || piece_width > most || piece_height > most ||
        piece_width * piece_height > std::int64_t{1} << 32)
        cannot_read(tiff.path(),
                    fmt::format("{} has strips or tiles of {} x {} pixels by its header; the file is damaged", name,
                                piece_width, piece_height));
    const std::int64_t row_bytes = (piece_width * layout.bits + 7) / 8;
    const auto voxel_bytes = static_cast<std::int64_t>(bytes_of(layout.type));
    const auto bytes = static_cast<double>(row_bytes) * static_cast<double>(piece_height);
    if (bytes > 1e8 && bytes > 1e3 * static_cast<double>(file_bytes(tiff.path()))) damaged(0);
    std::vector<std::uint8_t> buffer(row_bytes * piece_height);
    for (std::int64_t y0 = window.y - window.y % piece_height; y0 < window.y + window.height; y0 += piece_height)
        for (std::int64_t x0 = window.x - window.x % piece_width; x0 < window.x + window.width; x0 += piece_width) {
            const auto x = static_cast<std::uint32_t>(x0), y = static_cast<std::uint32_t>(y0);
            const std::uint32_t piece = tiled ? TIFFComputeTile(handle, x, y, 0, 0) : TIFFComputeStrip(handle, y, 0);
            const std::int64_t rows = std::min<std::int64_t>(piece_height, layout.height - y0);
            const std::int64_t expected = row_bytes * (tiled ? piece_height : rows);
            const tmsize_t got = tiled ? TIFFReadEncodedTile(handle, piece, buffer.data(), expected)
                                       : TIFFReadEncodedStrip(handle, piece, buffer.data(), expected);
            if (got < expected) damaged(piece);
            const std::int64_t x_from = std::max(x0, window.x);
            const std::int64_t x_to = std::min(x0 + piece_width, window.x + window.width);
            for (std::int64_t row = std::max(y0, window.y); row < std::min(y0 + rows, window.y + window.height); ++row)
                copy_row(buffer.data() + (row - y0) * row_bytes, layout, x_from - x0, x_to - x_from,
                         voxels + ((row - window.y) * window.width + (x_from - window.x)) * voxel_bytes);
        }
}

/// Open files of one thread: a multipage file is opened once.
class PageReader {
 public:
    const TiffFile& open(const Page& page) {
        if (!tiff_ || tiff_->path() != page.path) {
            if (page.directory == 0) check_magic(page.path);
            tiff_ = std::make_unique<TiffFile>(page.path, "r");
            if (!*tiff_)
                cannot_read(page.path,
                            fmt::format("the file is cut or damaged ({}); copy or write it again", tiff_->error()));
            if (page.directory == 0 && !TIFFLastDirectory(tiff_->handle()))
                cannot_read(page.path,
                            "this slice of a folder has several pages; give a multipage TIFF by its own name");
        }
        if (page.directory != 0 && TIFFCurrentDirOffset(tiff_->handle()) != page.directory &&
            !TIFFSetSubDirectory(tiff_->handle(), page.directory))
            cannot_read(page.path,
                        fmt::format("{} is damaged ({}); copy or write it again", page.name, tiff_->error()));
        return *tiff_;
    }

 private:
    std::unique_ptr<TiffFile> tiff_;
};

/// The value of "key=..." on a line of its own in what ImageJ writes as description.
std::optional<std::string> imagej_field(const std::string& description, const std::string& key) {
    const auto found = description.find("\n" + key + "=");
    if (found == std::string::npos) return {};
    const auto start = found + key.size() + 2;
    return trimmed(description.substr(start, description.find('\n', start) - start));
}

/// Voxel size and place, both with a unit, where the file says so [mm].
struct Scale {
    std::optional<Vec3> spacing, origin;
};

/// From the description: ours, or ImageJ's with a unit.
Scale read_scale(const TiffFile& tiff, const std::string& description) {
    if (description.starts_with("{\"spacing_mm\"")) {
        const auto said = nlohmann::json::parse(description, nullptr, false);
        const auto vector = [&](const char* key) -> std::optional<Vec3> {
            if (!said.is_object() || !said.contains(key) || !said[key].is_array() || said[key].size() != 3) return {};
            Vec3 values;
            for (int axis = 0; axis < 3; ++axis) {
                if (!said[key][axis].is_number()) return {};
                values[axis] = said[key][axis].get<double>();
            }
            return values;
        };
        const auto spacing = vector("spacing_mm");
        if (!spacing || !((spacing->array() > 0).all() && spacing->allFinite())) return {};
        return {spacing, vector("origin_mm")};
    }
    if (!description.starts_with("ImageJ=")) return {};
    const auto unit = length_unit(imagej_field(description, "unit").value_or(""));
    // The resolution tags count pixels per unit; without a unit they say nothing.
    const double x = tiff.tag<float>(TIFFTAG_XRESOLUTION, 0), y = tiff.tag<float>(TIFFTAG_YRESOLUTION, 0);
    if (!unit || !(x > 0) || !(y > 0)) return {};
    Vec3 spacing(*unit / x, *unit / y, *unit / x);
    if (const auto depth = imagej_field(description, "spacing"))
        spacing[2] = *unit * std::abs(number_in(tiff.path(), "ImageJ's spacing", *depth));
    if (!(spacing.array() > 0).all() || !spacing.allFinite()) return {};
    return {spacing, {}};
}

std::string description_of(const TiffFile& tiff) {
    const char* text = tiff.tag<const char*>(TIFFTAG_IMAGEDESCRIPTION, nullptr);
    return text ? text : "";
}

class TiffSource : public VolumeSource {
 public:
    TiffSource(std::vector<Page> pages, const std::string& name, VolumeHeader header)
        : pages_(std::move(pages)), name_(name), readers_(1) {
        header_ = std::move(header);
    }

    void use_threads(int threads) override { readers_.resize(static_cast<std::size_t>(threads)); }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const std::int64_t page_bytes =
            window.width * window.height * static_cast<std::int64_t>(bytes_of(header_.type));
        const auto threads = static_cast<std::int64_t>(readers_.size());
        std::vector<std::exception_ptr> errors(count);
        // A multipage file stays open on each thread, which takes every threads-th slice.
        parallel_for(threads, static_cast<int>(threads), [&](std::int64_t thread) {
            for (std::int64_t i = thread; i < count; i += threads) try {
                    read_page(pages_[k + i], window, readers_[thread], voxels + i * page_bytes);
                } catch (...) {
                    errors[i] = std::current_exception();
                    return;
                }
        });
        // The first bad slice is the one to name, whatever the number of threads.
        for (const auto& failure : errors)
            if (failure) std::rethrow_exception(failure);
    }

 private:
    void read_page(const Page& page, const Window& window, PageReader& reader, std::byte* voxels) const {
        const TiffFile& tiff = reader.open(page);
        const Layout layout = read_layout(tiff, page.name);
        if (static_cast<std::int32_t>(layout.width) != header_.size[0] ||
            static_cast<std::int32_t>(layout.height) != header_.size[1])
            cannot_read(name_, fmt::format("{} is {} x {} pixels but {} is {} x {}; all slices must have the same size",
                                           page.name, layout.width, layout.height, pages_[0].name, header_.size[0],
                                           header_.size[1]));
        if (layout.type != header_.type)
            cannot_read(name_, fmt::format("{} holds {} but {} holds {}; all slices must have the same type", page.name,
                                           name_of(layout.type), pages_[0].name, name_of(header_.type)));
        decode(tiff, layout, window, page.name, voxels);
    }

    std::vector<Page> pages_;
    std::string name_;
    std::vector<PageReader> readers_;
};

VolumeHeader header_of(const TiffFile& tiff, const Layout& layout, std::int64_t slices, const Scale& scale) {
    VolumeHeader header;
    header.spacing = scale.spacing;
    header.spacing_has_unit = scale.spacing.has_value();
    header.origin = scale.origin;
    header.format = TIFFIsBigTIFF(tiff.handle()) ? "BigTIFF" : "TIFF";
    header.type = layout.type;
    check_size(tiff.path(), {layout.width, layout.height, slices});
    header.size = {static_cast<std::int32_t>(layout.width), static_cast<std::int32_t>(layout.height),
                   static_cast<std::int32_t>(slices)};
    return header;
}

/// ImageJ writes large stacks as one page with the raw planes of all slices behind one another.
Source open_imagej_planes(const TiffFile& tiff, const Layout& layout, std::int64_t slices, const Scale& scale) {
    const auto compression = tiff.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    std::uint64_t* offsets = nullptr;
    if (compression != COMPRESSION_NONE || layout.bits < 8 || TIFFIsTiled(tiff.handle()) ||
        !TIFFGetField(tiff.handle(), TIFFTAG_STRIPOFFSETS, &offsets) || !offsets)
        cannot_read(tiff.path(), fmt::format("ImageJ says that it holds {} slices but it has one page, and that is no "
                                             "plane of raw voxels; save it as an image sequence",
                                             slices));
    VolumeHeader header = header_of(tiff, layout, slices, scale);
    header.format = "ImageJ stack";
    const std::int64_t bytes = slices * layout.width * layout.height * static_cast<std::int64_t>(bytes_of(layout.type));
    const auto offset = static_cast<std::int64_t>(offsets[0]);
    const auto directory = static_cast<std::int64_t>(TIFFCurrentDirOffset(tiff.handle()));
    const std::int64_t length = file_bytes(tiff.path());
    if (offset < 0 || length - offset < bytes || (directory > offset && directory < offset + bytes))
        cannot_read(tiff.path(),
                    fmt::format("ImageJ says that it holds {} slices but there is one page, and no room for "
                                "their {} bytes behind it; it is cut, or save it as an image sequence",
                                slices, bytes));
    RawVoxels where{{tiff.path()}, offset, bool(TIFFIsBigEndian(tiff.handle())), false};
    where.may_be_longer = true;
    return open_raw(std::move(header), where);
}

/// A multipage TIFF, or an ImageJ stack of one page and raw planes behind it.
Source open_tiff(const fs::path& path, const std::string&) {
    check_magic(path);
    const TiffFile tiff(path, "rm");
    if (!tiff) cannot_read(path, fmt::format("the file is cut or damaged ({}); copy or write it again", tiff.error()));
    const std::string description = description_of(tiff);
    const Layout layout = read_layout(tiff, "slice 0");

    std::int64_t said = 0;
    if (description.starts_with("ImageJ=")) {
        if (const auto images = imagej_field(description, "images"))
            said = whole_number_in(path, "ImageJ's number of images", *images);
        for (const char* kind : {"channels", "frames"})
            if (const auto several = imagej_field(description, kind); several && *several != "1")
                cannot_read(path, fmt::format("it is an ImageJ hyperstack of {} {}; save one of them by itself",
                                              *several, kind));
    }
    const Scale scale = read_scale(tiff, description);
    if (said > 1 && TIFFLastDirectory(tiff.handle())) return open_imagej_planes(tiff, layout, said, scale);

    // Pages that are previews or masks of others are left out.
    std::vector<Page> pages;
    for (int number = 0;; ++number) {
        const auto kind = tiff.tag<std::uint32_t>(TIFFTAG_SUBFILETYPE, 0);
        if (!(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)))
            pages.push_back({path, TIFFCurrentDirOffset(tiff.handle()), fmt::format("slice {}", pages.size())});
        if (TIFFLastDirectory(tiff.handle())) break;
        if (!TIFFReadDirectory(tiff.handle()))
            cannot_read(path, fmt::format("the file is cut or damaged after slice {} ({}); copy or write it again",
                                          number, tiff.error()));
    }
    if (pages.empty()) cannot_read(path, "it has no full-size page");
    if (said > 0 && said != static_cast<std::int64_t>(pages.size()))
        cannot_read(path,
                    fmt::format("ImageJ says that it holds {} slices but it has {} pages; it is cut, or save it as "
                                "an image sequence",
                                said, pages.size()));
    PageReader reader;
    const TiffFile& first = reader.open(pages[0]);
    VolumeHeader header =
        header_of(first, read_layout(first, pages[0].name), static_cast<std::int64_t>(pages.size()), scale);
    return std::make_unique<TiffSource>(std::move(pages), path.string(), std::move(header));
}

Source open_tiff_slices(const std::vector<fs::path>& slices, const std::string& series) {
    std::vector<Page> pages;
    for (const auto& slice : slices) pages.push_back({slice, 0, "slice '" + slice.filename().string() + "'"});
    PageReader reader;
    const TiffFile& first = reader.open(pages[0]);
    VolumeHeader header = header_of(first, read_layout(first, pages[0].name), static_cast<std::int64_t>(pages.size()),
                                    read_scale(first, description_of(first)));
    header.format = "folder of TIFF slices";
    return std::make_unique<TiffSource>(std::move(pages), series, std::move(header));
}

const RegisteredFormat tiff_format{{
    .name = "TIFF",
    .extensions = {".tif", ".tiff"},
    .sniff = [](const std::string& start, const fs::path&) { return is_tiff(start); },
    .open = open_tiff,
    .open_slices = open_tiff_slices,
}};

}  // namespace
}  // namespace tomodem::formats
