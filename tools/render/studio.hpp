#pragma once
#include <memory>

#include "tools/render/image.hpp"
#include "tools/render/picture.hpp"

namespace tomodem::render {

/// Where pictures of one size are drawn, one after the other, in the one window that a process has.
///
/// With a scale bar and the directions of the axes, twice as fine as asked for and averaged. The same picture on any
/// number of threads.
class Studio {
 public:
    /// @throws std::runtime_error if there is no software OpenGL (offscreen_window)
    Studio(int width, int height, int threads);
    ~Studio();
    Studio(const Studio&) = delete;
    Studio& operator=(const Studio&) = delete;

    /// @note  20,000 spheres take about 2 s on two cores, 500,000 about 10 s
    Image draw(const Picture& picture);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem::render
