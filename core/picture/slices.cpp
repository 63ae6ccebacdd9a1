#include "core/picture/slices.hpp"

#include <fmt/format.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"

namespace tomodem {
namespace {

/// A slice across `axis`, coloured by colour(x, y, z).
template <class ColourOf>
Panel middle_slice(const VoxelIndex& size, const Vec3& spacing, int axis, const std::string& caption,
                   const ColourOf& colour) {
    const int across = axis == 0 ? 1 : 0, down = axis == 2 ? 1 : 2;
    Panel panel{caption, size[across], size[down], spacing[down] / spacing[across], {}};
    panel.colours.reserve(static_cast<std::size_t>(panel.width) * panel.height);
    VoxelIndex voxel{};
    voxel[axis] = size[axis] / 2;
    for (voxel[down] = 0; voxel[down] < size[down]; ++voxel[down])
        for (voxel[across] = 0; voxel[across] < size[across]; ++voxel[across]) panel.colours.push_back(colour(voxel));
    return panel;
}

/// Hue from 0 to 1, saturation and value.
Colour hsv(double hue, double saturation, double value) {
    const auto channel = [&](double shift) {
        const double k = std::fmod(shift + 6 * hue, 6.0);
        return static_cast<std::uint8_t>(
            std::lround(255 * value * (1 - saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0))));
    };
    return {channel(5), channel(3), channel(1)};
}

/// The pixels of a page.
class Page {
 public:
    Page(int width, int height) : width_(width), height_(height) {
        image_->SetDimensions(width, height, 1);
        image_->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
        auto* const pixels = static_cast<std::uint8_t*>(image_->GetScalarPointer());
        std::fill(pixels, pixels + std::size_t{3} * width * height, std::uint8_t{255});
    }
    /// Row 0 is the top one.
    void set(int x, int y, const Colour& colour) {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
        auto* const pixel = static_cast<std::uint8_t*>(image_->GetScalarPointer(x, height_ - 1 - y, 0));
        std::copy(colour.begin(), colour.end(), pixel);
    }
    void draw(const Panel& panel, int x, int y, int width, int height) {
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column)
                set(x + column, y + row,
                    panel.colours[static_cast<std::size_t>(std::int64_t{row} * panel.height / height) * panel.width +
                                  static_cast<std::size_t>(std::int64_t{column} * panel.width / width)]);
    }
    void write_text(const std::string& text, int x, int y) {
        vtkNew<vtkTextProperty> style;
        style->SetFontSize(15);
        style->SetColor(0, 0, 0);
        vtkNew<vtkImageData> drawn;
        int size[2] = {0, 0};
        constexpr int dots_per_inch = 72;
        if (!vtkTextRenderer::GetInstance()->RenderString(style, text, drawn, size, dots_per_inch)) return;
        for (int row = 0; row < size[1]; ++row)
            for (int column = 0; column < size[0]; ++column) {
                const auto* const pixel =
                    static_cast<const std::uint8_t*>(drawn->GetScalarPointer(column, size[1] - 1 - row, 0));
                const auto ink = static_cast<std::uint8_t>(255 - pixel[3]);
                set(x + column, y + row, {ink, ink, ink});
            }
    }
    void save(const std::filesystem::path& picture) const {
        OutputFile output(picture);
        vtkNew<vtkPNGWriter> writer;
        writer->SetInputData(image_);
        writer->SetFileName(output.path().c_str());
        writer->Write();
        if (writer->GetErrorCode() != 0)
            throw InvalidInput(fmt::format("cannot write picture '{}': is the disk full?", picture.string()));
        output.commit();
    }

 private:
    vtkNew<vtkImageData> image_;
    int width_, height_;
};

}  // namespace

Panel slice_panel(const LabelVolume& volume, int axis, const std::string& caption,
                  const std::function<Colour(std::int32_t)>& colour) {
    const LabelVolume::Sampler sampler(volume);
    return middle_slice(volume.size(), volume.spacing(), axis, caption,
                        [&](const VoxelIndex& voxel) { return colour(sampler.at(voxel)); });
}

