#include "tools/metrics/fields/run_frames.hpp"

#include <algorithm>
#include <cmath>

#include "tools/metrics/curves/strain_curves.hpp"

namespace tomodem::fields {

RunFrames::RunFrames(const std::filesystem::path& file) : run_(file), labels_(run_.packing().species) {
    const std::string& scene = run_.provenance().scene;
    if (!scene.empty()) scene_ = parse_stored_scene(scene, file.string());
    std::sort(labels_.begin(), labels_.end());
    labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
}

std::optional<double> RunFrames::strain(std::size_t frame) const {
    if (run_.frame_count() > 1 && !run_.observables().contains("strain")) return std::nullopt;
    return curves::frame_strain(run_, frame);
}

Box RunFrames::box(std::size_t frame) const {
    Box box = run_.packing().box;
    if (!scene_) return box;
    for (int axis = 0; axis < 3; ++axis) box.periodic[axis] = scene_->lateral != Lateral::free && axis != scene_->axis;
    const auto section = run_.observables().find("section");
    if (scene_->lateral == Lateral::free || section == run_.observables().end()) return box;
    const int a = (scene_->axis + 1) % 3, b = (scene_->axis + 2) % 3;
    const double growth = std::sqrt(value_at(section->second, run_.frame_time(frame)) / (box.edges[a] * box.edges[b]));
    for (const int axis : {a, b}) {
        box.origin[axis] += 0.5 * (1.0 - growth) * box.edges[axis];
        box.edges[axis] *= growth;
    }
    return box;
}

Packing RunFrames::at(const Frame& positions, std::size_t frame) const {
    Packing packing = run_.packing();
    packing.position = positions.position;
    packing.box = box(frame);
    return packing;
}

std::string RunFrames::phase_name(std::int32_t label) const {
    if (scene_)
        for (const Phase& phase : scene_->phases)
            if (phase.label == label) return phase.name;
    return {};
}

std::vector<std::string> RunFrames::columns(const std::vector<std::string>& more) {
    std::vector<std::string> all{"frame [-]", "time [s]", "strain [-]", "abs_strain [-]"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

std::vector<Table::Cell> RunFrames::row(std::size_t frame, const std::vector<Table::Cell>& more) const {
    std::vector<Table::Cell> cells{std::int64_t(frame), run_.frame_time(frame), {}, {}};
    if (const std::optional<double> at = strain(frame)) {
        cells[2] = *at;
        cells[3] = std::abs(*at);
    }
    cells.insert(cells.end(), more.begin(), more.end());
    return cells;
}

Table::Cell label_cell(std::optional<std::int32_t> label) {
    if (label) return std::int64_t(*label);
    return {};
}

Provenance provenance_of_fields(const RunReader& run, Provenance provenance) {
    provenance.scene = run.provenance().scene;
    return provenance;
}

}  // namespace tomodem::fields
