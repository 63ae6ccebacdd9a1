#include "tools/render/picture.hpp"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkOutputWindow.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/output_file.hpp"
#include "tools/render/offscreen_window.hpp"

namespace tomodem {
namespace {

constexpr int oversampling = 2;
constexpr Rgb ink{40, 44, 52};

/// Keeps VTK's complaints off the user's screen, and the first of them for our own error line.
class Complaints : public vtkOutputWindow {
 public:
    static Complaints* New();
    vtkTypeMacro(Complaints, vtkOutputWindow);
    void DisplayText(const char*) override {}
    void DisplayErrorText(const char* text) override {
        if (first_.empty()) first_ = text;
    }
    const std::string& first() const { return first_; }

 protected:
    Complaints() = default;

 private:
    std::string first_;
};
vtkStandardNewMacro(Complaints);

std::array<double, 3> unit_rgb(const Rgb& colour) {
    return {colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0};
}

/// Flat drawing in pixels of the final picture, (0, 0) at the lower left.
class Overlay {
 public:
    explicit Overlay(vtkRenderer* renderer) : renderer_(renderer) {}

    void polygon(const std::vector<Eigen::Vector2d>& corners, const Rgb& colour) {
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> cells;
        cells->InsertNextCell(static_cast<vtkIdType>(corners.size()));
        for (const auto& corner : corners)
            cells->InsertCellPoint(points->InsertNextPoint(corner.x() * oversampling, corner.y() * oversampling, 0));
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

    void arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Rgb& colour) {
        const double length = (to - from).norm();
        if (length < 4) return;
        const Eigen::Vector2d along = (to - from) / length, across{-along.y(), along.x()};
        const double head = std::min(9.0, 0.5 * length);
        const Eigen::Vector2d neck = to - head * along;
        polygon({from - 1.25 * across, neck - 1.25 * across, neck + 1.25 * across, from + 1.25 * across}, colour);
        polygon({neck - 4.5 * across, to, neck + 4.5 * across}, colour);
    }

    enum class Align { left, centre };
    void text(double x, double y, double size, const std::string& words, Align align, const Rgb& colour = ink) {
        vtkNew<vtkTextActor> actor;
        actor->SetInput(words.c_str());
        vtkTextProperty* style = actor->GetTextProperty();
        style->SetFontFamilyToArial();
        style->SetFontSize(static_cast<int>(size * oversampling));
        style->SetColor(unit_rgb(colour).data());
        style->SetVerticalJustificationToCentered();
        if (align == Align::centre) style->SetJustificationToCentered();
        actor->SetDisplayPosition(static_cast<int>(x * oversampling), static_cast<int>(y * oversampling));
        renderer_->AddViewProp(actor);
    }

