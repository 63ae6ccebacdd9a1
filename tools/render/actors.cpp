#include "tools/render/actors.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkUnsignedCharArray.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

namespace tomodem::render {
namespace {

vtkSmartPointer<vtkActor> surface_actor(const Surface& surface) {
    const TriangleMesh& mesh = surface.mesh;
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
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
        points->InsertNextPoint(mesh.vertices[k].data());
        normals->InsertNextTuple(normal[k].normalized().eval().data());
        const std::array<unsigned char, 3> colour{surface.colours[k].red, surface.colours[k].green,
                                                  surface.colours[k].blue};
        colours->InsertNextTypedTuple(colour.data());
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetPointData()->SetNormals(normals);
    data->GetPointData()->SetScalars(colours);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(0.2);
    actor->GetProperty()->SetDiffuse(0.85);
    return actor;
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

}  // namespace

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

void add_surface(const Surface& surface, vtkRenderer* renderer) {
    if (surface.mesh.triangles.empty()) return;
    if (surface.opacity >= 1) {
        renderer->AddActor(surface_actor(surface));
        return;
    }
    // The far side first, so that the near side lies over it: no sorting of triangles, the same picture everywhere.
    for (const bool far_side : {true, false}) {
        const auto actor = surface_actor(surface);
        actor->GetProperty()->SetOpacity(surface.opacity);
        actor->GetProperty()->SetFrontfaceCulling(far_side);
        actor->GetProperty()->SetBackfaceCulling(!far_side);
        actor->GetShaderProperty()->AddFragmentShaderReplacement(
            "//VTK::Light::Impl", true,
            "//VTK::Light::Impl\n"
            "  float slant = 1.0 - abs(normalVCVSOutput.z);\n"
            "  fragOutput0.a *= clamp(0.5 + 1.8 * slant * slant, 0.0, 1.0 / max(opacity, 0.01));\n",
            false);
        renderer->AddActor(actor);
    }
}

void add_outline(const Box& box, vtkRenderer* renderer) {
    const auto actor = box_actor(box, false);
    actor->GetProperty()->SetColor(150 / 255.0, 155 / 255.0, 165 / 255.0);
    actor->GetProperty()->LightingOff();
    renderer->AddActor(actor);
}

void add_plate(const Box& box, vtkRenderer* renderer) {
    const auto actor = box_actor(box, true);
    actor->GetProperty()->SetColor(120 / 255.0, 130 / 255.0, 145 / 255.0);
    actor->GetProperty()->SetOpacity(0.18);
    renderer->AddActor(actor);
}

}  // namespace tomodem::render
