#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/volume/grey_histogram.hpp"
#include "core/volume/grey_volume.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {
namespace {

/// Labels from stored values.
class Labeller {
 public:
    Labeller(std::string name, VoxelType type, std::vector<double> thresholds,
             const std::map<std::int32_t, std::int32_t>& relabel)
        : name_(std::move(name)), type_(type), thresholds_(std::move(thresholds)), relabel_(relabel) {
        with_type(type_, [&](auto value) {
            using Value = decltype(value);
            if constexpr (sizeof(Value) <= 2) {
                table_.resize(std::size_t{1} << 8 * sizeof(Value));
                for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = label(static_cast<Value>(i));
            }
        });
    }

    void operator()(const std::byte* voxels, std::int64_t count, std::int32_t* labels) {
        with_type(type_, [&](auto value) {
            using Value = decltype(value);
            const auto* values = reinterpret_cast<const Value*>(voxels);
            if constexpr (sizeof(Value) <= 2) {
                for (std::int64_t i = 0; i < count; ++i)
                    labels[i] = table_[static_cast<std::make_unsigned_t<Value>>(values[i])];
            } else {
                if constexpr (std::is_floating_point_v<Value>)
                    not_a_number_ += std::count_if(values, values + count, [](Value v) { return std::isnan(v); });
                // Neighbours mostly have one value.
                for (std::int64_t i = 0; i < count; ++i)
                    labels[i] = i > 0 && values[i] == values[i - 1] ? labels[i - 1] : label(values[i]);
            }
        });
    }

    std::int64_t not_a_number() const { return not_a_number_; }

 private:
    template <class Value>
    std::int32_t label(Value value) const {
        std::int32_t found = 0;
        if (!thresholds_.empty()) {
            for (const double threshold : thresholds_) found += static_cast<double>(value) > threshold;
        } else {
            if (!std::in_range<std::int32_t>(whole(value)))
                throw InvalidInput(
                    fmt::format("cannot read volume '{}': it has the label {}, above 2147483647; renumber "
                                "the labels, or give a threshold",
                                name_, value));
            found = static_cast<std::int32_t>(value);
        }
        const auto renamed = relabel_.find(found);
        return renamed == relabel_.end() ? found : renamed->second;
    }
    /// Floats come here with thresholds only.
    template <class Value>
    static auto whole(Value value) {
        if constexpr (std::is_floating_point_v<Value>)
            return std::int64_t{0};
        else
            return value;
    }

