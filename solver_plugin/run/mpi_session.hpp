#pragma once

namespace tomodem {

/// MPI of a process, from its beginning to its end.
class MpiSession {
 public:
    MpiSession(int& argc, char**& argv);
    /// Whether this is the process that reports.
    bool first() const { return first_; }
    /// Ends MPI. @return the highest status of all processes
    /// Where one failed and another does not come to its end within some seconds, all are ended: that one would wait
    /// for ever.
    int end(int status);

 private:
    bool first_;
};

}  // namespace tomodem
