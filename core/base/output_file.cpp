#include "core/base/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "core/base/error.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

std::string system_text(int code) {
    return std::system_category().message(code);
}

/// @return 0, or the errno of what failed
int synchronise(const fs::path& path, int flags) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
    if (descriptor < 0) return errno;
    const int code = ::fsync(descriptor) == 0 ? 0 : errno;
    return ::close(descriptor) == 0 || code != 0 ? code : errno;
}

/// Files that the end of the process must not leave behind; as many as a tool ever has open at once, and more.
std::array<std::atomic<const char*>, 64> unfinished{};

void remove_unfinished() {
    for (const auto& path : unfinished)
        if (const char* name = path.load()) ::unlink(name);
}

extern "C" void end_by_signal(int signal_number) {
    remove_unfinished();
    ::raise(signal_number);  // with SA_RESETHAND: ends the process as the signal would have
}

/// Ctrl-C, kill, a closed terminal, and a library that calls exit(); a signal handler of somebody else's, or "ignore"
/// (nohup), stays.
void catch_endings() {
    static const bool once = [] {
        for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
            struct sigaction action {};
            if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
            action.sa_handler = end_by_signal;
            action.sa_flags = SA_RESETHAND | SA_NODEFER;
            ::sigaction(number, &action, nullptr);
        }
        return std::atexit(remove_unfinished) == 0;
    }();
    (void)once;
}

void remember(const char* name) {
    catch_endings();
    for (auto& slot : unfinished)
        if (const char* empty = nullptr; slot.compare_exchange_strong(empty, name)) return;
}

void forget(const char* name) {
    for (auto& slot : unfinished)
        if (const char* same = name; slot.compare_exchange_strong(same, nullptr)) return;
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace

OutputFile::OutputFile(fs::path final_path) : final_(std::move(final_path)) {
    check();
    part_ = folder_of(final_) /
            fmt::format(".{}.part-{}{}", final_.stem().string(), ::getpid(), final_.extension().string());
    remember(part_.c_str());
}

OutputFile::OutputFile(fs::path final_path, fs::path part) : final_(std::move(final_path)), part_(std::move(part)) {
    check();
    remember(part_.c_str());
}

void OutputFile::check() {
    std::error_code error;
    if (fs::is_symlink(final_, error)) final_ = fs::weakly_canonical(final_, error);  // keep the link, write its target
    const fs::path folder = folder_of(final_);
    if (final_.filename().empty() || fs::is_directory(final_, error))
        throw InvalidInput(fmt::format("cannot write '{}': it is a folder, name a file", final_.string()));
    if (fs::exists(final_, error) && !fs::is_regular_file(final_, error))
        throw InvalidInput(fmt::format("cannot write '{}': it is not a regular file", final_.string()));
    if (!fs::is_directory(folder, error))
        throw InvalidInput(fmt::format("cannot write '{}': there is no folder '{}', create it first", final_.string(),
                                       folder.string()));
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        throw InvalidInput(fmt::format("cannot write '{}': no permission to write in the folder '{}' ({})",
                                       final_.string(), folder.string(), system_text(errno)));
}

void OutputFile::keep() {
    forget(part_.c_str());
    kept_ = true;
}

OutputFile::~OutputFile() {
    if (!kept_) forget(part_.c_str());
    std::error_code ignored;
    if (!committed_ && !kept_) fs::remove(part_, ignored);
}

void OutputFile::flush() {
    if (const int code = synchronise(part_, O_RDONLY); code != 0)
        throw InvalidInput(fmt::format("cannot write '{}': {}", final_.string(), system_text(code)));
}

void OutputFile::commit() {
    flush();
    std::error_code error;
    fs::rename(part_, final_, error);
    if (error) throw InvalidInput(fmt::format("cannot write '{}': {}", final_.string(), error.message()));
    committed_ = true;
    synchronise(folder_of(final_), O_RDONLY | O_DIRECTORY);  // the name itself; some file systems refuse, no harm
}

void write_text(const fs::path& path, std::string_view text) {
    OutputFile output(path);
    const int descriptor = ::open(output.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    int code = descriptor < 0 ? errno : 0;
    for (std::size_t done = 0; code == 0 && done < text.size();) {
        const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
        if (count >= 0)
            done += static_cast<std::size_t>(count);
        else if (errno != EINTR)
            code = errno;
    }
    if (descriptor >= 0 && ::close(descriptor) != 0 && code == 0) code = errno;
    if (code != 0) throw InvalidInput(fmt::format("cannot write '{}': {}", path.string(), system_text(code)));
    output.commit();
}

}  // namespace tomodem
