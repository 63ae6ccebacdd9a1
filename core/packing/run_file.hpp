#pragma once
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/packing/packing.hpp"

/// The one place that knows how packings and runs lie in an H5MD file (docs/file-formats.md).
///
/// A file is created complete in shape, by one process. What follows are numbers at fixed places, written by one
/// process or by many together; so a file whose writers were killed at any moment can be read, and its run resumed.
namespace tomodem {

struct CurveShape {
    std::string name, unit;
    std::size_t points = 0;
};

struct RunShape {
    std::size_t frames = 1;
    std::vector<ParticleField> fields;
    std::vector<CurveShape> curves;
};

/// Creates the file; the positions of `packing` are not written, only its labels, ids, objects and box.
/// @param shown  name of the file in errors
/// @throws InvalidInput if the arrays of the packing do not fit together, or the file cannot be written
void create_run_file(const Packing& packing, const RunShape& shape, const Provenance& provenance,
                     const std::filesystem::path& where, const std::filesystem::path& shown);

/// Fills the places of a created file.
class RunFile {
 public:
    /// With a communicator, construction, write_rows and close are collective.
    RunFile(const std::filesystem::path& where, const std::filesystem::path& shown, MPI_Comm processes = MPI_COMM_NULL);
    ~RunFile();
    RunFile(const RunFile&) = delete;
    RunFile& operator=(const RunFile&) = delete;

    /// Rows of a field ("position" or one of the shape's) from `first_row` on, row by row.
    void write_rows(const ParticleField& field, std::size_t frame, std::size_t first_row, std::span<const double> rows);
    /// Says that all rows of a frame are written. By one process.
    void mark_frame(std::size_t frame, std::int64_t step, double time);
    /// By one process.
    void write_point(const std::string& curve, std::size_t index, std::int64_t step, double time, double value);
    void close();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

inline const ParticleField position_field{"position", "mm", 3};

/// @throws InvalidInput `where` and what is wrong, if the arrays of a packing do not fit together
void require_sound_packing(const Packing& packing, const std::string& where);

/// A sidecar never stands beside a file it does not describe: the old one goes first, the new one comes last.
void remove_sidecar(const std::filesystem::path& run_file);
/// Writes NAME.xdmf beside the run file NAME.h5.
void write_sidecar(std::size_t particles, bool has_objects, const std::vector<double>& times,
                   const std::vector<ParticleField>& fields, const std::filesystem::path& run_file);

}  // namespace tomodem
