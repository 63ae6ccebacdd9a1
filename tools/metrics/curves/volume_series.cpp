#include "tools/metrics/curves/volume_series.hpp"

#include <fmt/format.h>

#include <exception>
#include <mutex>
#include <thread>

#include "core/base/error.hpp"
#include "core/surface/alpha_surface.hpp"

namespace tomodem::curves {

std::vector<FrameVolume> volume_series(const RunReader& run, double probe_radius, int threads,
                                       const std::function<void(double)>& progress) {
    std::vector<FrameVolume> volumes(run.frame_count());
    std::vector<std::exception_ptr> errors(run.frame_count());
    std::mutex mutex;
    std::size_t next = 0, done = 0;
    const auto work = [&] {
        for (;;) {
            std::size_t index;
            {
                const std::scoped_lock lock(mutex);
                if (next == volumes.size()) return;
                index = next++;
            }
            try {
                const AlphaSurface surface = alpha_surface(run.frame(index).position, {.probe_radius = probe_radius});
                volumes[index] = {surface.volume, surface.area, surface.components.size()};
            } catch (const InvalidInput& error) {
                errors[index] = std::make_exception_ptr(InvalidInput(fmt::format("frame {}: {}", index, error.what())));
            } catch (...) {
                errors[index] = std::current_exception();
            }
            const std::scoped_lock lock(mutex);
            if (progress) progress(double(++done));
        }
    };
    {
        std::vector<std::jthread> team;
        for (int i = 1; i < threads && std::size_t(i) < volumes.size(); ++i) team.emplace_back(work);
        work();
    }
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
    return volumes;
}

}  // namespace tomodem::curves
