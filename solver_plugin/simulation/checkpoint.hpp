#pragma once
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/load_path.hpp"

/// What an interrupted run needs to resume bit by bit: docs/running.md.
namespace tomodem {

/// The particles of one process at a moment, in the order in which the solver holds them, in the solver's lengths.
struct ParticleState {
    std::vector<std::int32_t> tag, type, image;
    std::vector<double> position, velocity;  ///< 3 a particle
    /// What a particle remembers (contacts): `memory_length[i]` words of particle i, one after the other.
    std::vector<std::int32_t> memory_length;
    std::vector<std::int64_t> memory;
};

/// Sums by row of the sample: each process holds the rows from `first` on, `components` numbers a row.
struct RowBlock {
    std::size_t first = 0;
    int components = 0;
    std::vector<double> values;
};

struct Checkpoint {
    ParticleState particles;                             ///< of this process
    RowBlock sums;                                       ///< of this process; no components: nothing is summed
    std::map<std::string, std::vector<double>> numbers;  ///< the same on every process, by name

    double number(const std::string& name) const { return numbers.at(name).at(0); }
};

/// A clock as numbers of a checkpoint, and back.
std::vector<double> numbers_of(const LoadClock& clock);
LoadClock clock_of(const std::vector<double>& numbers);

/// Inputs that must match to resume a run.
struct Inputs {
    std::string version, scene, digests;
};

/// Collective. The file appears complete; the one before stays until then.
void write_checkpoint(const Checkpoint& checkpoint, const Inputs& inputs, const std::filesystem::path& path,
                      MPI_Comm communicator);

struct FoundCheckpoint {
    Checkpoint checkpoint;
    bool same_processes = true;  ///< false: the particles are a share of all, wherever they are; memory likewise
};

/// Every process reads its part.
/// @throws InvalidInput if it was made by another version, scene or sample: says which
FoundCheckpoint read_checkpoint(const std::filesystem::path& path, const Inputs& inputs, MPI_Comm communicator);

/// Adds the state of its end to a run file that is complete but for it, from which another load can continue.
/// Collective. @param shown  the file in errors
void write_end_state(const Checkpoint& checkpoint, const std::filesystem::path& run_file,
                     const std::filesystem::path& shown, MPI_Comm communicator);

/// Every process reads its part.
/// @throws InvalidInput if the file has no such state, or one of another format
FoundCheckpoint read_end_state(const std::filesystem::path& run_file, MPI_Comm communicator);

/// The first row that process `rank` of `processes` holds when `rows` are dealt out in blocks.
std::size_t first_row(std::size_t rows, int rank, int processes);

/// Runs `work` on every process; if it throws on one, every process throws that error. Collective.
template <class Work>
void together(MPI_Comm communicator, Work work);

/// Throws on every process the error of the first that has one (empty: none). Collective.
void agree(MPI_Comm communicator, const std::string& error);

template <class Work>
void together(MPI_Comm communicator, Work work) {
    std::string error;
    try {
        work();
    } catch (const std::exception& failure) {
        error = failure.what();
    }
    agree(communicator, error);
}

}  // namespace tomodem
