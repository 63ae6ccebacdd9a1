#include <fcntl.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/volume_formats/formats.hpp"

namespace tomodem::formats {
namespace {

/// Scalar grids by the type that their voxels are handed on as.
template <class Visit>
bool with_grid(const openvdb::GridBase::Ptr& grid, const Visit& visit) {
    if (const auto found = openvdb::gridPtrCast<openvdb::Int32Grid>(grid)) return visit(*found, std::int32_t{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return visit(*found, float{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid)) return visit(*found, double{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::Int64Grid>(grid)) return visit(*found, std::int64_t{}), true;
    if (const auto found = openvdb::gridPtrCast<openvdb::BoolGrid>(grid)) return visit(*found, std::uint8_t{}), true;
    return false;
}

VoxelType type_of(std::int32_t) {
    return VoxelType::int32;
}
VoxelType type_of(float) {
    return VoxelType::float32;
}
VoxelType type_of(double) {
    return VoxelType::float64;
}
VoxelType type_of(std::int64_t) {
    return VoxelType::int64;
}
VoxelType type_of(std::uint8_t) {
    return VoxelType::uint8;
}

/// What the reading process says first.
struct Greeting {
    VoxelIndex size{};
    VoxelType type = VoxelType::int32;
    std::array<double, 3> spacing{};
    std::array<char, 300> name{}, error{};

    static void put(std::array<char, 300>& to, const std::string& text) {
        std::snprintf(to.data(), to.size(), "%s", text.c_str());
    }
};

struct Order {
    std::int32_t k = 0, count = 0;
    Window window;
};

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

openvdb::GridBase::Ptr only_grid(const fs::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    constexpr bool delayed_loading = false;
    file.open(delayed_loading);
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    if (grids->size() != 1)
        throw InvalidInput(fmt::format("it holds {} grids; save the one that is meant by itself", grids->size()));
    return grids->front();
}

/// Answers orders until the other side hangs up. Without threads: TBB's do not survive a fork.
void serve(const fs::path& path, int socket) {
    Greeting greeting;
    openvdb::GridBase::Ptr grid;
    openvdb::CoordBBox box;
    try {
        // A damaged file may ask for any time and memory.
        const auto bytes = static_cast<rlim_t>(file_bytes(path));
        limit(RLIMIT_CPU, 10 + bytes / 10'000'000);
        limit(RLIMIT_AS, (rlim_t{4} << 30) + 100 * bytes);
        grid = only_grid(path);
        box = grid->evalActiveVoxelBoundingBox();
        if (box.empty()) throw InvalidInput("its grid has no active voxel");
        Greeting::put(greeting.name, grid->getName());
        const openvdb::Coord size = box.dim();
        greeting.size = {size.x(), size.y(), size.z()};
        const openvdb::Vec3d spacing = grid->voxelSize();
        greeting.spacing = {spacing.x(), spacing.y(), spacing.z()};
        limit(RLIMIT_CPU, RLIM_INFINITY);
        if (!with_grid(grid, [&](const auto&, auto value) { greeting.type = type_of(value); }))
            throw InvalidInput(
                fmt::format("its grid holds values of type {}; a volume has one number a voxel", grid->valueType()));
    } catch (const InvalidInput& error) {
        Greeting::put(greeting.error, error.what());
    } catch (const std::exception& error) {
        Greeting::put(greeting.error, fmt::format("it is cut or damaged ({})", error.what()));
    }
    if (!send_all(socket, &greeting, sizeof greeting) || greeting.error[0] != 0) return;
    with_grid(grid, [&](const auto& typed, auto value) {
        using Value = decltype(value);
        auto accessor = typed.getConstAccessor();
        std::vector<Value> row;
        for (Order order; receive_all(socket, &order, sizeof order);)
            for (std::int32_t z = order.k; z < order.k + order.count; ++z)
                for (std::int64_t y = order.window.y; y < order.window.y + order.window.height; ++y) {
                    row.clear();
                    for (std::int64_t x = order.window.x; x < order.window.x + order.window.width; ++x)
                        row.push_back(static_cast<Value>(
                            accessor.getValue(box.min().offsetBy(static_cast<int>(x), static_cast<int>(y), z))));
                    if (!send_all(socket, row.data(), row.size() * sizeof(Value))) return;
                }
    });
}

/// Reads through a process of its own: on a damaged file OpenVDB may run over its memory instead of saying so.
class VdbSource : public VolumeSource {
 public:
    explicit VdbSource(const fs::path& path) : path_(path) {
        int ends[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) cannot_read(path, std::strerror(errno));
        reader_ = fork();
        if (reader_ == 0) {
            // Its last words would be about its own memory.
            if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
            for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGTERM, SIGINT}) std::signal(signal, SIG_DFL);
            close(ends[0]);
            serve(path, ends[1]);
            _exit(0);
        }
        close(ends[1]);
        socket_ = ends[0];
        Greeting greeting;
        try {
            if (reader_ < 0) cannot_read(path, std::strerror(errno));
            if (!receive_all(socket_, &greeting, sizeof greeting)) failed();
            if (greeting.error[0] != 0) cannot_read(path, greeting.error.data());
            check_size(path, {greeting.size[0], greeting.size[1], greeting.size[2]});
        } catch (...) {
            end();
            throw;
        }
        header_.format = fmt::format("OpenVDB grid '{}'", greeting.name.data());
        header_.files = {path};
        header_.size = greeting.size;
        header_.type = greeting.type;
        const Vec3 spacing(greeting.spacing[0], greeting.spacing[1], greeting.spacing[2]);
        if ((spacing.array() > 0).all() && spacing.allFinite()) header_.spacing = spacing;
    }
    ~VdbSource() override { end(); }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const Order order{k, count, window};
        const auto bytes = static_cast<std::size_t>(count * window.width * window.height) * bytes_of(header_.type);
        if (!send_all(socket_, &order, sizeof order) || !receive_all(socket_, voxels, bytes)) failed();
    }

 private:
    [[noreturn]] void failed() const { cannot_read(path_, "it is cut or damaged: the OpenVDB library failed on it"); }
    void end() {
        close(socket_);
        if (reader_ > 0) waitpid(reader_, nullptr, 0);
    }

    fs::path path_;
    int socket_ = -1;
    pid_t reader_ = -1;
};

}  // namespace

Source open_vdb(const fs::path& path) {
    return std::make_unique<VdbSource>(path);
}

}  // namespace tomodem::formats
