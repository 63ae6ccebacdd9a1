#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/cli.hpp"
#include "core/error.hpp"
#include "core/output_file.hpp"
#include "core/volume.hpp"
#include "core/volume_parallel.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;

/// An open TIFF. What libtiff has to say is kept for our own message instead of being printed.
class Tiff {
 public:
    Tiff(const fs::path& path, const char* mode) : path_(path) {
        TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
        TIFFOpenOptionsSetErrorHandlerExtR(options, keep_first_error, this);
        TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_warning, this);
        handle_ = TIFFOpenExt(path.c_str(), mode, options);
        TIFFOpenOptionsFree(options);
    }
    ~Tiff() { close(); }
    Tiff(const Tiff&) = delete;
    Tiff& operator=(const Tiff&) = delete;

    explicit operator bool() const { return handle_ != nullptr; }
    TIFF* handle() const { return handle_; }
    const fs::path& path() const { return path_; }
    const std::string& error() const { return error_; }
    void close() {
        if (handle_) TIFFClose(handle_);
        handle_ = nullptr;
    }

    template <class T>
    T tag(std::uint32_t name, T otherwise) const {
        T value{};
        return TIFFGetFieldDefaulted(handle_, name, &value) ? value : otherwise;
    }

 private:
    static int keep_first_error(TIFF*, void* self, const char*, const char* format, va_list arguments) {
        auto& error = static_cast<Tiff*>(self)->error_;
        char text[500];
        std::vsnprintf(text, sizeof text, format, arguments);
        if (error.empty()) error = text;
        while (!error.empty() && (error.back() == '.' || error.back() == '\n')) error.pop_back();
        std::replace(error.begin(), error.end(), '\n', ' ');
        return 1;
    }
    static int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

    fs::path path_;
    TIFF* handle_ = nullptr;
    std::string error_;
};

[[noreturn]] void cannot_read(const fs::path& path, const std::string& why) {
    throw InvalidInput(fmt::format("cannot read volume '{}': {}", path.string(), why));
}

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
    int format = SAMPLEFORMAT_UINT;

    bool is_float() const { return format == SAMPLEFORMAT_IEEEFP; }
};

void check_magic(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) cannot_read(path, "it cannot be opened; check its permissions");
    char magic[4] = {};
    file.read(magic, 4);
    if (file.gcount() == 0) cannot_read(path, "the file is empty");
    const std::string_view found(magic, 4);
    using namespace std::string_view_literals;
    for (const auto& known : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
        if (found == known) return;
    cannot_read(path, "it is not a TIFF; give a multipage TIFF or a folder of numbered TIFF slices");
}

/// @throws InvalidInput if the slice is stored in a way that no label image is
Layout read_layout(const Tiff& tiff, const std::string& name) {
    Layout layout;
    layout.width = tiff.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
    layout.height = tiff.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
    layout.bits = tiff.tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
    layout.format = tiff.tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
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
    if (layout.format == SAMPLEFORMAT_VOID) layout.format = SAMPLEFORMAT_UINT;
    const bool known = layout.format == SAMPLEFORMAT_IEEEFP
                           ? layout.bits == 32 || layout.bits == 64
                           : (layout.format == SAMPLEFORMAT_UINT || layout.format == SAMPLEFORMAT_INT) &&
                                 layout.bits <= 32 && std::has_single_bit(static_cast<unsigned>(layout.bits));
    if (!known)
        cannot_read(tiff.path(), fmt::format("{} has {}-bit values of TIFF sample format {}; 1 to 32-bit integers and "
                                             "32 or 64-bit floats are read",
                                             name, layout.bits, layout.format));
    return layout;
}

/// Labels from the stored values of one row.
class Labeller {
 public:
    explicit Labeller(const VolumeOptions& options) : options_(options) {
        for (const auto& [from, to] : options.relabel)
            if (from >= 0 && from < 256) {
                if (table_.empty())
                    for (int i = 0; i < 256; ++i) table_.push_back(i);
                table_[from] = to;
            }
    }

