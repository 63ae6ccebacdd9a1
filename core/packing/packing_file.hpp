#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/packing/packing.hpp"

/// Packings and runs as H5MD 1.1 files (https://h5md.nongnu.org): docs/file-formats.md.
namespace tomodem {

/// Positions at one moment, in the order of the packing's ids.
struct Frame {
    std::int64_t step = 0;
    double time = 0.0;  ///< s
    std::vector<Vec3> position;
};

/// A macroscopic curve; the three arrays have the same length.
struct Observable {
    std::string unit;
    std::vector<std::int64_t> step;
    std::vector<double> time;  ///< s
    std::vector<double> value;
};

/// Reads a sample, a brick, or one frame of a run.
/// @param frame  counted from 0; -1 is the last
/// @throws InvalidInput if the file is not there, is cut, is not H5MD, or its arrays do not fit together
Packing read_packing(const std::filesystem::path& path, std::int64_t frame = 0);

/// Reads a sample to be pressed or relaxed: a file of one frame.
/// @throws InvalidInput as read_packing, and for a run: its section and strain would be forgotten
Packing read_sample(const std::filesystem::path& path);

/// Writes a file of one frame (atomically), and NAME.xdmf beside it for ParaView.
void write_packing(const Packing& packing, const std::filesystem::path& path, const Provenance& provenance);

/// Frames and curves of a run, read on demand.
class RunReader {
 public:
    /// @throws InvalidInput as read_packing
    explicit RunReader(const std::filesystem::path& path);
    ~RunReader();
    RunReader(const RunReader&) = delete;
    RunReader& operator=(const RunReader&) = delete;

    /// Labels, ids, objects, box; positions of the first frame.
    const Packing& packing() const;
    std::size_t frame_count() const;
    /// Step and time of all frames without their positions.
    std::int64_t frame_step(std::size_t index) const;
    double frame_time(std::size_t index) const;
    Frame frame(std::size_t index) const;
    /// Quantities of each particle in each frame, besides the position; by name.
    const std::vector<ParticleField>& fields() const;
    /// @throws InvalidInput naming the file, the field, and which there are, if it is not there
    const ParticleField& field(const std::string& name) const;
    /// Values of a field in one frame: particles x components, row by row; not a number where the run has none.
    std::vector<double> field_values(const std::string& name, std::size_t index) const;
    /// All curves under /observables; empty for a sample.
    const std::map<std::string, Observable>& observables() const;
    /// @throws InvalidInput naming the file and the curve if it is not there
    const Observable& observable(const std::string& name) const;
    const Provenance& provenance() const;

 private:
    void require_frame(std::size_t index) const;
    struct State;
    std::unique_ptr<State> state_;
};

/// Writes what a tool computed of the particles of a run, frame by frame, as a run file of its own: the positions,
/// labels, objects and curves of the run and the new fields. The file (and its .xdmf) appears at commit().
class FieldWriter {
 public:
    /// @param frames  of the run, increasing
    FieldWriter(const RunReader& run, const std::vector<std::size_t>& frames, std::vector<ParticleField> fields,
                const std::filesystem::path& path, const Provenance& provenance);
    ~FieldWriter();
    FieldWriter(const FieldWriter&) = delete;
    FieldWriter& operator=(const FieldWriter&) = delete;

    /// The next of the frames; values as RunReader::field_values gives them, in the order of the fields.
    void add_frame(const Frame& frame, const std::vector<std::vector<double>>& values);
    void commit();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Value of `curve` at `time`, linear between its points, constant beyond its ends.
double value_at(const Observable& curve, double time);

/// Writes a small run, collected in memory; the file (and its .xdmf) appears at commit(). The solver fills a RunFile.
class RunWriter {
 public:
    RunWriter(const Packing& packing, const std::filesystem::path& path, const Provenance& provenance);
    ~RunWriter();
    RunWriter(const RunWriter&) = delete;
    RunWriter& operator=(const RunWriter&) = delete;

    void add_frame(const Frame& frame);
    /// Appends one point to the named curve; its unit is fixed by the first call.
    void add_observable(const std::string& name, const std::string& unit, std::int64_t step, double time, double value);
    void commit();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem
