#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "core/volume/reading/reading.hpp"

namespace tomodem::formats {
namespace {

/// What the reading process answers first, and before the voxels of each order.
struct Answer {
    VoxelIndex size{};
    VoxelType type = VoxelType::uint8;
    bool has_spacing = false, spacing_has_unit = false, has_origin = false;
    std::array<double, 3> spacing{}, origin{};
    std::array<char, 200> format{};
    std::array<char, 1000> error{};  // empty: all is well
};

struct Order {
    std::int32_t k = 0, count = 0;
    Window window;
};

template <std::size_t size>
void put(std::array<char, size>& to, const std::string& text) {
    std::snprintf(to.data(), to.size(), "%s", text.c_str());
}

bool send_all(int socket, const void* data, std::size_t bytes) {
    for (const auto* at = static_cast<const char*>(data); bytes > 0;) {
        const ssize_t sent = send(socket, at, bytes, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        at += sent;
        bytes -= static_cast<std::size_t>(sent);
    }
    return true;
}

bool receive_all(int socket, void* data, std::size_t bytes) {
    for (auto* at = static_cast<char*>(data); bytes > 0;) {
        const ssize_t got = recv(socket, at, bytes, 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

void limit(int resource, rlim_t most) {
    rlimit now{};
    getrlimit(resource, &now);
    now.rlim_cur = std::min(now.rlim_max, most);
    setrlimit(resource, &now);
}

/// Runs `work`; what it throws becomes the answer's error.
template <class Work>
Answer attempt(const fs::path& path, const Work& work) {
    Answer answer;
    try {
        work(answer);
    } catch (const InvalidInput& error) {
        put(answer.error, error.what());
    } catch (const std::exception& error) {
        put(answer.error,
            fmt::format("cannot read volume '{}': it is cut or damaged ({})", path.string(), error.what()));
    }
    return answer;
}

/// Answers orders until the other side hangs up.
void serve(const fs::path& path, int socket, const std::function<Source()>& open_source) {
    Source source;
    const Answer greeting = attempt(path, [&](Answer& answer) {
        // A damaged file may ask for any time and memory.
        const auto bytes = static_cast<rlim_t>(file_bytes(path));
        limit(RLIMIT_CPU, 10 + bytes / 10'000'000);
#ifndef TOMODEM_FUZZ  // the sanitizers reserve terabytes
        limit(RLIMIT_AS, (rlim_t{8} << 30) + 100 * bytes);
#endif
        source = open_source();
        limit(RLIMIT_CPU, RLIM_INFINITY);
        const VolumeHeader& header = source->header();
        answer.size = header.size;
        answer.type = header.type;
        put(answer.format, header.format);
        answer.has_spacing = header.spacing.has_value();
        answer.spacing_has_unit = header.spacing_has_unit;
        answer.has_origin = header.origin.has_value();
        for (int axis = 0; axis < 3; ++axis) {
            if (header.spacing) answer.spacing[axis] = (*header.spacing)[axis];
            if (header.origin) answer.origin[axis] = (*header.origin)[axis];
        }
    });
    if (!send_all(socket, &greeting, sizeof greeting) || !source) return;
    std::vector<std::byte> voxels;
    for (Order order; receive_all(socket, &order, sizeof order);) {
        const Answer answer = attempt(path, [&](Answer&) {
            voxels.resize(static_cast<std::size_t>(order.count * order.window.width * order.window.height) *
                          bytes_of(source->header().type));
            source->read(order.k, order.count, order.window, voxels.data());
        });
        if (!send_all(socket, &answer, sizeof answer)) return;
        if (answer.error[0] == 0 && !send_all(socket, voxels.data(), voxels.size())) return;
    }
}

class RemoteSource : public VolumeSource {
 public:
    RemoteSource(const fs::path& path, const char* library, const std::function<Source()>& open_source)
        : path_(path), library_(library) {
        int ends[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) cannot_read(path, std::strerror(errno));
        std::fflush(nullptr);
        reader_ = fork();
        if (reader_ == 0) {
            // Its last words would be about its own memory.
            if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
            for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGTERM, SIGINT, SIGHUP})
                std::signal(signal, SIG_DFL);
            close(ends[0]);
            serve(path, ends[1], open_source);
            _exit(0);
        }
        close(ends[1]);
        socket_ = ends[0];
        try {
            if (reader_ < 0) cannot_read(path, std::strerror(errno));
            const Answer greeting = answer();
            check_size(path, {greeting.size[0], greeting.size[1], greeting.size[2]});
            header_.format = greeting.format.data();
            header_.size = greeting.size;
            header_.type = greeting.type;
            header_.spacing_has_unit = greeting.spacing_has_unit;
            if (greeting.has_spacing) header_.spacing = Vec3(greeting.spacing.data());
            if (greeting.has_origin) header_.origin = Vec3(greeting.origin.data());
        } catch (...) {
            end();
            throw;
        }
    }
    ~RemoteSource() override { end(); }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const Order order{k, count, window};
        if (!send_all(socket_, &order, sizeof order)) failed();
        answer();
        const auto bytes = static_cast<std::size_t>(count * window.width * window.height) * bytes_of(header_.type);
        if (!receive_all(socket_, voxels, bytes)) failed();
    }

 private:
    Answer answer() const {
        Answer found;
        if (!receive_all(socket_, &found, sizeof found)) failed();
        if (found.error[0] != 0) throw InvalidInput(found.error.data());
        return found;
    }
    [[noreturn]] void failed() const {
        cannot_read(path_, fmt::format("it is cut or damaged: the {} library failed on it", library_));
    }
    void end() {
        close(socket_);
        if (reader_ > 0) waitpid(reader_, nullptr, 0);
    }

    fs::path path_;
    const char* library_;
    int socket_ = -1;
    pid_t reader_ = -1;
};

}  // namespace

Source in_own_process(const fs::path& path, const char* library, const std::function<Source()>& open_source) {
    return std::make_unique<RemoteSource>(path, library, open_source);
}

}  // namespace tomodem::formats
