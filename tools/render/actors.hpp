#pragma once
#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "tools/render/picture.hpp"

/// The bodies of a picture, as VTK draws them.
namespace tomodem::render {

void add_spheres(const Picture& picture, vtkRenderer* renderer);
/// Translucent ones are drawn in the order in which they are added.
void add_surface(const Surface& surface, vtkRenderer* renderer);
void add_outline(const Box& box, vtkRenderer* renderer);
void add_plate(const Box& box, vtkRenderer* renderer);

}  // namespace tomodem::render