    std::string name_;
    VoxelType type_;
    std::vector<double> thresholds_;
    std::map<std::int32_t, std::int32_t> relabel_;
    std::vector<std::int32_t> table_;  // of types of one or two bytes, by their bits
    std::atomic<std::int64_t> not_a_number_{0};
};

std::array<VoxelIndex, 2> region_of(const std::string& spec, const VoxelIndex& size, const VolumeOptions& options) {
    const auto region = options.region.value_or(std::array<VoxelIndex, 2>{VoxelIndex{0, 0, 0}, size});
    for (int axis = 0; axis < 3; ++axis) {
        const auto [first, count] = std::pair(region[0][axis], region[1][axis]);
        if (first < 0 || count < 1 || count > size[axis] - first)
            throw InvalidInput(
                fmt::format("the region {}:{} along {} does not fit into volume '{}', which has {} voxels there", first,
                            std::int64_t{first} + count, "xyz"[axis], spec, size[axis]));
        if (options.bin[axis] < 1 || options.bin[axis] > count)
            throw InvalidInput(fmt::format("volume '{}' has {} voxels along {} to be binned by {}", spec, count,
                                           "xyz"[axis], options.bin[axis]));
    }
    return region;
}

std::string edges_text(const Vec3& spacing) {
    return fmt::format("{:g} x {:g} x {:g} um", 1e3 * spacing[0], 1e3 * spacing[1], 1e3 * spacing[2]);
}

/// A whole number of pixels per inch that programs write where nobody told them the size: what it is, or nothing.
std::string default_of_a_writer(double edge) {
    constexpr double inch = 25.4, rounding = 5e-4;
    for (const int pixels : {1, 72, 96, 100, 150, 300, 600})
        if (std::abs(edge * pixels / inch - 1) < rounding)
            return fmt::format("{:.4g} um is {} pixel{} per inch, which programs write where nobody gave them a size",
                               1e3 * edge, pixels, pixels == 1 ? "" : "s");
    return {};
}

/// Edges of a stored voxel, from the file and the options.
Vec3 spacing_of(const std::string& spec, const VolumeHeader& header, const VolumeOptions& options, Reporter& reporter) {
    const Vec3& given = options.voxel_size;
    for (int axis = 0; axis < 3; ++axis)
        if (!(given[axis] >= 0) || !std::isfinite(given[axis]))
            throw InvalidInput(
                fmt::format("voxel size {:g} mm of volume '{}': it must be more than 0", given[axis], spec));
    if (!header.spacing && !(given[0] > 0))
        throw InvalidInput(
            fmt::format("volume '{}' ({}) does not say the size of its voxels; give it with --voxel-size and its unit",
                        spec, header.format));
    if (header.spacing && !header.spacing_has_unit && !(given[0] > 0))
        throw InvalidInput(fmt::format(
            "volume '{}' ({}) does not say the size of its voxels with a unit; give it with --voxel-size and its unit",
            spec, header.format));
    const Vec3 as_given(given[0], given[1] > 0 ? given[1] : given[0], given[2] > 0 ? given[2] : given[0]);
    if (!header.spacing) return as_given;
    const Vec3 stored =
        header.spacing_has_unit ? *header.spacing : Vec3(*header.spacing * (given[0] / (*header.spacing)[0]));
    const char* const how = header.spacing_has_unit ? "" : " at the given size in x";
    const std::string writer = header.spacing_has_unit ? default_of_a_writer(stored[0]) : "";

    constexpr double rounding = 1e-3;  // files keep a few digits
    const auto differs = [&](const Vec3& edges, int axis) {
        return edges[axis] > 0 && std::abs(stored[axis] / edges[axis] - 1) > rounding;
    };
    if (options.override_voxel_size) {
        if (differs(as_given, 0) || differs(as_given, 1) || differs(as_given, 2))
            reporter.warn(fmt::format("volume '{}' says that its voxels are {}{}{}; they are taken as {}, as given",
                                      spec, edges_text(stored), how, writer.empty() ? "" : " (" + writer + ")",
                                      edges_text(as_given)));
        return as_given;
    }
    for (int axis = 0; axis < 3; ++axis)
        if (differs(given, axis))
            throw InvalidInput(
                fmt::format("volume '{}' says that its voxels are {}{}, but {:g} um are given for {}{}; add "
                            "--override-voxel-size if the file is wrong, or correct {}",
                            spec, edges_text(stored), how, 1e3 * given[axis], "xyz"[axis],
                            writer.empty() ? "" : " (" + writer + ")", axis == 2 ? "--slice-spacing" : "--voxel-size"));
    if (!(given[0] > 0) && !writer.empty())
        reporter.warn(
            fmt::format("volume '{}': its voxel size comes from the file, and {}; a scanner's voxel is rarely that: if "
                        "it is wrong, give --voxel-size with --override-voxel-size",
                        spec, writer));
    return stored;
}

/// The label that most voxels of each block have.
void vote(const std::vector<std::int32_t>& stored, std::int64_t width, std::int32_t slices, const VoxelIndex& bin,
          const VoxelIndex& size, int threads, std::int32_t* labels) {
    const std::int64_t page = width * size[1] * bin[1];
    parallel_for(size[1], threads, [&](std::int64_t row) {
        std::vector<std::pair<std::int32_t, int>> votes;
        for (std::int32_t column = 0; column < size[0]; ++column) {
            votes.clear();
            for (std::int32_t z = 0; z < slices; ++z)
                for (std::int32_t y = 0; y < bin[1]; ++y) {
                    const std::int32_t* line = stored.data() + z * page + (row * bin[1] + y) * width;
                    for (std::int32_t x = column * bin[0]; x < (column + 1) * bin[0]; ++x) {
                        const auto known = std::find_if(votes.begin(), votes.end(),
                                                        [&](const auto& entry) { return entry.first == line[x]; });
                        known == votes.end() ? void(votes.emplace_back(line[x], 1)) : void(++known->second);
                    }
                }
            labels[row * size[0] + column] =
                std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                    return a.second < b.second || (a.second == b.second && a.first > b.first);
                })->first;
        }
    });
}

/// @param spacing  of the stored voxels, or nullptr
/// @param given    whatever the file says
std::string description_of(const VolumeHeader& header, const Vec3* spacing, bool given = false) {
    std::string text = fmt::format("{} slices of {} x {} voxels, {}, {}", header.size[2], header.size[0],
                                   header.size[1], name_of(header.type), header.format);
    if (spacing)
        text += fmt::format("; voxels of {}, {}", edges_text(*spacing),
                            !header.spacing || given  ? "as given"
                            : header.spacing_has_unit ? "from the file"
                                                      : "in the file's proportions");
    return text;
}