 private:
    vtkRenderer* renderer_;
};

/// Axes of the picture plane, and the scale at which the view's region fits between the margins.
struct Projection {
    Vec3 towards_camera, right, up;
    Vec3 focal_point;           ///< centre of the picture
    double mm_per_pixel = 1.0;  ///< of the final picture
    double depth = 1.0;         ///< from the focal point to the farthest corner [mm]
};

Projection projection(const Picture& picture) {
    Projection result;
    result.towards_camera = picture.view.towards_camera.normalized();
    const Vec3 upwards = std::abs(result.towards_camera.z()) > 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
    result.right = upwards.cross(result.towards_camera).normalized();
    result.up = result.towards_camera.cross(result.right);

    const Vec3 centre = (picture.view.low + picture.view.high) / 2;
    const Vec3 half = (picture.view.high - picture.view.low) / 2;
    const double half_width = result.right.cwiseAbs().dot(half), half_height = result.up.cwiseAbs().dot(half);
    const double side = 0.03 * picture.width, top = 0.09 * picture.height, bottom = 0.11 * picture.height;
    result.mm_per_pixel =
        std::max(2 * half_width / (picture.width - 2 * side), 2 * half_height / (picture.height - top - bottom));
    result.focal_point = centre + result.up * (top - bottom) / 2 * result.mm_per_pixel;
    result.depth = half.norm() + std::abs(top - bottom) * result.mm_per_pixel;
    return result;
}

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

void add_spheres(const Picture& picture, vtkRenderer* renderer) {
    const auto count = static_cast<vtkIdType>(picture.centres.size());
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(count);
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    colours->SetNumberOfTuples(count);
    vtkNew<vtkCellArray> cells;
    for (vtkIdType k = 0; k < count; ++k) {
        points->SetPoint(k, picture.centres[k].data());
        const Rgb& colour = picture.colours[k];
        colours->SetTypedComponent(k, 0, colour.red);
        colours->SetTypedComponent(k, 1, colour.green);
        colours->SetTypedComponent(k, 2, colour.blue);
        cells->InsertNextCell(1, &k);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetVerts(cells);
    data->GetPointData()->SetScalars(colours);
    vtkNew<vtkOpenGLSphereMapper> mapper;  // two triangles a sphere, the rest is ray casting in the shader
    mapper->SetInputData(data);
    mapper->SetRadius(static_cast<float>(picture.radius));
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(0.3);
    actor->GetProperty()->SetDiffuse(0.75);
    renderer->AddActor(actor);
}

void add_mesh(const TriangleMesh& mesh, const Rgb& colour, vtkRenderer* renderer) {
    std::vector<Vec3> normal(mesh.vertices.size(), Vec3::Zero());
    vtkNew<vtkCellArray> cells;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 doubled_area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        for (const auto corner : {a, b, c}) normal[corner] += doubled_area;
        cells->InsertNextCell({a, b, c});
    }
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> normals;
    normals->SetNumberOfComponents(3);
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
        points->InsertNextPoint(mesh.vertices[k].data());
        normals->InsertNextTuple(normal[k].normalized().eval().data());
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetPointData()->SetNormals(normals);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(unit_rgb(colour).data());
    actor->GetProperty()->SetAmbient(0.2);
    actor->GetProperty()->SetDiffuse(0.85);
    renderer->AddActor(actor);
}

vtkSmartPointer<vtkActor> box_actor(const Box& box, bool faces) {
    vtkNew<vtkPoints> points;
    for (int k = 0; k < 8; ++k)
        points->InsertNextPoint((box.origin + box.edges.cwiseProduct(Vec3(k & 1, (k >> 1) & 1, k >> 2))).eval().data());
    vtkNew<vtkCellArray> cells;
    if (faces)
        for (const auto& face : std::array<std::array<vtkIdType, 4>, 6>{
                 {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}})
            cells->InsertNextCell(4, face.data());
    else
        for (vtkIdType from = 0; from < 8; ++from)
            for (const vtkIdType step : {1, 2, 4})
                if (!(from & step)) cells->InsertNextCell({from, from + step});
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    if (faces)
        data->SetPolys(cells);
    else
        data->SetLines(cells);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    const auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    return actor;
}

void add_overlay(const Picture& picture, const Projection& projection, vtkRenderer* renderer) {
    Overlay overlay(renderer);
    const double unit = std::min(picture.width / 1200.0, picture.height / 900.0);
    const double margin = 28 * unit, text_size = 21 * unit;

    double x = margin;
    const double top = picture.height - margin - 8 * unit;
    for (const auto& entry : picture.legend) {
        overlay.disc(x + 9 * unit, top, 9 * unit, entry.colour);
        overlay.text(x + 27 * unit, top, text_size, entry.text, Overlay::Align::left);
        x += (27 + 30) * unit + 0.52 * text_size * static_cast<double>(entry.text.size());
    }
    if (!picture.caption.empty())
        overlay.text(margin, top - (picture.legend.empty() ? 0 : 34 * unit), text_size, picture.caption,
                     Overlay::Align::left);

    const double bar = round_length(0.22 * picture.width * projection.mm_per_pixel);
    const double bar_pixels = bar / projection.mm_per_pixel;
    overlay.rectangle(margin, margin, bar_pixels, 6 * unit, ink);
    overlay.text(margin + bar_pixels / 2, margin + 24 * unit, text_size, length_text(bar), Overlay::Align::centre);

    const Eigen::Vector2d origin{picture.width - 80 * unit, 58 * unit};
    const std::array<Rgb, 3> axis_colours{Rgb{176, 58, 46}, Rgb{30, 132, 73}, Rgb{36, 89, 168}};
    const std::array<const char*, 3> axis_names{"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 direction = Vec3::Unit(axis);
        const Eigen::Vector2d seen{direction.dot(projection.right), direction.dot(projection.up)};
        overlay.arrow(origin, origin + 46 * unit * seen, axis_colours[axis]);
        if (seen.norm() > 0.2) {
            const Eigen::Vector2d name = origin + (46 + 12 / seen.norm()) * unit * seen;
            overlay.text(name.x(), name.y(), 18 * unit, axis_names[axis], Overlay::Align::centre, axis_colours[axis]);
        }
    }
}

/// Mean of every block of oversampling x oversampling pixels.
vtkSmartPointer<vtkImageData> averaged(vtkUnsignedCharArray* fine, int width, int height) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
    const unsigned char* in = fine->GetPointer(0);
    const std::size_t row = std::size_t{3} * width * oversampling;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 3; ++channel) {
                int sum = 0;
                for (int dy = 0; dy < oversampling; ++dy)
                    for (int dx = 0; dx < oversampling; ++dx)
                        sum += in[(y * oversampling + dy) * row + std::size_t{3} * (x * oversampling + dx) + channel];
                constexpr int samples = oversampling * oversampling;
                *out++ = static_cast<unsigned char>((sum + samples / 2) / samples);
            }
    return image;
}

}  // namespace

