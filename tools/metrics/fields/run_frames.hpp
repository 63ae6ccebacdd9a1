#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/table.hpp"
#include "core/packing/packing_file.hpp"
#include "core/scene/scene.hpp"

namespace tomodem::fields {

/// A run or sample and its scene, as measures of its particles need them frame by frame.
class RunFrames {
 public:
    /// @throws InvalidInput if the file is no run or sample
    explicit RunFrames(const std::filesystem::path& file);

    const RunReader& run() const { return run_; }
    const Packing& packing() const { return run_.packing(); }
    /// The scene that the file was made with, if with any.
    const std::optional<Scene>& scene() const { return scene_; }
    /// Of the load; z where there was no scene.
    int axis() const { return scene_ ? scene_->axis : 2; }
    /// True strain at a frame, where the run has the curve; 0 of a file of one frame.
    std::optional<double> strain(std::size_t frame) const;
    /// The box at a frame. The file of a run holds the box of its sample, without periodic sides; across the load the
    /// sides are free, or periodic with edges that follow the section, as the scene says.
    Box box(std::size_t frame) const;
    /// The packing at a frame.
    Packing at(const Frame& positions, std::size_t frame) const;
    /// Labels of the particles, increasing.
    const std::vector<std::int32_t>& labels() const { return labels_; }
    /// Name of a phase in the scene; empty where there is none.
    std::string phase_name(std::int32_t label) const;

    /// The first columns of every table: frame, time, strain and its absolute value.
    static std::vector<std::string> columns(const std::vector<std::string>& more);
    std::vector<Table::Cell> row(std::size_t frame, const std::vector<Table::Cell>& more) const;

 private:
    RunReader run_;
    std::optional<Scene> scene_;
    std::vector<std::int32_t> labels_;
};

/// A label in a table; empty for all particles.
Table::Cell label_cell(std::optional<std::int32_t> label);

/// Provenance of a field file: that of the running tool, with the scene of the run.
Provenance provenance_of_fields(const RunReader& run, Provenance provenance);

}  // namespace tomodem::fields
