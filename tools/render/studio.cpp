#include "tools/render/studio.hpp"

#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "core/picture/offscreen_window.hpp"
#include "tools/render/actors.hpp"
#include "tools/render/overlay.hpp"
#include "tools/render/projection.hpp"

namespace tomodem::render {
namespace {

constexpr int oversampling = 2;

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

/// Mean of every block of oversampling x oversampling pixels.
Image averaged(vtkUnsignedCharArray* fine, int width, int height) {
    Image image{width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height)};
    std::uint8_t* out = image.pixels.data();
    const unsigned char* in = fine->GetPointer(0);
    const std::size_t row = std::size_t{3} * width * oversampling;
    for (int y = height - 1; y >= 0; --y)  // OpenGL begins at the bottom
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 3; ++channel) {
                int sum = 0;
                for (int dy = 0; dy < oversampling; ++dy)
                    for (int dx = 0; dx < oversampling; ++dx)
                        sum += in[(y * oversampling + dy) * row + std::size_t{3} * (x * oversampling + dx) + channel];
                constexpr int samples = oversampling * oversampling;
                *out++ = static_cast<std::uint8_t>((sum + samples / 2) / samples);
            }
    return image;
}

void aim(const Projection& view, vtkCamera* camera) {
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(view.focal_point.data());
    const Vec3 position = view.focal_point + 3 * view.depth * view.towards_camera;
    camera->SetPosition(position.data());
    camera->SetViewUp(view.up.data());
    camera->SetParallelScale(view.height / 2.0 * view.mm_per_pixel);
    camera->SetClippingRange(view.depth, 5 * view.depth);
}

}  // namespace

struct Studio::State {
    int width, height;
    vtkNew<Complaints> complaints;
    vtkSmartPointer<vtkRenderWindow> window;
};

Studio::Studio(int width, int height, int threads) : state_(std::make_unique<State>()) {
    state_->width = width;
    state_->height = height;
    vtkOutputWindow::SetInstance(state_->complaints);
    state_->window = offscreen_window(width * oversampling, height * oversampling, threads);
}

Studio::~Studio() {
    vtkOutputWindow::SetInstance(nullptr);
}

Image Studio::draw(const Picture& picture) {
    const Projection view = projection(picture);
    vtkNew<vtkRenderer> renderer;
    renderer->SetBackground(picture.background.red / 255.0, picture.background.green / 255.0,
                            picture.background.blue / 255.0);
    state_->window->AddRenderer(renderer);

    if (!picture.centres.empty()) add_spheres(picture, renderer);
    for (const Surface& surface : picture.surfaces) add_surface(surface, renderer);
    if (picture.outline) add_outline(*picture.outline, renderer);
    for (const Box& plate : picture.plates) add_plate(plate, renderer);
    add_overlay(picture, view, oversampling, renderer);

    vtkNew<vtkLight> lamp;  // over the left shoulder, so that the faces of a sample differ
    lamp->SetLightTypeToCameraLight();
    lamp->SetPosition(-0.45, 0.6, 1.0);
    renderer->AddLight(lamp);
    aim(view, renderer->GetActiveCamera());

    state_->window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    state_->window->GetPixelData(0, 0, state_->width * oversampling - 1, state_->height * oversampling - 1, 0, pixels);
    renderer->ReleaseGraphicsResources(state_->window);
    state_->window->RemoveRenderer(renderer);
    if (!state_->complaints->first().empty()) throw std::runtime_error("VTK: " + state_->complaints->first());
    return averaged(pixels, state_->width, state_->height);
}

}  // namespace tomodem::render