    void row(const std::uint8_t* bytes, const Layout& layout, std::int64_t first, std::int64_t count,
             std::int32_t* labels, const Tiff& tiff, const std::string& name) const {
        if (layout.bits < 8) {
            const int per_byte = 8 / layout.bits, mask = (1 << layout.bits) - 1;
            for (std::int64_t i = 0; i < count; ++i) {
                const std::int64_t at = first + i;
                const int shift = 8 - layout.bits * static_cast<int>(at % per_byte + 1);
                labels[i] = bytes[at / per_byte] >> shift & mask;
                if (layout.format == SAMPLEFORMAT_INT && labels[i] > mask / 2) labels[i] -= mask + 1;
            }
            finish(labels, count);
            return;
        }
        const bool sign = layout.format == SAMPLEFORMAT_INT;
        if (layout.is_float())
            layout.bits == 32 ? above<float>(bytes, first, count, labels) : above<double>(bytes, first, count, labels);
        else if (layout.bits == 8)
            sign ? whole<std::int8_t>(bytes, first, count, labels) : whole<std::uint8_t>(bytes, first, count, labels);
        else if (layout.bits == 16)
            sign ? whole<std::int16_t>(bytes, first, count, labels) : whole<std::uint16_t>(bytes, first, count, labels);
        else if (sign)
            whole<std::int32_t>(bytes, first, count, labels);
        else if (options_.threshold)
            above<std::uint32_t>(bytes, first, count, labels);
        else {
            whole<std::uint32_t>(bytes, first, count, labels);
            if (*std::min_element(labels, labels + count) < 0)
                cannot_read(tiff.path(),
                            fmt::format("{} has labels above 2147483647; renumber them, or give a threshold", name));
        }
    }

 private:
    template <class T>
    void whole(const std::uint8_t* bytes, std::int64_t first, std::int64_t count, std::int32_t* labels) const {
        const T* values = reinterpret_cast<const T*>(bytes) + first;
        for (std::int64_t i = 0; i < count; ++i) labels[i] = static_cast<std::int32_t>(values[i]);
        finish(labels, count);
    }
    template <class T>
    void above(const std::uint8_t* bytes, std::int64_t first, std::int64_t count, std::int32_t* labels) const {
        const T* values = reinterpret_cast<const T*>(bytes) + first;
        const double threshold = options_.threshold.value();
        for (std::int64_t i = 0; i < count; ++i) labels[i] = values[i] > threshold;
        relabel(labels, count);
    }
    void finish(std::int32_t* labels, std::int64_t count) const {
        if (options_.threshold) {
            const double threshold = *options_.threshold;
            for (std::int64_t i = 0; i < count; ++i) labels[i] = labels[i] > threshold;
        }
        relabel(labels, count);
    }
    void relabel(std::int32_t* labels, std::int64_t count) const {
        if (options_.relabel.empty()) return;
        for (std::int64_t i = 0; i < count; ++i) {
            const std::int32_t label = labels[i];
            if (label >= 0 && label < 256 && !table_.empty()) {
                labels[i] = table_[label];
            } else if (const auto found = options_.relabel.find(label); found != options_.relabel.end()) {
                labels[i] = found->second;
            }
        }
    }

    const VolumeOptions& options_;
    std::vector<std::int32_t> table_;  // of the labels 0 to 255, where one of them is renamed
};

/// First voxel and number of voxels to keep of a slice.
struct Window {
    std::int64_t x, y, width, height;
};

/// Decodes the window of the slice that `tiff` stands at.
void decode(const Tiff& tiff, const Layout& layout, const Window& window, const Labeller& labeller,
            const std::string& name, std::int32_t* labels) {
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
                labeller.row(buffer.data() + (row - y0) * row_bytes, layout, x_from - x0, x_to - x_from,
                             labels + (row - window.y) * window.width + (x_from - window.x), tiff, name);
        }
}

/// The slices of a multipage TIFF; pages that are previews or masks of others are left out.
std::vector<Page> pages_of_file(const fs::path& path) {
    check_magic(path);
    const Tiff tiff(path, "rm");
    if (!tiff) cannot_read(path, fmt::format("the file is cut or damaged ({}); copy or write it again", tiff.error()));
    std::vector<Page> pages;
    std::size_t said = 0;
    for (int number = 0;; ++number) {
        if (number == 0) {
            // ImageJ writes large stacks as one page with the voxels of the others behind it.
            const char* text = tiff.tag<const char*>(TIFFTAG_IMAGEDESCRIPTION, nullptr);
            if (text && std::string_view(text).starts_with("ImageJ="))
                if (const char* images = std::strstr(text, "\nimages=")) said = std::strtoull(images + 8, nullptr, 10);
        }
        const auto kind = tiff.tag<std::uint32_t>(TIFFTAG_SUBFILETYPE, 0);
        if (!(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)))
            pages.push_back({path, TIFFCurrentDirOffset(tiff.handle()), fmt::format("slice {}", pages.size())});
        if (TIFFLastDirectory(tiff.handle())) break;
        if (!TIFFReadDirectory(tiff.handle()))
            cannot_read(path, fmt::format("the file is cut or damaged after slice {} ({}); copy or write it again",
                                          number, tiff.error()));
    }
    if (pages.empty()) cannot_read(path, "it has no full-size page");
    if (said > pages.size())
        cannot_read(path, fmt::format("ImageJ says that it holds {} slices but it has {} pages; save it as an image "
                                      "sequence, or as BigTIFF",
                                      said, pages.size()));
    return pages;
}

