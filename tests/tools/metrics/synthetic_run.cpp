// synthetic_run FILE.h5 [key=value ...]: a compression whose measures are known beforehand.
//
// sigma = -K rate^M MPa plus slope * strain MPa; the sample is a lattice of edge `cells`, `objects=1` adds a sphere of
// 5 mm radius (object 1), one at a face (object 2) and one of 8 particles (object 3).
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "tests/unit/metrics/synthetic_run.hpp"

using namespace tomodem;

int main(int argc, char** argv) {
    std::map<std::string, double> value{{"rate", 1e-3},  {"strain", 0.35}, {"K", 100.0},
                                        {"M", 0.0},      {"slope", 0.0},   {"equilibrium_error", 0.0},
                                        {"cells", 6},    {"frames", 4},    {"volume_factor", 1.0},
                                        {"objects", 0.0}};
    for (int i = 2; i < argc; ++i) {
        const std::string word = argv[i];
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || !value.contains(word.substr(0, equals))) {
            std::fprintf(stderr, "synthetic_run: what is '%s'?\n", argv[i]);
            return 2;
        }
        value[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
    }
    if (argc < 2) return 2;

    Packing packing = synthetic::sample(synthetic::cube(int(value["cells"]), 1.0));
    if (value["objects"] > 0.0) {
        const double middle = 0.5 * value["cells"];
        synthetic::add_object(packing, synthetic::ellipsoid({4, 4, 4}, 0.5, {middle, middle, middle + 1}), 1);
        synthetic::add_object(packing, synthetic::ellipsoid({2, 2, 1}, 0.5, {middle, middle, 1.5}), 2);
        synthetic::add_object(packing, synthetic::cube(1, 0.5, {2, 2, middle}), 3);
    }
    const double stress = -1e6 * value["K"] * std::pow(value["rate"], value["M"]), slope = 1e6 * value["slope"];
    synthetic::write_run(packing, argv[1],
                         {.rate = value["rate"],
                          .strain = value["strain"],
                          .points = 701,
                          .frames = int(value["frames"]),
                          .stress_true = [&](double strain) { return stress + slope * strain; },
                          .equilibrium_error = value["equilibrium_error"],
                          .volume_factor = value["volume_factor"]});
    return 0;
}
