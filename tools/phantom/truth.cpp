#include "tools/phantom/truth.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/output_file.hpp"

namespace tomodem::phantom {
namespace {

std::vector<double> numbers(const Vec3& vector) {
    return {vector[0], vector[1], vector[2]};
}

}  // namespace

nlohmann::ordered_json truth_of(const LabelVolume& volume, const Provenance& provenance, std::int64_t random_seed,
                                const std::map<std::int32_t, std::string>& names,
                                const std::map<std::int32_t, double>& fractions) {
    nlohmann::ordered_json truth;
    truth["tool"] = provenance.tool;
    truth["version"] = provenance.version;
    truth["command_line"] = provenance.command_line;
    truth["random_seed"] = random_seed;
    truth["size_voxels"] = volume.size();
    truth["voxel_size_mm"] = volume.spacing()[0];
    truth["origin_mm"] = numbers(volume.origin());
    const VoxelIndex size = volume.size();
    const double all = static_cast<double>(size[0]) * size[1] * size[2];
    for (const auto& [label, voxels] : volume.histogram()) {
        nlohmann::ordered_json entry{{"label", label},
                                     {"name", names.at(label)},
                                     {"voxels", voxels},
                                     {"voxel_fraction", static_cast<double>(voxels) / all}};
        if (const auto fraction = fractions.find(label); fraction != fractions.end())
            entry["analytic_fraction"] = fraction->second;
        truth["labels"].push_back(entry);
    }
    return truth;
}

nlohmann::ordered_json grains_truth(const std::vector<Grain>& grains, const std::vector<std::int64_t>& voxels,
                                    std::int32_t label, double voxel_size) {
    nlohmann::ordered_json objects = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < grains.size(); ++i) {
        const double volume = grain_volume(grains[i]);
        const Vec3 centre = grain_centre(grains[i]);
        const double radius = std::cbrt(volume * 3 / (4 * std::numbers::pi));
        nlohmann::ordered_json object{{"number", i + 1},
                                      {"label", label},
                                      {"centre_mm", numbers(centre)},
                                      {"centre_voxels", numbers(centre / voxel_size)},
                                      {"radius_mm", radius},
                                      {"radius_voxels", radius / voxel_size},
                                      {"volume_mm3", volume},
                                      {"volume_voxels", volume / (voxel_size * voxel_size * voxel_size)},
                                      {"voxels", voxels[i]}};
        for (const Sphere& sphere : grains[i].spheres)
            object["spheres"].push_back({{"centre_mm", numbers(sphere.centre)}, {"radius_mm", sphere.radius}});
        objects.push_back(object);
    }
    return objects;
}

std::filesystem::path truth_path(const std::filesystem::path& volume, const std::filesystem::path& wanted) {
    return wanted.empty() ? std::filesystem::path(volume).replace_extension(".json") : wanted;
}

void write_phantom(const LabelVolume& volume, const std::filesystem::path& path, const nlohmann::ordered_json& truth,
                   const std::filesystem::path& truth_path, Reporter& reporter) {
    for (const auto& label : truth["labels"])
        reporter.report("fraction_label_" + label["label"].dump(), 100 * label["voxel_fraction"].get<double>(), "%");
    // The truth comes first: Make takes the volume as the target, and its truth is then there.
    write_text(truth_path, truth.dump(2) + "\n");
    write_label_volume(volume, path, reporter);
}

}  // namespace tomodem::phantom
