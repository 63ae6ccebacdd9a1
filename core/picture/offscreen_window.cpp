#include "core/picture/offscreen_window.hpp"

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkObjectFactory.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>
#include <vtk_glew.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace tomodem {
namespace {

[[noreturn]] void fail(const std::string& what) {
    throw std::runtime_error("cannot draw without a screen: " + what +
                             "; install the Debian packages libegl1, libegl-mesa0 and libgl1-mesa-dri");
}

/// An OpenGL context that belongs to no screen and no drawable.
class SurfacelessContext {
 public:
    SurfacelessContext() {
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
        setenv("EGL_LOG_LEVEL", "fatal", 0);
        setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);  // a tool writes nothing but its output

        display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr))
            fail("EGL has no surfaceless platform");
        const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        const EGLint version[] = {
            EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 2, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!eglBindAPI(EGL_OPENGL_API) || !eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0)
            fail("EGL knows no OpenGL");
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
        if (context_ == EGL_NO_CONTEXT) fail("there is no OpenGL 3.2");
        make_current();
        if (!is_current()) fail("the OpenGL context cannot be used");
    }
    ~SurfacelessContext() {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }
    SurfacelessContext(const SurfacelessContext&) = delete;
    SurfacelessContext& operator=(const SurfacelessContext&) = delete;

    void make_current() { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }
    bool is_current() const { return eglGetCurrentContext() == context_; }

 private:
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

class OffscreenWindow : public vtkGenericOpenGLRenderWindow {
 public:
    static OffscreenWindow* New();
    vtkTypeMacro(OffscreenWindow, vtkGenericOpenGLRenderWindow);

    void MakeCurrent() override { context_.make_current(); }
    bool IsCurrent() override { return context_.is_current(); }
    int SupportsOpenGL() override { return 1; }

    void OpenGLInitContext() override {
        if (Initialized) return;
        ContextCreationTime.Modified();
        // Debian's GLEW loads every function and then complains that there is no X display: VTK would give up here.
        const GLenum result = glewInit();
        if ((result != GLEW_OK && result != GLEW_ERROR_NO_GLX_DISPLAY) || !GLEW_VERSION_3_2)
            fail("OpenGL's functions cannot be loaded");
        GlewInitValid = true;
        Initialized = true;
        MaximumHardwareLineWidth = 1;
    }

 protected:
    OffscreenWindow() = default;
    ~OffscreenWindow() override { Finalize(); }

 private:
    SurfacelessContext context_;
};
vtkStandardNewMacro(OffscreenWindow);

}  // namespace

vtkSmartPointer<vtkRenderWindow> offscreen_window(int width, int height, int threads) {
    setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 0);
    const auto window = vtkSmartPointer<OffscreenWindow>::New();
    window->SetSize(width, height);
    window->SetMultiSamples(0);
    window->SetFrameBlitModeToNoBlit();
    return window;
}

}  // namespace tomodem
