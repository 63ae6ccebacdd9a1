#include "tools/render/series.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>

#include "tools/render/movie.hpp"
#include "tools/render/studio.hpp"

namespace tomodem::render {

void draw_series(const Series& series, const std::function<Picture(std::size_t)>& picture, int threads,
                 Reporter& reporter) {
    const std::size_t count = series.endings.empty() ? 1 : series.endings.size();
    const bool movie_wanted = series.output.extension() == ".mp4";
    const auto progress = reporter.progress("drawing", static_cast<double>(count));
    std::optional<Studio> studio;
    std::optional<Movie> movie;
    for (std::size_t k = 0; k < count; ++k) {
        const Picture next = picture(k);
        if (!studio) studio.emplace(next.width, next.height, threads);
        if (movie_wanted && !movie) movie.emplace(series.output, next.width, next.height, series.pictures_per_second);
        const Image image = studio->draw(next);
        if (movie)
            movie->add(image);
        else if (series.endings.empty())
            write_png(image, series.output);
        else
            write_png(image, series.output.parent_path() /
                                 fmt::format("{}_{}.png", series.output.stem().string(), series.endings[k]));
        progress->update(static_cast<double>(k + 1));
    }
    if (movie) movie->commit();
}

View turned(View view, double share) {
    constexpr double whole = 2 * 3.14159265358979323846;
    view.towards_camera = Eigen::AngleAxisd(share * whole, Vec3::UnitZ()) * view.towards_camera;
    view.turning = true;
    return view;
}

}  // namespace tomodem::render
