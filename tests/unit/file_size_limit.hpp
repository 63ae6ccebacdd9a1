#pragma once
#include <signal.h>
#include <sys/resource.h>

namespace tomodem {

/// While it lives, no file of this process grows beyond `bytes`: a disk that fills up, for an unprivileged test.
class FileSizeLimit {
 public:
    explicit FileSizeLimit(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        handler_ = ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        ::signal(SIGXFSZ, handler_);
    }

 private:
    rlimit before_{};
    sighandler_t handler_;
};

}  // namespace tomodem
