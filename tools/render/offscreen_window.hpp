#pragma once
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>

namespace tomodem {

/// A VTK window that exists in memory only: Mesa's software OpenGL through EGL, no X server, no graphics card.
///
/// The same machine-independent rasteriser everywhere unless LIBGL_ALWAYS_SOFTWARE says otherwise;
/// One window a process.
///
/// @throws std::runtime_error naming the Debian packages if EGL, or OpenGL 3.2, is not there
/// @param threads  that the rasteriser draws with, unless LP_NUM_THREADS says otherwise
vtkSmartPointer<vtkRenderWindow> offscreen_window(int width, int height, int threads);

}  // namespace tomodem
