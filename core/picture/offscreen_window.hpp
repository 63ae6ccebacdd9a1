#pragma once

class vtkRenderWindow;
template <class Object>
class vtkSmartPointer;

namespace tomodem {

/// A VTK window that exists in memory only: Mesa's software OpenGL through EGL, no X server, no graphics card.
///
/// The same rasteriser on every machine, so the same pixels, unless LIBGL_ALWAYS_SOFTWARE is set otherwise.
/// One window a process.
///
/// @param threads  of the rasteriser, unless LP_NUM_THREADS is set
/// @throws std::runtime_error naming the Debian packages if EGL, or OpenGL 3.2, is not there
vtkSmartPointer<vtkRenderWindow> offscreen_window(int width, int height, int threads);

}  // namespace tomodem
