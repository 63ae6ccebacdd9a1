#include "solver_plugin/simulation/checkpoint.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class CheckpointFile : public InTemporaryFolder {
 protected:
    static Checkpoint sample() {
        Checkpoint checkpoint;
        checkpoint.particles.tag = {3, 1, 2};
        checkpoint.particles.type = {1, 2, 1};
        checkpoint.particles.image = {7, -8, 9};
        checkpoint.particles.position = {0.1, 1.0 / 3, -2e-300, 4, 5, 6, 7, 8, 9};
        checkpoint.particles.velocity = {-0.0, 1, 2, 3, 4, 5, 6, 7, 8};
        checkpoint.particles.memory_length = {0, 3, 1};
        checkpoint.particles.memory = {-5, 7, INT64_MAX, 11};
        checkpoint.sums = {0, 2, {1, 2, 3, 4, 5, 6}};
        checkpoint.numbers = {{"next_point", {12}}, {"window", {1, 2, 3}}, {"empty", {}}};
        return checkpoint;
    }
    const Inputs inputs{"0.1", "seed_radius = 0.5", "00ff 11"};
};

TEST_F(CheckpointFile, GivesTheSameStateAgainBitByBit) {
    write_checkpoint(sample(), inputs, folder / "a", MPI_COMM_WORLD);
    const FoundCheckpoint found = read_checkpoint(folder / "a", inputs, MPI_COMM_WORLD);
    const ParticleState &read = found.checkpoint.particles, written = sample().particles;
    EXPECT_TRUE(found.same_processes);
    EXPECT_EQ(read.tag, written.tag);
    EXPECT_EQ(read.type, written.type);
    EXPECT_EQ(read.image, written.image);
    EXPECT_EQ(read.position, written.position);
    EXPECT_EQ(read.velocity, written.velocity);
    EXPECT_TRUE(std::signbit(read.velocity.front()));
    EXPECT_EQ(read.memory_length, written.memory_length);
    EXPECT_EQ(read.memory, written.memory);
    EXPECT_EQ(found.checkpoint.sums.values, sample().sums.values);
    EXPECT_EQ(found.checkpoint.numbers, sample().numbers);
}

TEST_F(CheckpointFile, OfParticlesWithoutMemoryOrSumsIsFine) {
    Checkpoint checkpoint = sample();
    checkpoint.particles.memory_length.assign(3, 0);
    checkpoint.particles.memory.clear();
    checkpoint.sums = {};
    write_checkpoint(checkpoint, inputs, folder / "a", MPI_COMM_WORLD);
    const FoundCheckpoint found = read_checkpoint(folder / "a", inputs, MPI_COMM_WORLD);
    EXPECT_EQ(found.checkpoint.particles.tag, checkpoint.particles.tag);
    EXPECT_EQ(found.checkpoint.sums.components, 0);
}

TEST_F(CheckpointFile, OfOtherInputsIsRefused) {
    write_checkpoint(sample(), inputs, folder / "a", MPI_COMM_WORLD);
    const auto refused = [&](const Inputs& other, const char* message) {
        EXPECT_THAT([&] { read_checkpoint(folder / "a", other, MPI_COMM_WORLD); },
                    ThrowsMessage<InvalidInput>(HasSubstr(message)));
    };
    refused({"0.2", inputs.scene, inputs.digests}, "another version of tomodem (0.1, this is 0.2)");
    refused({inputs.version, "seed_radius = 0.6", inputs.digests}, "another scene");
    refused({inputs.version, inputs.scene, "00ff 12"}, "another sample");
}

TEST_F(CheckpointFile, TheOldOneStaysUntilTheNewOneIsComplete) {
    write_checkpoint(sample(), inputs, folder / "a", MPI_COMM_WORLD);
    EXPECT_THAT([&] { write_checkpoint(sample(), inputs, folder / "none" / "a", MPI_COMM_WORLD); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no folder")));
    EXPECT_EQ(read_checkpoint(folder / "a", inputs, MPI_COMM_WORLD).checkpoint.numbers, sample().numbers);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.part"));
}

}  // namespace
}  // namespace tomodem