Panel slice_panel(const GreyVolume& volume, int axis, const std::string& caption, const std::array<double, 2>& window) {
    return middle_slice(volume.size, volume.spacing, axis, caption, [&](const VoxelIndex& voxel) {
        const double value = volume.values[volume.at(voxel[0], voxel[1], voxel[2])];
        const double share = std::clamp((value - window[0]) / (window[1] - window[0]), 0.0, 1.0);
        const auto level = static_cast<std::uint8_t>(std::lround(255 * share));
        return Colour{level, level, level};
    });
}

std::array<double, 2> grey_window(const GreyVolume& volume) {
    constexpr std::size_t enough = 1'000'000;
    const std::size_t step = std::max<std::size_t>(1, volume.values.size() / enough);
    std::vector<float> some;
    for (std::size_t i = 0; i < volume.values.size(); i += step) some.push_back(volume.values[i]);
    std::sort(some.begin(), some.end());
    const double low = some[some.size() / 200], high = some[some.size() - 1 - some.size() / 200];
    return {low, high > low ? high : low + 1};
}

Panel histogram_panel(const GreyVolume& volume, const std::string& caption, const std::array<double, 2>& window) {
    constexpr int max_columns = 256, rows = 100;
    // Of whole numbers a column holds the same number of values as its neighbours.
    const bool whole = volume.stored_type() != VoxelType::float32;
    const double range = window[1] - window[0] + (whole ? 1 : 0);
    const double of_a_column = whole ? std::ceil(range / max_columns) : range / max_columns;
    const int columns = static_cast<int>(std::ceil(range / of_a_column));
    std::vector<std::int64_t> counts(columns);
    for (const float value : volume.values) {
        const double place = ((whole ? std::round(double{value}) : double{value}) - window[0]) / of_a_column;
        if (place >= 0 && place <= columns)
            ++counts[static_cast<std::size_t>(std::min(columns - 1.0, std::floor(place)))];
    }
    const double highest =
        std::sqrt(static_cast<double>(std::max<std::int64_t>(1, *std::max_element(counts.begin(), counts.end()))));
    Panel panel{caption, columns, rows, columns / (2.5 * rows),
                std::vector<Colour>(static_cast<std::size_t>(columns) * rows, Colour{235, 235, 235})};
    for (int column = 0; column < columns; ++column) {
        const int height =
            static_cast<int>(std::lround(rows * std::sqrt(static_cast<double>(counts[column])) / highest));
        for (int row = rows - height; row < rows; ++row)
            panel.colours[static_cast<std::size_t>(row) * columns + column] = {40, 90, 160};
    }
    return panel;
}

Colour colour_of_object(std::int32_t number) {
    constexpr double golden = 0.6180339887498949;
    const double turns = golden * number;
    const double values[] = {1.0, 0.75, 0.9};
    return hsv(turns - std::floor(turns), number % 2 == 0 ? 0.55 : 0.85, values[number % 3]);
}

void write_panels(const std::vector<std::vector<Panel>>& rows, const std::filesystem::path& picture) {
    constexpr int gap = 12, line = 22, panel_width = 480, max_height = 720;
    /// Pixels of the panels of one row, which have one scale.
    struct Row {
        std::vector<std::array<int, 2>> sizes;
        int height = 0;
    };
    std::vector<Row> drawn;
    std::size_t columns = 0;
    int height = gap;
    for (const auto& panels : rows) {
        double scale = std::numeric_limits<double>::infinity();
        for (const Panel& panel : panels)
            scale = std::min({scale, double{panel_width} / panel.width, max_height / (panel.height * panel.stretch)});
        const auto pixels = [&](double points) { return std::max(1, static_cast<int>(std::lround(points * scale))); };
        Row row;
        for (const Panel& panel : panels) {
            row.sizes.push_back({pixels(panel.width), pixels(panel.height * panel.stretch)});
            row.height = std::max(row.height, row.sizes.back()[1]);
        }
        columns = std::max(columns, panels.size());
        height += row.height + line + gap;
        drawn.push_back(std::move(row));
    }
    Page page(gap + static_cast<int>(columns) * (panel_width + gap), height);
    int y = gap;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        int x = gap;
        for (std::size_t i = 0; i < rows[r].size(); ++i) {
            page.write_text(rows[r][i].caption, x, y);
            page.draw(rows[r][i], x, y + line, drawn[r].sizes[i][0], drawn[r].sizes[i][1]);
            x += panel_width + gap;
        }
        y += drawn[r].height + line + gap;
    }
    page.save(picture);
}

}  // namespace tomodem