/// Where the voxels are that the options keep.
struct Placement {
    Vec3 spacing, origin;
    std::string description;
};

Placement placement_of(const std::string& spec, const VolumeHeader& header, const std::array<VoxelIndex, 2>& region,
                       const VolumeOptions& options, Reporter& reporter) {
    const Vec3 stored = spacing_of(spec, header, options, reporter);
    const Vec3 bin(options.bin[0], options.bin[1], options.bin[2]);
    const Vec3 first_voxel(region[0][0], region[0][1], region[0][2]);
    return {stored.cwiseProduct(bin),
            options.origin.value_or(header.origin.value_or(Vec3::Zero())) + first_voxel.cwiseProduct(stored),
            description_of(header, &stored, options.override_voxel_size)};
}

}  // namespace

GreyImage read_grey_histogram(const std::string& spec, const VolumeOptions& options, int threads, Reporter& reporter) {
    const auto source = open_volume(spec, options.raw);
    source->use_threads(threads);
    GreySlabs slabs(*source, region_of(spec, source->header().size, options), options.bin, threads);
    return {count_grey_values(slabs, threads, reporter), description_of(source->header(), nullptr)};
}

GreyVolume read_grey_volume(const std::string& spec, const VolumeOptions& options, int threads, Reporter& reporter) {
    const auto source = open_volume(spec, options.raw);
    source->use_threads(threads);
    const VolumeHeader& header = source->header();
    const auto region = region_of(spec, header.size, options);
    const Placement place = placement_of(spec, header, region, options, reporter);
    GreySlabs slabs(*source, region, options.bin, threads);
    const VoxelIndex size = slabs.size();
    GreyVolume grey{size, place.spacing, place.origin, slabs.type(), {}, place.description};
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    grey.values.resize(static_cast<std::size_t>(page) * size[2]);
    std::vector<std::byte> voxels;
    const auto progress = reporter.progress("reading", size[2]);
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        slabs.read(k, count, voxels);
        with_type(slabs.type(), [&](auto value) {
            using Value = decltype(value);
            const auto* values = reinterpret_cast<const Value*>(voxels.data());
            parallel_for(count, threads, [&](std::int64_t i) {
                float* const to = grey.values.data() + (k + i) * page;
                for (std::int64_t at = 0; at < page; ++at) {
                    const Value stored = values[i * page + at];
                    to[at] = static_cast<float>(stored);
                    if (!std::isfinite(to[at]))
                        throw InvalidInput(fmt::format(
                            "cannot read volume '{}': slice {} has a value that is not a finite number; replace it",
                            spec, k + i));
                    if (std::is_integral_v<Value> && static_cast<double>(to[at]) != static_cast<double>(stored))
                        throw InvalidInput(
                            fmt::format("cannot read volume '{}': slice {} has the value {}, and values "
                                        "above 16777216 are not kept exactly; write it with 16 bits",
                                        spec, k + i, stored));
                }
            });
        });
        progress->update(k + count);
    }
    return grey;
}

LabelVolume read_label_volume(const std::string& spec, const VolumeOptions& options) {
    return read_image(spec, options, 1, silent_reporter()).volume;
}

