#include "tools/render/movie.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"

extern char** environ;

namespace tomodem::render {
namespace {

bool is_there(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "/usr/bin");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
    return false;
}

}  // namespace

struct Movie::State {
    OutputFile file;
    pid_t encoder = -1;
    int pictures = -1;    ///< to the encoder
    int complaints = -1;  ///< from it

    explicit State(const std::filesystem::path& path) : file(path) {}
    ~State() {
        if (pictures >= 0) close(pictures);
        if (encoder > 0) {
            kill(encoder, SIGKILL);
            waitpid(encoder, nullptr, 0);
        }
        if (complaints >= 0) close(complaints);
    }

    /// Ends the encoder; its own words if it failed.
    std::string end() {
        close(pictures);
        pictures = -1;
        std::string words;
        std::array<char, 512> part;
        for (ssize_t got; (got = read(complaints, part.data(), part.size())) > 0;)
            if (words.size() < 4096) words.append(part.data(), static_cast<std::size_t>(got));
        int status = 0;
        while (waitpid(encoder, &status, 0) < 0 && errno == EINTR) {
        }
        encoder = -1;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
        words = words.substr(0, words.find('\n'));
        return words.empty() ? fmt::format("it ended with status {}", status) : words;
    }
};

Movie::Movie(const std::filesystem::path& path, int width, int height, double pictures_per_second) {
    if (!is_there("ffmpeg"))
        throw InvalidInput(fmt::format(
            "cannot write movie '{}': there is no ffmpeg here; install the Debian package ffmpeg, or write numbered "
            "pictures by a name that ends in .png",
            path.string()));
    state_ = std::make_unique<State>(path);
    std::signal(SIGPIPE, SIG_IGN);  // an encoder that ends is an error with a name
    std::array<int, 2> in, out;
    if (pipe2(in.data(), O_CLOEXEC) != 0 || pipe2(out.data(), O_CLOEXEC) != 0)
        throw std::runtime_error("no pipe to ffmpeg");
    state_->pictures = in[1];
    state_->complaints = out[0];
    const std::string size = fmt::format("{}x{}", width, height), rate = fmt::format("{:g}", pictures_per_second);
    std::vector<std::string> words{"ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt",
                                   "rgb24", "-s", size, "-r", rate, "-i", "pipe:0",
                                   // players want even sizes and this pixel format
                                   "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-c:v",
                                   "libx264", "-crf", "18", "-movflags", "+faststart", "-fflags", "+bitexact",
                                   "-flags:v", "+bitexact", state_->file.path().string()};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t wiring;
    posix_spawn_file_actions_init(&wiring);
    posix_spawn_file_actions_adddup2(&wiring, in[0], 0);
    posix_spawn_file_actions_addopen(&wiring, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&wiring, out[1], 2);
    const int failure = posix_spawnp(&state_->encoder, "ffmpeg", &wiring, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&wiring);
    close(in[0]);
    close(out[1]);
    if (failure != 0) {
        state_->encoder = -1;
        throw InvalidInput(fmt::format("cannot write movie '{}': ffmpeg does not start", path.string()));
    }
}

Movie::~Movie() = default;

void Movie::add(const Image& image) {
    for (std::size_t done = 0; done < image.pixels.size();) {
        const ssize_t written = write(state_->pictures, image.pixels.data() + done, image.pixels.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw InvalidInput(fmt::format("ffmpeg stopped: {}", state_->end()));
        done += static_cast<std::size_t>(written);
    }
}

void Movie::commit() {
    if (const std::string complaint = state_->end(); !complaint.empty())
        throw InvalidInput(fmt::format("ffmpeg cannot write the movie: {}", complaint));
    state_->file.commit();
}

}  // namespace tomodem::render
