#include "core/packing/packing_file.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <thread>

#include "core/base/error.hpp"
#include "core/packing/run_file.hpp"
#include "tests/unit/file_size_limit.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::ThrowsMessage;

Packing sample(std::size_t count = 50) {
    Packing packing;
    packing.box = {{-1.0, 0.1, 1.0 / 3.0}, {10.0, 11.0, 12.0}, {true, false, true}};
    packing.seed_radius = 0.1;
    packing.relaxed = true;
    for (std::size_t i = 0; i < count; ++i) {
        const auto x = static_cast<double>(i);
        packing.position.emplace_back(x / 3.0, std::sqrt(x), -x);
        packing.species.push_back(static_cast<std::int32_t>(1 + i % 3));
        packing.id.push_back(static_cast<std::int64_t>(7'000'000'000 + 2 * i));
        packing.object.push_back(static_cast<std::int32_t>(i % 4));
    }
    return packing;
}

const Provenance provenance{
    "packgen", "0.1.0", "packgen --x 'é' out.h5", "seed_radius = 0.5\n", {{"a b.tif", "00ff"}, {"c.toml", "1234"}}};

void expect_equal(const Packing& a, const Packing& b) {
    EXPECT_EQ(a.box.origin, b.box.origin);
    EXPECT_EQ(a.box.edges, b.box.edges);
    EXPECT_EQ(a.box.periodic, b.box.periodic);
    EXPECT_EQ(a.seed_radius, b.seed_radius);
    EXPECT_EQ(a.relaxed, b.relaxed);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.species, b.species);
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.object, b.object);
    EXPECT_EQ(a.radius, b.radius);
}

class PackingFile : public InTemporaryFolder {
 protected:
    void write_run(std::size_t frames, std::size_t particles = 50) {
        const Packing packing = sample(particles);
        RunWriter writer(packing, folder / "run.h5", provenance);
        for (std::size_t f = 0; f < frames; ++f) {
            writer.add_frame(moved(packing, f));
            writer.add_observable("strain", "", 10 * static_cast<std::int64_t>(f), 0.5 * double(f), -0.1 * double(f));
            writer.add_observable("stress_true", "Pa", 10 * static_cast<std::int64_t>(f), 0.5 * double(f),
                                  1e6 * double(f));
        }
        writer.commit();
    }
    static Frame moved(const Packing& packing, std::size_t f) {
        Frame frame{10 * static_cast<std::int64_t>(f), 0.5 * double(f), packing.position};
        for (Vec3& p : frame.position) p.x() += double(f);
        return frame;
    }
};

TEST_F(PackingFile, GivesTheSamePackingAgain) {
    write_packing(sample(), folder / "a.h5", provenance);
    expect_equal(read_packing(folder / "a.h5"), sample());
    EXPECT_THAT(names(), ElementsAre("a.h5", "a.xdmf"));
}

TEST_F(PackingFile, WithoutObjectsReadsAsWithoutObjects) {
    Packing packing = sample();
    packing.object.clear();
    packing.relaxed = false;
    write_packing(packing, folder / "a.h5", provenance);
    expect_equal(read_packing(folder / "a.h5"), packing);
    EXPECT_THAT(content(folder / "a.xdmf"), Not(HasSubstr("object")));
}

TEST_F(PackingFile, KeepsTheRadiiOfItsParticles) {
    Packing packing = sample();
    for (std::size_t i = 0; i < packing.size(); ++i)
        packing.radius.push_back(0.1 + 1e-3 * std::sqrt(static_cast<double>(i)));
    write_packing(packing, folder / "a.h5", provenance);
    expect_equal(read_packing(folder / "a.h5"), packing);
    RunWriter run(packing, folder / "run.h5", provenance);
    run.add_frame(moved(packing, 0));
    run.add_frame(moved(packing, 1));
    run.commit();
    EXPECT_EQ(read_packing(folder / "run.h5", 1).radius, packing.radius);
}

