// synthetic_fields FILE.h5 [key=value ...]: a run whose particles' contacts, order, strain and stress are known.
//
// A block of cells of a lattice (lattice = 0 simple cubic, 1 fcc, 2 bcc; nearest distance 0.98 diameters) that is
// turned by `turn` radians about z and compressed uniformly, by true strains of -strain along z and half of that
// across. Labels 1 and 2 in turns of layers along x if phases=2. `stress` [MPa] along z, with a shear of `shear` MPa
// whose sign changes from particle to particle. scene=0, curves=0, field=0 leave things out; periodic=1 is a brick in
// one frame.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>

#include "core/packing/packing_file.hpp"

using namespace tomodem;

namespace {

const char* const scene_text = R"(seed_radius = 0.5
[phase.matrix]
label = 1
law = "bilin"
repulsive_stiffness = 5e9
natural_period = 0.1
)";
const char* const second_phase = R"([phase.inclusion]
label = 2
law = "bilin"
repulsive_stiffness = 5e9
natural_period = 0.1
)";
const char* const load_text = R"([load]
axis = "z"
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]
time_step = 5e-4
)";

std::vector<Vec3> places(int lattice) {
    if (lattice == 0) return {Vec3(0, 0, 0)};
    if (lattice == 1) return {Vec3(0, 0, 0), Vec3(.5, .5, 0), Vec3(.5, 0, .5), Vec3(0, .5, .5)};
    return {Vec3(0, 0, 0), Vec3(.5, .5, .5)};
}

}  // namespace

int main(int argc, char** argv) {
    std::map<std::string, double> value{{"cells", 6},     {"lattice", 1}, {"frames", 3},    {"strain", 0.3},
                                        {"turn", 0},      {"phases", 1},  {"stress", -100}, {"shear", 0},
                                        {"scene", 1},     {"curves", 1},  {"field", 1},     {"periodic", 0},
                                        {"particles", 0}, {"kinetic", 1}, {"imbalance", 0}};
    if (argc < 2) return 2;
    for (int i = 2; i < argc; ++i) {
        const std::string word = argv[i];
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || !value.contains(word.substr(0, equals))) {
            std::fprintf(stderr, "synthetic_fields: what is '%s'?\n", argv[i]);
            return 2;
        }
        value[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
    }
    const int cells = int(value["cells"]), frames = int(value["frames"]), kind = int(value["lattice"]);
    constexpr double nearest[] = {1.0, std::numbers::sqrt2, 2.0 / std::numbers::sqrt3};
    const double edge = 0.98 * nearest[kind];

    Packing packing;
    packing.seed_radius = 0.5;
    packing.box = {Vec3::Constant(-0.2), Vec3::Constant(edge * cells), {false, false, false}};
    if (value["periodic"] > 0) packing.box.periodic = {true, true, true};
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j)
            for (int k = 0; k < cells; ++k)
                for (const Vec3& place : places(kind)) {
                    packing.position.push_back(edge * (Vec3(i, j, k) + place));
                    packing.species.push_back(value["phases"] > 1 ? 1 + i % 2 : 1);
                }
    if (value["particles"] > 0) {
        packing.position.resize(std::size_t(value["particles"]));
        packing.species.resize(packing.position.size());
    }
    for (std::size_t i = 0; i < packing.size(); ++i) packing.id.push_back(std::int64_t(i) + 1);

    const std::string scene =
        value["scene"] > 0 ? std::string(scene_text) + (value["phases"] > 1 ? second_phase : "") + load_text : "";
    const Provenance provenance{"solve", "0", "", scene, {}, {}};
    const std::filesystem::path output = argv[1];
    const std::filesystem::path bare = value["field"] > 0 ? std::filesystem::path(output).concat(".bare.h5") : output;
    RunWriter writer(packing, bare, provenance);
    for (int f = 0; f < frames; ++f) {
        const double share = frames > 1 ? double(f) / (frames - 1) : 0.0, strain = -value["strain"] * share;
        const double angle = value["turn"] * share;
        const Vec3 stretch(std::exp(-0.5 * strain), std::exp(-0.5 * strain), std::exp(strain));
        Eigen::Matrix3d turn;
        turn << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
        Frame frame{600000L * f, 300.0 * share, {}};
        for (const Vec3& p : packing.position) frame.position.push_back(turn * p.cwiseProduct(stretch));
        writer.add_frame(frame);
    }
    if (value["curves"] > 0)
        for (int i = 0; i <= 300; ++i) {
            const auto add = [&](const char* name, const char* unit, double number) {
                writer.add_observable(name, unit, 2000L * i, i, number);
            };
            add("strain", "", -value["strain"] * i / 300.0);
            add("stress_true", "Pa", i > 0 ? 1e6 * value["stress"] : 0.0);
            add("kinetic_energy", "nJ", value["kinetic"] * 64.0);
            add("potential_energy", "nJ", 32000.0);
            add("equilibrium_error", "", value["imbalance"]);
        }
    writer.commit();
    if (bare == output) return 0;

    {
        const RunReader run(bare);
        std::vector<std::size_t> all;
        for (std::size_t f = 0; f < run.frame_count(); ++f) all.push_back(f);
        FieldWriter fields(run, all, {{"stress", "Pa", 6, {{"volume", 0.7}}}}, output, provenance);
        for (const std::size_t f : all) {
            std::vector<double> stress;
            for (std::size_t i = 0; i < packing.size(); ++i) {
                const double shear = 1e6 * value["shear"] * (std::sin(double(i)) > 0 ? 1.0 : -1.0);
                for (const double s : {0.0, 0.0, 1e6 * value["stress"], 0.0, shear, 0.0})
                    stress.push_back(f == 0 ? std::nan("") : s);
            }
            fields.add_frame(run.frame(f), {stress});
        }
        fields.commit();
    }
    std::filesystem::remove(bare);
    std::filesystem::remove(std::filesystem::path(bare).replace_extension(".xdmf"));
    return 0;
}
