#pragma once
#include <vtkRenderer.h>

#include "tools/render/projection.hpp"

namespace tomodem::render {

/// What is written and drawn flat over a picture: legend, caption, colour bar, arrows, scale bar, axes.
/// @param scale  pixels of the window in one of the picture
void add_overlay(const Picture& picture, const Projection& projection, int scale, vtkRenderer* renderer);

}  // namespace tomodem::render
