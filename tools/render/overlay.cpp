#include "tools/render/overlay.hpp"

#include <fmt/format.h>
#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace tomodem::render {
namespace {

constexpr Rgb ink{40, 44, 52};

std::array<double, 3> unit_rgb(const Rgb& colour) {
    return {colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0};
}

/// Flat drawing in pixels of the final picture, (0, 0) at the lower left.
class Overlay {
 public:
    Overlay(vtkRenderer* renderer, int scale) : renderer_(renderer), scale_(scale) {}

    using Polygon = std::vector<Eigen::Vector2d>;

    void polygon(const Polygon& corners, const Rgb& colour) { polygons({corners}, colour); }

    void polygons(const std::vector<Polygon>& all, const Rgb& colour) {
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> cells;
        for (const Polygon& corners : all) {
            cells->InsertNextCell(static_cast<vtkIdType>(corners.size()));
            for (const auto& corner : corners)
                cells->InsertCellPoint(points->InsertNextPoint(corner.x() * scale_, corner.y() * scale_, 0));
        }
        vtkNew<vtkPolyData> data;
        data->SetPoints(points);
        data->SetPolys(cells);
        vtkNew<vtkPolyDataMapper2D> mapper;
        mapper->SetInputData(data);
        vtkNew<vtkActor2D> actor;
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(unit_rgb(colour).data());
        renderer_->AddViewProp(actor);
    }