/// A file name cut into text and numbers: "img_007.tif" -> {"img_", 7, ".tif"}.
struct NumberedName {
    fs::path path;
    std::vector<std::string> texts;
    std::vector<std::uint64_t> numbers;
};

NumberedName cut_name(const fs::path& path) {
    NumberedName name{path, {""}, {}};
    const std::string stem = path.stem().string();
    for (std::size_t i = 0; i < stem.size();) {
        if (!std::isdigit(static_cast<unsigned char>(stem[i]))) {
            name.texts.back() += stem[i++];
            continue;
        }
        std::uint64_t number = 0;
        for (; i < stem.size() && std::isdigit(static_cast<unsigned char>(stem[i])); ++i)
            number = number > 99'999'999'999'999'999 ? number : number * 10 + (stem[i] - '0');
        name.numbers.push_back(number);
        name.texts.emplace_back();
    }
    return name;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// The slices of a folder in the order of their numbers.
std::vector<Page> pages_of_folder(const fs::path& folder) {
    std::vector<NumberedName> names;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const std::string extension = lower(it->path().extension().string());
        if ((extension == ".tif" || extension == ".tiff") && it->is_regular_file() &&
            !it->path().filename().string().starts_with('.'))
            names.push_back(cut_name(it->path()));
    }
    if (error) cannot_read(folder, error.message());
    if (names.empty()) cannot_read(folder, "the folder has no slice (no file ending in .tif or .tiff)");
    std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) { return a.path < b.path; });

    const NumberedName& model = names.front();
    std::size_t slice_number = model.numbers.empty() ? 0 : model.numbers.size() - 1;
    bool found = false;
    for (const auto& name : names) {
        if (name.texts != model.texts)
            cannot_read(folder,
                        fmt::format("'{}' and '{}' are not slices of one series; put each series into a folder of "
                                    "its own",
                                    model.path.filename().string(), name.path.filename().string()));
        for (std::size_t i = 0; i < name.numbers.size(); ++i) {
            if (name.numbers[i] == model.numbers[i]) continue;
            if (found && i != slice_number)
                cannot_read(folder,
                            fmt::format("the names of the slices differ in more than one number ('{}' and '{}'); "
                                        "put each series into a folder of its own",
                                        model.path.filename().string(), name.path.filename().string()));
            found = true;
            slice_number = i;
        }
    }
    if (names.size() > 1 && model.numbers.empty())
        cannot_read(folder, "the names of the slices have no number; number them from 0");
    const auto number = [slice_number](const NumberedName& name) { return name.numbers[slice_number]; };
    if (names.size() > 1) {
        std::sort(names.begin(), names.end(), [&](const auto& a, const auto& b) { return number(a) < number(b); });
        for (std::size_t i = 1; i < names.size(); ++i) {
            const std::uint64_t before = number(names[i - 1]), now = number(names[i]);
            if (now == before)
                cannot_read(folder,
                            fmt::format("'{}' and '{}' have the same number", names[i - 1].path.filename().string(),
                                        names[i].path.filename().string()));
            if (now == before + 2)
                cannot_read(folder,
                            fmt::format("slice number {} is missing (between '{}' and '{}')", before + 1,
                                        names[i - 1].path.filename().string(), names[i].path.filename().string()));
            if (now > before + 2)
                cannot_read(folder, fmt::format("slice numbers {} to {} are missing (between '{}' and '{}')",
                                                before + 1, now - 1, names[i - 1].path.filename().string(),
                                                names[i].path.filename().string()));
        }
    }
    std::vector<Page> pages;
    for (const auto& name : names) pages.push_back({name.path, 0, "slice '" + name.path.filename().string() + "'"});
    return pages;
}

