#include "tools/vol2pack/phase_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/error.hpp"

namespace tomodem::vol2pack {
namespace {

std::string labels_of(const std::map<std::int32_t, std::int64_t>& image) {
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : image) labels.push_back(label);
    constexpr std::size_t shown = 12;
    const std::size_t count = labels.size();
    labels.resize(std::min(count, shown));
    return fmt::format("{}{}", fmt::join(labels, ", "), count > shown ? fmt::format(" ... ({} labels)", count) : "");
}

std::string described(const Phase& phase) {
    return phase.name.empty() ? fmt::format("label {}", phase.label)
                              : fmt::format("label {} ({})", phase.label, phase.name);
}

}  // namespace

void check_labels(const std::map<std::int32_t, std::int64_t>& image, const std::map<std::int32_t, std::string>& names,
                  const std::vector<std::int32_t>& object_labels) {
    if (!image.empty() && image.begin()->first < 0)
        throw InvalidInput(fmt::format("the image has the negative label {}; rename it with --relabel {}=1",
                                       image.begin()->first, image.begin()->first));
    if (const auto zero = names.find(0); zero != names.end() && zero->second != "void")
        throw InvalidInput(
            fmt::format("label 0 is void, it cannot be '{}'; give it another number with --relabel", zero->second));
    if (!names.empty()) {
        for (const auto& [label, voxels] : image)
            if (label != 0 && !names.contains(label))
                throw InvalidInput(
                    fmt::format("the image has label {} ({} voxels), which --labels does not name; name it, "
                                "or join it to another with --relabel (the image's labels: {})",
                                label, voxels, labels_of(image)));
        for (const auto& [label, name] : names)
            if (label != 0 && !image.contains(label))
                throw InvalidInput(
                    fmt::format("--labels names label {} ({}), which the image does not have (its labels: "
                                "{})",
                                label, name, labels_of(image)));
    }
    for (const std::int32_t label : object_labels) {
        if (label == 0) throw InvalidInput("--objects: label 0 is void and has no particles");
        if (!image.contains(label))
            throw InvalidInput(
                fmt::format("--objects: the image does not have label {} (its labels: {})", label, labels_of(image)));
    }
}

std::vector<Phase> compare_phases(const std::map<std::int32_t, std::int64_t>& image,
                                  const std::map<std::int32_t, std::int64_t>& used, const Sample& sample,
                                  const std::map<std::int32_t, std::string>& names) {
    const auto count = [](const std::map<std::int32_t, std::int64_t>& counts, std::int32_t label) {
        const auto found = counts.find(label);
        return found == counts.end() ? std::int64_t{0} : found->second;
    };
    std::int64_t voxels = 0;
    for (const auto& [label, of_label] : image) voxels += of_label;
    std::vector<Phase> phases;
    std::map<std::int32_t, std::int64_t> all = image;
    all.emplace(0, 0);
    for (const auto& [label, of_label] : all) {
        Phase phase;
        phase.label = label;
        if (const auto name = names.find(label); name != names.end()) phase.name = name->second;
        if (label == 0) phase.name = "void";
        phase.voxels = of_label;
        phase.voxels_used = count(used, label);
        phase.particles = count(sample.labelled, label);
        phase.image_fraction = static_cast<double>(of_label) / static_cast<double>(voxels);
        phase.sample_fraction = static_cast<double>(phase.particles) / static_cast<double>(sample.candidates);
        phases.push_back(phase);
    }
    return phases;
}

void check_phases(const std::vector<Phase>& phases) {
    for (const Phase& phase : phases)
        if (phase.label != 0 && phase.voxels_used > 0 && phase.particles == 0)
            throw InvalidInput(
                fmt::format("{} has {} voxels but no particle; use fewer --pixels-per-seed, or leave the "
                            "label out with --relabel {}=0 or --min-component",
                            described(phase), phase.voxels_used, phase.label));
}

void report_phases(const std::vector<Phase>& phases, Reporter& reporter) {
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    for (const Phase& phase : phases) {
        const std::string key = phase.label == 0 ? "void" : fmt::format("label_{}", phase.label);
        if (phase.label != 0) reporter.report("particles_" + key, phase.particles);
        reporter.report("sample_fraction_" + key, 100 * phase.sample_fraction, "%");
        reporter.report("image_fraction_" + key, 100 * phase.image_fraction, "%");
        reporter.report("difference_" + key, phase.difference(), "points");
        table.push_back({{"label", phase.label},
                         {"name", phase.name},
                         {"voxels", phase.voxels},
                         {"voxels_used", phase.voxels_used},
                         {"particles", phase.particles},
                         {"image_fraction", phase.image_fraction},
                         {"sample_fraction", phase.sample_fraction}});
    }
    reporter.report_json("phases", table);
}

void report_objects(const Sample& sample, Reporter& reporter) {
    reporter.report("objects", static_cast<std::int64_t>(sample.object_particles.size()));
    reporter.report("objects_lost", sample.lost_components());
    if (!sample.object_particles.empty())
        reporter.report("smallest_object",
                        *std::min_element(sample.object_particles.begin(), sample.object_particles.end()), "particles");
    reporter.report_json("object_numbers", sample.object_number);
    reporter.report_json("object_particles", sample.object_particles);
    if (sample.lost_components() > 0)
        reporter.warn(
            fmt::format("{} of {} objects of the image are too small to hold a particle and are not in the sample; use "
                        "fewer --pixels-per-seed, or remove them with --min-component",
                        sample.lost_components(), sample.components));
}

}  // namespace tomodem::vol2pack