    void rectangle(double x, double y, double width, double height, const Rgb& colour) {
        polygon({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, colour);
    }

    void disc(double x, double y, double radius, const Rgb& colour) {
        std::vector<Eigen::Vector2d> corners;
        for (int k = 0; k < 48; ++k)
            corners.emplace_back(x + radius * std::cos(k * M_PI / 24), y + radius * std::sin(k * M_PI / 24));
        polygon(corners, colour);
    }

    struct Line {
        Eigen::Vector2d from, to;
    };

    /// Those too short to have a direction are left out. @param size  1: as the axes
    void arrows(const std::vector<Line>& lines, double size, const Rgb& colour) {
        std::vector<Polygon> all;
        for (const auto& [from, to] : lines) {
            const double length = (to - from).norm();
            if (length < 4 * size) continue;
            const Eigen::Vector2d along = (to - from) / length, across = size * Eigen::Vector2d(-along.y(), along.x());
            const Eigen::Vector2d neck = to - std::min(9.0 * size, 0.5 * length) * along;
            all.push_back({from - 1.25 * across, neck - 1.25 * across, neck + 1.25 * across, from + 1.25 * across});
            all.push_back({neck - 4.5 * across, to, neck + 4.5 * across});
        }
        polygons(all, colour);
    }

    enum class Align { left, centre, right };
    void text(double x, double y, double size, const std::string& words, Align align, const Rgb& colour = ink) {
        vtkNew<vtkTextActor> actor;
        actor->SetInput(words.c_str());
        vtkTextProperty* style = actor->GetTextProperty();
        style->SetFontFamilyToArial();
        style->SetFontSize(static_cast<int>(size * scale_));
        style->SetColor(unit_rgb(colour).data());
        style->SetVerticalJustificationToCentered();
        if (align == Align::centre) style->SetJustificationToCentered();
        if (align == Align::right) style->SetJustificationToRight();
        actor->SetDisplayPosition(static_cast<int>(x * scale_), static_cast<int>(y * scale_));
        renderer_->AddViewProp(actor);
    }

 private:
    vtkRenderer* renderer_;
    int scale_;  ///< pixels of the window in one of the picture
};

/// 1, 2 or 5 times a power of ten, at most `limit`.
double round_length(double limit) {
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    for (const double digit : {5.0, 2.0})
        if (digit * power <= limit) return digit * power;
    return power;
}

std::string length_text(double mm) {
    if (mm >= 999.5) return fmt::format("{:g} m", mm / 1000);
    if (mm >= 0.9995) return fmt::format("{:g} mm", mm);
    if (mm >= 0.9995e-3) return fmt::format("{:g} µm", mm * 1e3);
    return fmt::format("{:g} nm", mm * 1e6);
}

/// The number at a tick of the colour bar: 0 instead of a rounding error.
std::string tick_text(double value, double low, double high) {
    const double span = std::max(std::abs(low), std::abs(high));
    const std::string text = fmt::format("{:.3g}", std::abs(value) < 1e-9 * span ? 0.0 : value);
    return text.starts_with('-') ? "−" + text.substr(1) : text;
}

/// At the upper right, as wide as a third of the picture.
void colour_bar(const ColourBar& bar, const Picture& picture, double unit, Overlay& overlay) {
    const double width = 0.3 * picture.width, height = 14 * unit, text_size = 19 * unit;
    const double left = picture.width - 46 * unit - width, bottom = picture.height - 48 * unit;
    constexpr int steps = 128;
    for (int k = 0; k < steps; ++k)
        overlay.rectangle(left + width * k / steps, bottom, width / steps + 0.5, height,
                          colour_at(bar.map, (k + 0.5) / steps));
    // A pointed end: there are values beyond it.
    if (bar.lower_values)
        overlay.polygon({{left, bottom}, {left, bottom + height}, {left - 0.9 * height, bottom + height / 2}},
                        colour_at(bar.map, 0));
    if (bar.higher_values)
        overlay.polygon({{left + width, bottom},
                         {left + width + 0.9 * height, bottom + height / 2},
                         {left + width, bottom + height}},
                        colour_at(bar.map, 1));
    overlay.text(left + width / 2, bottom + height + 16 * unit, text_size, bar.title, Overlay::Align::centre);
    for (const double place : {0.0, 0.5, 1.0}) {
        const double x = left + place * width;
        overlay.rectangle(x - unit, bottom - 5 * unit, 2 * unit, 5 * unit, ink);
        overlay.text(x, bottom - 18 * unit, text_size,
                     tick_text(bar.low + place * (bar.high - bar.low), bar.low, bar.high), Overlay::Align::centre);
    }
}

}  // namespace

void add_overlay(const Picture& picture, const Projection& projection, int scale, vtkRenderer* renderer) {
    Overlay overlay(renderer, scale);
    // Letters of a thirty-ninth of the picture's width: readable where two pictures stand side by side on a page.
    const double unit = 1.45 * std::min(picture.width / 1200.0, picture.height / 900.0);
    const double margin = 20 * unit, text_size = 21 * unit;

    double x = margin, top = picture.height - margin - 8 * unit;
    for (const auto& entry : picture.legend) {
        const double width = 27 * unit + 0.52 * text_size * static_cast<double>(entry.text.size());
        if (x > margin && x + width > picture.width - margin) {
            x = margin;
            top -= 30 * unit;
        }
        overlay.disc(x + 9 * unit, top, 9 * unit, entry.colour);
        overlay.text(x + 27 * unit, top, text_size, entry.text, Overlay::Align::left);
        x += width + 30 * unit;
    }
    if (!picture.caption.empty())
        overlay.text(margin, top - (picture.legend.empty() ? 0 : 30 * unit), text_size, picture.caption,
                     Overlay::Align::left);

    if (picture.bar) colour_bar(*picture.bar, picture, unit, overlay);

    std::vector<Overlay::Line> arrows;
    for (const Arrow& arrow : picture.arrows)
        arrows.push_back({projection.pixel(arrow.from), projection.pixel(arrow.to)});
    overlay.arrows(arrows, 0.55 * unit, ink);

    const double bar = round_length(0.22 * picture.width * projection.mm_per_pixel);
    const double bar_pixels = bar / projection.mm_per_pixel;
    overlay.rectangle(margin, margin, bar_pixels, 6 * unit, ink);
    overlay.text(margin + bar_pixels / 2, margin + 24 * unit, text_size, length_text(bar), Overlay::Align::centre);

    if (picture.arrow_key > 0) {
        const double key = picture.arrow_key / projection.mm_per_pixel, left = margin + bar_pixels + 60 * unit;
        overlay.arrows({{{left, margin + 3 * unit}, {left + key, margin + 3 * unit}}}, 0.8 * unit, ink);
        overlay.text(left, margin + 24 * unit, text_size, picture.arrow_key_text, Overlay::Align::left);
    }

    const Eigen::Vector2d origin{picture.width - 80 * unit, 58 * unit};
    const std::array<Rgb, 3> axis_colours{Rgb{176, 58, 46}, Rgb{30, 132, 73}, Rgb{36, 89, 168}};
    const std::array<const char*, 3> axis_names{"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 direction = Vec3::Unit(axis);
        const Eigen::Vector2d seen{direction.dot(projection.right), direction.dot(projection.up)};
        overlay.arrows({{origin, origin + 46 * unit * seen}}, unit, axis_colours[axis]);
        if (seen.norm() > 0.2) {
            const Eigen::Vector2d name = origin + (46 + 12 / seen.norm()) * unit * seen;
            overlay.text(name.x(), name.y(), 18 * unit, axis_names[axis], Overlay::Align::centre, axis_colours[axis]);
        }
    }
}

}  // namespace tomodem::render