void draw(const Picture& picture, const std::filesystem::path& path) {
    vtkNew<Complaints> complaints;
    vtkOutputWindow::SetInstance(complaints);

    const Projection view = projection(picture);
    const auto window = offscreen_window(picture.width * oversampling, picture.height * oversampling);
    vtkNew<vtkRenderer> renderer;
    window->AddRenderer(renderer);
    renderer->SetBackground(unit_rgb(picture.background).data());

    if (!picture.centres.empty()) add_spheres(picture, renderer);
    if (!picture.mesh.triangles.empty()) add_mesh(picture.mesh, picture.mesh_colour, renderer);
    if (picture.outline) {
        const auto actor = box_actor(*picture.outline, false);
        actor->GetProperty()->SetColor(unit_rgb({150, 155, 165}).data());
        actor->GetProperty()->LightingOff();
        renderer->AddActor(actor);
    }
    for (const Box& plate : picture.plates) {
        const auto actor = box_actor(plate, true);
        actor->GetProperty()->SetColor(unit_rgb({120, 130, 145}).data());
        actor->GetProperty()->SetOpacity(0.18);
        renderer->AddActor(actor);
    }
    add_overlay(picture, view, renderer);

    vtkNew<vtkLight> lamp;  // over the left shoulder, so that the faces of a sample differ
    lamp->SetLightTypeToCameraLight();
    lamp->SetPosition(-0.45, 0.6, 1.0);
    renderer->AddLight(lamp);

    vtkCamera* camera = renderer->GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(view.focal_point.data());
    const Vec3 position = view.focal_point + 3 * view.depth * view.towards_camera;
    camera->SetPosition(position.data());
    camera->SetViewUp(view.up.data());
    camera->SetParallelScale(picture.height / 2.0 * view.mm_per_pixel);
    camera->SetClippingRange(view.depth, 5 * view.depth);

    window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window->GetPixelData(0, 0, picture.width * oversampling - 1, picture.height * oversampling - 1, 0, pixels);
    if (!complaints->first().empty()) throw std::runtime_error("VTK: " + complaints->first());

    vtkNew<vtkPNGWriter> writer;
    writer->WriteToMemoryOn();
    writer->SetInputData(averaged(pixels, picture.width, picture.height));
    writer->Write();
    vtkUnsignedCharArray* png = writer->GetResult();
    write_text(path, {reinterpret_cast<const char*>(png->GetPointer(0)), std::size_t(png->GetNumberOfValues())});
    vtkOutputWindow::SetInstance(nullptr);
}

}  // namespace tomodem
