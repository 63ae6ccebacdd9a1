// write_sample_run PARTICLES FRAMES OUTPUT [FIELDS]: a file with known numbers for the tests of this folder, and one
// with fields.
#include <cmath>
#include <cstdio>
#include <string>

#include "core/base/error.hpp"
#include "core/packing/packing_file.hpp"

int main(int argc, char** argv) {
    using namespace tomodem;
    if (argc != 4 && argc != 5) return 2;
    const long particles = std::stol(argv[1]), frames = std::stol(argv[2]);
    try {
        Packing packing;
        packing.box = {{-1.0, 0.5, 0.25}, {10.0, 12.0, 14.0}, {true, true, false}};
        packing.seed_radius = 0.5;
        packing.relaxed = true;
        for (long i = 0; i < particles; ++i) {
            packing.position.emplace_back(0.1 * i, std::sqrt(double(i)), -1.0 / (i + 1.0));
            packing.species.push_back(1 + i % 2);
            packing.id.push_back(10 + 3 * i);
            packing.object.push_back(i % 5);
        }
        RunWriter run(packing, argv[3],
                      {"write_sample_run",
                       "1.2.3",
                       "write_sample_run a b",
                       "seed_radius = 0.5\n",
                       {{"a b.tif", "00ff"}, {"c.toml", "11"}}});
        for (long f = 0; f < frames; ++f) {
            Frame frame{100 * f, 0.5 * f, packing.position};
            for (Vec3& p : frame.position) p.z() -= double(f);
            run.add_frame(frame);
            run.add_observable("strain", "", 100 * f, 0.5 * f, -0.01 * f);
            run.add_observable("stress_true", "Pa", 100 * f, 0.5 * f, -1e6 * f);
        }
        run.commit();
        if (argc == 4) return 0;

        const RunReader written(argv[3]);
        std::vector<std::size_t> all;
        for (std::size_t f = 0; f < written.frame_count(); ++f) all.push_back(f);
        FieldWriter fields(written, all, {{"pressure", "Pa", 1}, {"velocity", "mm/s", 3}, {"stress", "Pa", 6}}, argv[4],
                           {"write_sample_run", "1.2.3", "write_sample_run a b", "", {}});
        for (const std::size_t f : all) {
            std::vector<std::vector<double>> values;
            for (const std::size_t components : {1, 3, 6}) {
                auto& numbers = values.emplace_back();
                for (std::size_t k = 0; k < components * written.packing().size(); ++k)
                    numbers.push_back(100.0 * double(components) + 10.0 * double(f) + 0.25 * double(k));
            }
            fields.add_frame(written.frame(f), values);
        }
        fields.commit();
    } catch (const InvalidInput& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