TEST_F(PackingFile, KeepsItsProvenance) {
    write_packing(sample(), folder / "a.h5", provenance);
    const RunReader reader(folder / "a.h5");
    EXPECT_EQ(reader.provenance().tool, provenance.tool);
    EXPECT_EQ(reader.provenance().version, provenance.version);
    EXPECT_EQ(reader.provenance().command_line, provenance.command_line);
    EXPECT_EQ(reader.provenance().scene, provenance.scene);
    EXPECT_EQ(reader.provenance().inputs, provenance.inputs);
}

TEST_F(PackingFile, KeepsASceneAndCommandLineBeyond64KiB) {
    Provenance large{"solve", "1", std::string(100'000, 'c'), std::string(200'000, 's'), {}};
    write_packing(sample(), folder / "a.h5", large);
    const RunReader reader(folder / "a.h5");
    EXPECT_EQ(reader.provenance().scene, large.scene);
    EXPECT_EQ(reader.provenance().command_line, large.command_line);
    EXPECT_THAT(reader.provenance().inputs, IsEmpty());
}

TEST_F(PackingFile, OfTheSameInputHasTheSameBytes) {
    write_packing(sample(), folder / "a.h5", provenance);
    const std::string first = content(folder / "a.h5");
    write_packing(sample(), folder / "a.h5", provenance);
    EXPECT_TRUE(content(folder / "a.h5") == first);
}