/// Open files of one thread: a multipage file is opened once.
class PageReader {
 public:
    const Tiff& open(const Page& page) {
        if (!tiff_ || tiff_->path() != page.path) {
            if (page.directory == 0) check_magic(page.path);
            tiff_ = std::make_unique<Tiff>(page.path, "r");
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
    std::unique_ptr<Tiff> tiff_;
};

Window window_of(const fs::path& path, const Layout& layout, std::size_t slices, const VolumeOptions& options,
                 std::array<VoxelIndex, 2>& region) {
    const VoxelIndex size{static_cast<std::int32_t>(layout.width), static_cast<std::int32_t>(layout.height),
                          static_cast<std::int32_t>(slices)};
    region = options.region.value_or(std::array<VoxelIndex, 2>{VoxelIndex{0, 0, 0}, size});
    for (int axis = 0; axis < 3; ++axis) {
        const auto [first, count] = std::pair(region[0][axis], region[1][axis]);
        if (first < 0 || count < 1 || count > size[axis] - first)
            throw InvalidInput(
                fmt::format("the region {}:{} along {} does not fit into volume '{}', which has {} voxels "
                            "there",
                            first, std::int64_t{first} + count, "xyz"[axis], path.string(), size[axis]));
    }
    return {region[0][0], region[0][1], region[1][0], region[1][1]};
}

}  // namespace

LabelVolume read_label_volume(const fs::path& path, const VolumeOptions& options) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(options.voxel_size[axis] > 0))
            throw InvalidInput(fmt::format("voxel size {:g} mm of volume '{}': it must be more than 0",
                                           options.voxel_size[axis], path.string()));
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) cannot_read(path, "it does not exist");
    const bool folder = fs::is_directory(status);
    const std::vector<Page> pages = folder ? pages_of_folder(path) : pages_of_file(path);

    // The first slice that is kept fixes the size; each other slice is compared with it.
    PageReader first_reader;
    const Layout model = read_layout(first_reader.open(pages[0]), pages[0].name);
    std::array<VoxelIndex, 2> region;
    const Window window = window_of(path, model, pages.size(), options, region);
    const VoxelIndex size = region[1];
    const Vec3 first_voxel(region[0][0], region[0][1], region[0][2]);
    LabelVolume volume(size, options.voxel_size, options.origin + first_voxel.cwiseProduct(options.voxel_size));

    const Labeller labeller(options);
    const std::int64_t page_voxels = window.width * window.height;
    const int threads = cli::threads();
    // A multipage file stays open on each thread, which takes every threads-th slice of the slab.
    std::vector<PageReader> readers(threads);
    std::vector<std::int32_t> labels;
    cli::Progress progress("reading", size[2]);
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        labels.resize(page_voxels * count);
        std::vector<std::exception_ptr> errors(count);
        parallel_for(threads, threads, [&](std::int64_t thread) {
            for (std::int32_t i = static_cast<std::int32_t>(thread); i < count; i += threads) try {
                    const Page& page = pages[region[0][2] + k + i];
                    const Tiff& tiff = readers[thread].open(page);
                    const Layout layout = read_layout(tiff, page.name);
                    if (layout.width != model.width || layout.height != model.height)
                        cannot_read(path,
                                    fmt::format("{} is {} x {} pixels but {} is {} x {}; all slices must have the "
                                                "same size",
                                                page.name, layout.width, layout.height, pages[0].name, model.width,
                                                model.height));
                    if (layout.is_float() && !options.threshold)
                        cannot_read(path,
                                    fmt::format("{} holds floating-point grey values; give a threshold, voxels above "
                                                "it become label 1",
                                                page.name));
                    decode(tiff, layout, window, labeller, page.name, labels.data() + i * page_voxels);
                } catch (...) {
                    errors[i] = std::current_exception();
                    return;
                }
        });
        // The first bad slice is the one to name, whatever the number of threads.
        for (const auto& failure : errors)
            if (failure) std::rethrow_exception(failure);
        volume.set_slices(k, count, labels);
        progress.update(k + count);
    }
    return volume;
}

void write_label_volume(const LabelVolume& volume, const fs::path& path) {
    const VoxelIndex size = volume.size();
    const auto labels = volume.histogram();
    const std::int32_t low = labels.begin()->first, high = labels.rbegin()->first;
    const int bits = low >= 0 && high < 256 ? 8 : low >= 0 && high < 65536 ? 16 : 32;
    const double bytes = double(size[0]) * size[1] * size[2] * bits / 8;
    const Vec3 spacing = volume.spacing(), origin = volume.origin();
    const std::string description = fmt::format("{{\"spacing_mm\": [{}, {}, {}], \"origin_mm\": [{}, {}, {}]}}",
                                                spacing[0], spacing[1], spacing[2], origin[0], origin[1], origin[2]);

    OutputFile output(path);
    const auto check = [&](bool good, const Tiff& tiff) {
        if (!good)
            throw InvalidInput(fmt::format("cannot write volume '{}': {}", path.string(),
                                           tiff.error().empty() ? "is the disk full?" : tiff.error()));
    };
    {
        Tiff tiff(output.path(), bytes > 3e9 ? "w8" : "w");
        check(bool(tiff), tiff);
        TIFF* const handle = tiff.handle();
        std::vector<std::int32_t> voxels;
        std::vector<std::uint8_t> row(std::size_t(size[0]) * bits / 8);
        const auto rows_per_strip = static_cast<std::uint32_t>(
            std::clamp<std::int64_t>((1 << 18) / static_cast<std::int64_t>(row.size()), 1, size[1]));
        cli::Progress progress("writing", size[2]);
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
            progress.update(k + 1);
        }
        // libtiff reports a failure while closing through the handler only.
        tiff.close();
        check(tiff.error().empty(), tiff);
    }
    output.commit();
}

}  // namespace tomodem