LabelledImage read_image(const std::string& spec, const VolumeOptions& options, int threads, Reporter& reporter) {
    const auto source = open_volume(spec, options.raw);
    source->use_threads(threads);
    const VolumeHeader& header = source->header();
    const auto region = region_of(spec, header.size, options);
    const Placement place = placement_of(spec, header, region, options, reporter);
    const bool grey = !options.thresholds.empty() || options.otsu_levels > 0;
    if (is_float(header.type) && !grey)
        throw InvalidInput(
            fmt::format("cannot read volume '{}': it holds floating-point grey values; give --threshold or "
                        "--otsu (grey_histogram shows where it cuts)",
                        spec));

    GreySlabs slabs(*source, region, options.bin, threads);
    const VoxelIndex size = slabs.size();
    std::vector<double> thresholds = options.thresholds, otsu;
    if (options.otsu_levels > 0) {
        otsu = otsu_thresholds(count_grey_values(slabs, threads, reporter), options.otsu_levels);
        thresholds = otsu;
    }

    LabelVolume volume(size, place.spacing, place.origin);
    volume.use_threads(threads);
    const bool votes = !grey && options.bin != VoxelIndex{1, 1, 1};
    Labeller labeller(spec, votes ? header.type : slabs.type(), thresholds, options.relabel);
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::byte> voxels;
    std::vector<std::int32_t> labels, stored;
    const auto label_rows = [&](std::int64_t row, std::int64_t rows, std::int32_t* to) {
        const auto bytes = static_cast<std::int64_t>(bytes_of(votes ? header.type : slabs.type()));
        parallel_for(rows, threads,
                     [&](std::int64_t y) { labeller(voxels.data() + y * row * bytes, row, to + y * row); });
    };
    const auto progress = reporter.progress("reading", size[2]);
    for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
        labels.resize(page * count);
        if (votes) {
            const Window window{region[0][0], region[0][1], std::int64_t{size[0]} * options.bin[0],
                                std::int64_t{size[1]} * options.bin[1]};
            const std::int64_t stored_page = window.width * window.height;
            stored.resize(stored_page * options.bin[2]);
            voxels.resize(stored.size() * bytes_of(header.type));
            for (std::int32_t i = 0; i < count; ++i) {
                source->read(region[0][2] + (k + i) * options.bin[2], options.bin[2], window, voxels.data());
                label_rows(window.width, window.height * options.bin[2], stored.data());
                vote(stored, window.width, options.bin[2], options.bin, size, threads, labels.data() + i * page);
            }
        } else {
            slabs.read(k, count, voxels);
            label_rows(size[0], std::int64_t{size[1]} * count, labels.data());
        }
        volume.set_slices(k, count, labels);
        progress->update(k + count);
    }
    if (labeller.not_a_number() > 0)
        reporter.warn(fmt::format("{} voxels of '{}' are not a number; they count as below the threshold",
                                  labeller.not_a_number(), spec));
    return {std::move(volume), place.description, otsu};
}

std::vector<double> read_values_at(const std::string& spec, const std::string& image, const VolumeOptions& options,
                                   std::span<const Vec3> points, int threads, Reporter& reporter) {
    const auto source = open_volume(spec);
    source->use_threads(threads);
    const auto model = open_volume(image, options.raw);
    const VolumeHeader &header = source->header(), &image_header = model->header();
    if (header.size != image_header.size)
        throw InvalidInput(
            fmt::format("volume '{}' has {} x {} x {} voxels, but the image '{}' has {} x {} x {}; they must "
                        "be of one grid",
                        spec, header.size[0], header.size[1], header.size[2], image, image_header.size[0],
                        image_header.size[1], image_header.size[2]));
    const Vec3 spacing = spacing_of(image, image_header, options, silent_reporter());  // said before
    const Vec3 origin = options.origin.value_or(image_header.origin.value_or(Vec3::Zero()));
    std::vector<VoxelIndex> voxel_of(points.size());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const double at = std::floor((points[i][axis] - origin[axis]) / spacing[axis]);
            if (!(at >= 0 && at < header.size[axis]))
                throw InvalidInput(fmt::format("volume '{}' does not reach the point {:g}, {:g}, {:g} mm", spec,
                                               points[i][0], points[i][1], points[i][2]));
            voxel_of[i][axis] = static_cast<std::int32_t>(at);
        }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return voxel_of[a][2] < voxel_of[b][2]; });

    const Window window{0, 0, header.size[0], header.size[1]};
    const std::int64_t page = window.width * window.height;
    std::vector<std::byte> voxels(static_cast<std::size_t>(page) * LabelVolume::slab * bytes_of(header.type));
    std::vector<double> values(points.size());
    const auto progress = reporter.progress("reading", header.size[2]);
    for (std::size_t next = 0; next < order.size();) {
        const std::int32_t k = voxel_of[order[next]][2] / LabelVolume::slab * LabelVolume::slab;
        const std::int32_t count = std::min(LabelVolume::slab, header.size[2] - k);
        source->read(k, count, window, voxels.data());
        with_type(header.type, [&](auto value) {
            const auto* slab = reinterpret_cast<const decltype(value)*>(voxels.data());
            for (; next < order.size() && voxel_of[order[next]][2] < k + count; ++next) {
                const VoxelIndex& voxel = voxel_of[order[next]];
                values[order[next]] = static_cast<double>(
                    slab[(voxel[2] - k) * page + std::int64_t{voxel[1]} * header.size[0] + voxel[0]]);
            }
        });
        progress->update(k + count);
    }
    return values;
}

}  // namespace tomodem