TEST_F(PackingFile, OfManyChunksGivesTheSamePositionsAgain) {
    const Packing packing = sample(200'001);  // four unequal chunks
    write_packing(packing, folder / "a.h5", provenance);
    expect_equal(read_packing(folder / "a.h5"), packing);
}

TEST_F(PackingFile, OfARunGivesEveryFrameAndCurveAgain) {
    write_run(3);
    const RunReader reader(folder / "run.h5");
    ASSERT_EQ(reader.frame_count(), 3);
    expect_equal(reader.packing(), sample());
    for (std::size_t f = 0; f < 3; ++f) {
        const Frame expected = moved(sample(), f), frame = reader.frame(f);
        EXPECT_EQ(frame.position, expected.position);
        EXPECT_EQ(frame.step, expected.step);
        EXPECT_EQ(frame.time, expected.time);
        EXPECT_EQ(reader.frame_step(f), expected.step);
        EXPECT_EQ(reader.frame_time(f), expected.time);
    }
    ASSERT_EQ(reader.observables().size(), 2);
    const Observable& stress = reader.observable("stress_true");
    EXPECT_EQ(stress.unit, "Pa");
    EXPECT_THAT(stress.step, ElementsAre(0, 10, 20));
    EXPECT_THAT(stress.time, ElementsAre(0.0, 0.5, 1.0));
    EXPECT_THAT(stress.value, ElementsAre(0.0, 1e6, 2e6));
    EXPECT_EQ(reader.observable("strain").unit, "");
}

TEST_F(PackingFile, OfARunIsReadAtAnyFrame) {
    write_run(3);
    EXPECT_EQ(read_packing(folder / "run.h5", 1).position, moved(sample(), 1).position);
    EXPECT_EQ(read_packing(folder / "run.h5", -1).position, moved(sample(), 2).position);
    EXPECT_THAT([&] { read_packing(folder / "run.h5", 3); },
                ThrowsMessage<InvalidInput>(HasSubstr("it has frames 0 to 2")));
    EXPECT_THAT([&] { read_packing(folder / "run.h5", -2); }, ThrowsMessage<InvalidInput>(HasSubstr("no frame -2")));
}

TEST_F(PackingFile, IsReadBySeveralThreadsAtOnce) {
    write_run(4);
    const RunReader reader(folder / "run.h5");
    std::vector<std::thread> threads;
    std::vector<Frame> frames(4);
    for (std::size_t f = 0; f < 4; ++f)
        threads.emplace_back([&, f] {
            for (int repeat = 0; repeat < 20; ++repeat) frames[f] = reader.frame(f);
        });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(frames[f].position, moved(sample(), f).position);
}

TEST_F(PackingFile, NamesTheCurvesItHasWhenAskedForAnother) {
    write_run(2);
    EXPECT_THAT([&] { RunReader(folder / "run.h5").observable("section"); },
                ThrowsMessage<InvalidInput>(HasSubstr("it has no curve 'section', only strain, stress_true")));
    write_packing(sample(), folder / "a.h5", provenance);
    EXPECT_THAT([&] { RunReader(folder / "a.h5").observable("strain"); },
                ThrowsMessage<InvalidInput>(HasSubstr("give a run, not a sample")));
}

TEST_F(PackingFile, CutAnywhereIsOneClearError) {
    write_run(2);
    const std::string bytes = content(folder / "run.h5");
    for (std::size_t parts = 0; parts < 32; ++parts) {
        put(folder / "cut.h5", bytes.substr(0, parts * bytes.size() / 32));
        EXPECT_THAT([&] { RunReader{folder / "cut.h5"}; }, ThrowsMessage<InvalidInput>(StartsWith("cannot read '")))
            << parts;
    }
    put(folder / "cut.h5", bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(
        [&] { read_packing(folder / "cut.h5"); },
        ThrowsMessage<InvalidInput>("cannot read '" + (folder / "cut.h5").string() +
                                    "': the file is cut short: copy it again or repeat the command that wrote it"));
}

TEST_F(PackingFile, WithAnyBytesOverwrittenIsReadOrRefusedButNeverCrashes) {
    write_run(2);
    const std::string bytes = content(folder / "run.h5");
    std::size_t refused = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 61) {
        std::string bad = bytes;
        for (std::size_t i = at; i < std::min(at + 8, bad.size()); ++i) bad[i] = '\xff';
        put(folder / "bad.h5", bad);
        try {
            RunReader reader(folder / "bad.h5");
            reader.frame(1);
        } catch (const InvalidInput&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 20);
}

TEST_F(PackingFile, RejectsWhatIsNoPacking) {
    EXPECT_THAT([&] { read_packing(folder / "none.h5"); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no such file")));
    EXPECT_THAT([&] { read_packing(folder); }, ThrowsMessage<InvalidInput>(HasSubstr("it is a folder")));
    put(folder / "text.h5", std::string(5000, 'x'));
    EXPECT_THAT([&] { read_packing(folder / "text.h5"); }, ThrowsMessage<InvalidInput>(HasSubstr("not an HDF5 file")));
    put(folder / "empty.h5", "");
    EXPECT_THAT([&] { read_packing(folder / "empty.h5"); }, ThrowsMessage<InvalidInput>(HasSubstr("not an HDF5 file")));
}

TEST_F(PackingFile, OnAFullDiskLeavesTheOldFilesAndNothingElse) {
    write_run(1, 10);
    const std::string before = content(folder / "run.h5"), sidecar = content(folder / "run.xdmf");
    std::uintmax_t complete = 0;
    {
        write_packing(sample(20'000), folder / "size.h5", provenance);
        complete = std::filesystem::file_size(folder / "size.h5");
        std::filesystem::remove(folder / "size.h5");
        std::filesystem::remove(folder / "size.xdmf");
    }
    for (std::uintmax_t percent = 0; percent < 100; percent += 3) {
        const FileSizeLimit limit(complete * percent / 100);
        EXPECT_THAT([&] { write_packing(sample(20'000), folder / "run.h5", provenance); },
                    ThrowsMessage<InvalidInput>(StartsWith("cannot write '" + (folder / "run.h5").string() + "': ")))
            << percent;
        EXPECT_THAT(names(), ElementsAre("run.h5", "run.xdmf")) << percent;
    }
    EXPECT_TRUE(content(folder / "run.h5") == before);
    EXPECT_TRUE(content(folder / "run.xdmf") == sidecar);
    write_packing(sample(20'000), folder / "run.h5", provenance);  // HDF5 is still in order
    expect_equal(read_packing(folder / "run.h5"), sample(20'000));
}

TEST_F(PackingFile, OfARunThatIsNotCommittedDoesNotAppear) {
    {
        RunWriter writer(sample(), folder / "run.h5", provenance);
        writer.add_frame(moved(sample(), 0));
    }
    EXPECT_THAT(names(), IsEmpty());
}

TEST_F(PackingFile, OfARunThatIsStillWrittenShowsTheFramesAndPointsSoFar) {
    const std::filesystem::path path = folder / "run.h5.partial";
    const Packing packing = sample();
    const ParticleField velocity{"velocity", "mm s-1", 3};
    create_run_file(packing, {4, {velocity}, {{"strain", "", 7}}}, provenance, path, path);
    EXPECT_THAT([&] { RunReader{path}; }, ThrowsMessage<InvalidInput>(HasSubstr("first frame is not written yet")));
    RunFile file(path, path);
    for (std::size_t f = 0; f < 2; ++f) {
        const Frame frame = moved(packing, f);
        // In two blocks of rows, as two processes do.
        const std::span<const double> rows(frame.position.front().data(), 3 * packing.size());
        file.write_rows(position_field, f, 20, rows.subspan(60));
        file.write_rows(position_field, f, 0, rows.first(60));
        file.mark_frame(f, frame.step, frame.time);
    }
    for (std::size_t k = 0; k < 3; ++k)
        file.write_point("strain", k, 5 * static_cast<std::int64_t>(k), 0.5 * k, -0.1 * k);
    const RunReader run(path);
    EXPECT_EQ(run.frame_count(), 2u);
    EXPECT_EQ(run.frame(1).position, moved(packing, 1).position);
    EXPECT_EQ(run.observable("strain").value.size(), 3u);
    EXPECT_EQ(run.observable("strain").value.back(), -0.2);
}

TEST_F(PackingFile, OfARunWithoutFramesIsRefused) {
    RunWriter writer(sample(), folder / "run.h5", provenance);
    EXPECT_THAT([&] { writer.commit(); }, ThrowsMessage<InvalidInput>(HasSubstr("the run has no frame")));
}

TEST_F(PackingFile, OfFieldsHasTheChosenFramesOfTheRunAndTheNewFields) {
    write_run(4);
    const RunReader run(folder / "run.h5");
    const std::vector<ParticleField> fields{{"stress_local", "Pa", 6, {{"radius", 1.5}}}, {"d2min", "", 1}};
    const auto value_of = [](std::size_t frame, std::size_t place) { return 1000.0 * double(frame) + double(place); };
    {
        FieldWriter writer(run, {1, 3}, fields, folder / "fields.h5", provenance);
        for (const std::size_t f : {1u, 3u}) {
            std::vector<std::vector<double>> values{std::vector<double>(300), std::vector<double>(50)};
            for (std::size_t k = 0; k < 300; ++k) values[0][k] = value_of(f, k);
            for (std::size_t k = 0; k < 50; ++k) values[1][k] = -value_of(f, k);
            writer.add_frame(run.frame(f), values);
        }
        writer.commit();
    }
    const RunReader read(folder / "fields.h5");
    ASSERT_EQ(read.frame_count(), 2u);
    EXPECT_EQ(read.frame(1).position, run.frame(3).position);
    EXPECT_EQ(read.frame_time(0), run.frame_time(1));
    EXPECT_EQ(read.packing().species, run.packing().species);
    EXPECT_EQ(read.observable("strain").value, run.observable("strain").value);
    ASSERT_EQ(read.fields().size(), 2u);
    EXPECT_EQ(read.field("stress_local").unit, "Pa");
    EXPECT_EQ(read.field("stress_local").components, 6);
    EXPECT_THAT(read.field("stress_local").attributes, ElementsAre(std::pair<std::string, double>("radius", 1.5)));
    EXPECT_EQ(read.field_values("stress_local", 1)[299], value_of(3, 299));
    EXPECT_EQ(read.field_values("d2min", 0)[49], -value_of(1, 49));
    EXPECT_THAT([&] { read.field("stress"); },
                ThrowsMessage<InvalidInput>(HasSubstr("have no 'stress', only d2min, stress_local")));
    EXPECT_THAT([&] { run.field_values("stress", 0); },
                ThrowsMessage<InvalidInput>(HasSubstr("nor anything else but their positions")));
    EXPECT_THAT([&] { read.field_values("d2min", 2); }, ThrowsMessage<InvalidInput>(HasSubstr("no frame 2")));
}

TEST_F(PackingFile, RefusesPositionsThatAreNotFinite) {
    RunWriter writer(sample(), folder / "run.h5", provenance);
    Frame frame = moved(sample(), 2);
    frame.position[4].z() = std::numeric_limits<double>::infinity();
    EXPECT_THAT([&] { writer.add_frame(frame); },
                ThrowsMessage<InvalidInput>(
                    HasSubstr("frame 0 (step 20): the position of particle 5 (counted from 1) is not")));
}

TEST_F(PackingFile, RefusesAFrameOfAnotherSize) {
    RunWriter writer(sample(), folder / "run.h5", provenance);
    Frame frame = moved(sample(), 0);
    frame.position.pop_back();
    EXPECT_THAT([&] { writer.add_frame(frame); },
                ThrowsMessage<InvalidInput>(HasSubstr("49 positions for 50 particles")));
}

TEST_F(PackingFile, RefusesAnUnsoundPacking) {
    const auto refused = [&](auto change, const char* message) {
        Packing packing = sample();
        change(packing);
        EXPECT_THAT([&] { write_packing(packing, folder / "a.h5", provenance); },
                    ThrowsMessage<InvalidInput>(HasSubstr(message)));
    };
    refused([](Packing& p) { p = Packing{p.box, p.seed_radius, {}, {}, {}, {}, false, {}}; }, "there are no particles");
    refused([](Packing& p) { p.species.pop_back(); }, "49 species for 50 positions");
    refused([](Packing& p) { p.id.pop_back(); }, "49 ids for 50 positions");
    refused([](Packing& p) { p.object.pop_back(); }, "49 object numbers for 50 positions");
    refused([](Packing& p) { p.radius.assign(49, 0.1); }, "49 radii for 50 positions");
    for (const double radius : {0.0, -0.1, std::nan(""), HUGE_VAL})
        refused(
            [&](Packing& p) {
                p.radius.assign(50, 0.1);
                p.radius[7] = radius;
            },
            "the radius of particle 8 (counted from 1) is");
    refused([](Packing& p) { p.id[3] = p.id[2]; }, "ids are not unique and increasing");
    refused([](Packing& p) { std::swap(p.id[3], p.id[2]); }, "ids are not unique and increasing");
    refused([](Packing& p) { p.seed_radius = 0.0; }, "seed_radius 0 is not a positive length");
    refused([](Packing& p) { p.box.edges.y() = 0.0; }, "three positive edges");
    EXPECT_THAT(names(), IsEmpty());
}

TEST_F(PackingFile, RefusesTheNameOfItsSidecar) {
    EXPECT_THAT([&] { write_packing(sample(), folder / "a.xdmf", provenance); },
                ThrowsMessage<InvalidInput>(HasSubstr("name the HDF5 file")));
}

TEST(ValueAt, IsLinearBetweenPointsAndConstantBeyondTheEnds) {
    const Observable curve{"Pa", {0, 1, 2}, {0.0, 1.0, 3.0}, {5.0, 7.0, -1.0}};
    EXPECT_EQ(value_at(curve, -1.0), 5.0);
    EXPECT_EQ(value_at(curve, 0.0), 5.0);
    EXPECT_EQ(value_at(curve, 0.5), 6.0);
    EXPECT_EQ(value_at(curve, 1.0), 7.0);
    EXPECT_EQ(value_at(curve, 2.0), 3.0);
    EXPECT_EQ(value_at(curve, 9.0), -1.0);
    EXPECT_THAT([] { value_at({}, 0.0); }, ThrowsMessage<InvalidInput>(HasSubstr("without points")));
}

}  // namespace
}  // namespace tomodem
