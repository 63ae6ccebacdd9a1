#include "tools/packgen/brick_cache.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <exception>

#include "core/base/output_file.hpp"
#include "core/base/sha256.hpp"
#include "core/packing/packing_file.hpp"
#include "core/packing/run_file.hpp"

namespace tomodem::packgen {
namespace fs = std::filesystem;
namespace {

/// Everything that determines the particles.
std::string key(const Compaction& wanted) {
    std::string periodic;
    for (int axis = 0; axis < 3; ++axis)
        if (wanted.periodic[axis]) periodic += "xyz"[axis];
    return fmt::format(
        "version {} particles {} density {:a} seed_radius {:a} dispersion {:a} aspect {:a}:{:a}:{:a} periodic {} "
        "random_seed {} rate {:a} max_residual {:a} max_steps {}",
        algorithm_version, wanted.particles, wanted.density, wanted.seed_radius, wanted.dispersion, wanted.aspect[0],
        wanted.aspect[1], wanted.aspect[2], periodic, wanted.random_seed, wanted.rate, wanted.max_residual,
        wanted.max_steps);
}

constexpr const char* checksum_name = "particles";
constexpr const char* steps_name = "steps";
constexpr const char* residual_name = "residual";
constexpr const char* load_name = "load";

std::string checksum(const CompactedPacking& made) {
    const Packing& packing = made.packing;
    Sha256 digest;
    digest.add_all(packing.position);
    digest.add_all(packing.radius);
    digest.add_all(packing.id);
    digest.add_all(packing.species);
    const std::array<double, 12> rest{
        packing.box.origin.x(),
        packing.box.origin.y(),
        packing.box.origin.z(),
        packing.box.edges.x(),
        packing.box.edges.y(),
        packing.box.edges.z(),
        packing.seed_radius,
        made.residual,
        made.load,
        static_cast<double>(made.steps),
        static_cast<double>(packing.box.periodic[0] + 2 * packing.box.periodic[1] + 4 * packing.box.periodic[2]),
        static_cast<double>(packing.relaxed)};
    digest.add_all(rest);
    return digest.hexadecimal();
}

}  // namespace

fs::path BrickCache::users_folder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "tomodem" / "packgen";
    const char* home = std::getenv("HOME");
    if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "tomodem" / "packgen";
    return {};
}

fs::path BrickCache::path_of(const Compaction& wanted) const {
    Sha256 digest;
    digest.add_all(key(wanted));
    return folder_ / (digest.hexadecimal() + ".h5");
}

std::optional<CompactedPacking> BrickCache::find(const Compaction& wanted) const {
    if (folder_.empty()) return std::nullopt;
    try {
        const fs::path path = path_of(wanted);
        if (!fs::is_regular_file(path)) return std::nullopt;
        const RunReader reader(path);
        CompactedPacking made;
        made.packing = reader.packing();
        made.steps = static_cast<std::int64_t>(reader.observable(steps_name).value.at(0));
        made.residual = reader.observable(residual_name).value.at(0);
        made.load = reader.observable(load_name).value.at(0);
        const Provenance& provenance = reader.provenance();
        const auto kept = provenance.inputs.find(checksum_name);
        if (provenance.command_line != key(wanted) || kept == provenance.inputs.end() || kept->second != checksum(made))
            return std::nullopt;
        return made;
    } catch (const std::exception&) {  // whatever is wrong with it, a new one is made
        return std::nullopt;
    }
}

bool BrickCache::keep(const Compaction& wanted, const CompactedPacking& made) const {
    if (folder_.empty()) return false;
    try {
        fs::create_directories(folder_);
        const fs::path path = path_of(wanted);
        OutputFile output(path);
        const Provenance provenance{
            "packgen", fmt::format("{}", algorithm_version), key(wanted), {}, {{checksum_name, checksum(made)}}};
        const std::pair<const char*, double> numbers[] = {
            {steps_name, static_cast<double>(made.steps)}, {residual_name, made.residual}, {load_name, made.load}};
        RunShape shape;
        for (const auto& [name, value] : numbers) shape.curves.push_back({name, "", 1});
        create_run_file(made.packing, shape, provenance, output.path(), path);
        RunFile file(output.path(), path);
        file.write_rows(position_field, 0, 0, {made.packing.position.front().data(), 3 * made.packing.size()});
        file.mark_frame(0, 0, 0.0);
        for (const auto& [name, value] : numbers) file.write_point(name, 0, 0, 0.0, value);
        file.close();
        output.commit();
        return true;
    } catch (const std::exception&) {  // no room, no permission: the brick itself is made
        return false;
    }
}

}  // namespace tomodem::packgen
