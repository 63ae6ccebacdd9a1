#include "tools/plan/scene_text.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/plan/drawn.hpp"

namespace tomodem::plan {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

const std::string commented = R"(# Ein Gefüge, 5 µm
[phase.a]   # the only one
label = 1
law = "bilin"   # as before
norton = { K = 50, M = 0.0714 }
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]  # of my own
frames = 7
strain_per_step = 1e-5   # µ: finer than need be
)";

TEST(SceneText, ChangesOnlyLawAndStep) {
    const std::string wanted = replaced(replaced(commented, "law = \"bilin\"", "law = \"norton\""),
                                        "strain_per_step = 1e-5", "strain_per_step = 0.008");
    EXPECT_EQ(with_choice(commented, {"norton", 8e-3}, "scene.toml"), wanted);
}

TEST(SceneText, StaysAsItIsWhereItHasTheChoice) {
    EXPECT_EQ(with_choice(commented, {"bilin", 1e-5}, "scene.toml"), commented);
}

TEST(SceneText, GetsATableAtTheEndWhereThereIsNone) {
    EXPECT_EQ(with_choice(drawn::one_phase, {"bilin", 2e-5}, "scene.toml"),
              std::string(drawn::one_phase) + "\n[accuracy]\nstrain_per_step = 2e-05\n");
}

TEST(SceneText, GetsAKeyInTheTableThatIsThere) {
    const std::string text = std::string(drawn::one_phase) + "[accuracy] # mine\nframes = 3\n";
    EXPECT_EQ(with_choice(text, {"trilin", 3e-4}, "scene.toml"),
              replaced(replaced(text, "bilin", "trilin"), "# mine\n", "# mine\nstrain_per_step = 0.0003\n"));
}

TEST(SceneText, ReplacesATimeStepThatWasGivenAndKeepsAuto) {
    const std::string text = std::string(drawn::one_phase) + "[accuracy]\ntime_step = 0.01 # s\n";
    EXPECT_EQ(with_choice(text, {"bilin", 2e-5}, "scene.toml"),
              replaced(text, "time_step = 0.01", "strain_per_step = 2e-05"));
    const std::string automatic = replaced(text, "0.01", "\"auto\"");
    EXPECT_THAT(with_choice(automatic, {"bilin", 2e-5}, "scene.toml"), HasSubstr("time_step = \"auto\" # s\n"));
}

TEST(SceneText, ReachesIntoInlineTables) {
    const std::string text = "accuracy = { frames = 3, strain_per_step = 1e-5 }\n" + std::string(drawn::one_phase);
    EXPECT_EQ(with_choice(text, {"norton", 4e-3}, "scene.toml"),
              replaced(replaced(text, "strain_per_step = 1e-5", "strain_per_step = 0.004"), "bilin", "norton"));
    const std::string without = "accuracy = { frames = 3 }\n" + std::string(drawn::one_phase);
    EXPECT_THAT(with_choice(without, {"bilin", 2e-5}, "scene.toml"),
                HasSubstr("accuracy = { strain_per_step = 2e-05, frames = 3 }\n"));
}

TEST(SceneText, RejectsALawThatCannotHoldTheScene) {
    const std::string tension = replaced(commented, "strain = -0.3", "strain = 0.3");
    EXPECT_THAT(
        [&] {
            with_choice(tension, {"bilin", 1e-5}, "scene.toml");
        },
        ThrowsMessage<InvalidInput>(HasSubstr("is tension, which law \"bilin\"")));
    EXPECT_THAT(with_choice(tension, {"norton", 8e-3}, "scene.toml"), HasSubstr("law = \"norton\""));
}

TEST(SceneText, IsReadableWhereAnotherLawCanHoldIt) {
    EXPECT_EQ(readable_scene(replaced(commented, "strain = -0.3", "strain = 0.3"), "scene.toml").steps.at(0).strain,
              0.3);
}

TEST(SceneText, OfQuasiStaticStepsHasNoWindowOfAveraging) {
    const std::string text = std::string(drawn::one_phase) +
                             "[accuracy]\nframes = 3\naveraging_strain = 0.02   # smooth\nstrain_per_step = 1e-5\n";
    EXPECT_EQ(with_choice(text, {"norton", 8e-3}, "scene.toml"),
              replaced(replaced(replaced(text, "averaging_strain = 0.02   # smooth\n", ""), "strain_per_step = 1e-5",
                                "strain_per_step = 0.008"),
                       "bilin", "norton"));
    EXPECT_THAT(with_choice(text, {"bilin", 2e-5}, "scene.toml"), HasSubstr("averaging_strain = 0.02   # smooth\n"));
    // The last line, without an end.
    EXPECT_THAT(
        with_choice(std::string(drawn::one_phase) + "[accuracy]\naveraging_strain = 0.02", {"norton", 8e-3}, "s"),
        testing::Not(HasSubstr("averaging")));
    EXPECT_THAT(
        [&] {
            with_choice(std::string(drawn::one_phase) + "[accuracy]\nscheme = \"explicit\"\n", {"norton", 8e-3}, "s");
        },
        ThrowsMessage<InvalidInput>(HasSubstr("or remove scheme")));
}

TEST(SceneText, TellsWhatIsWrongWithTheUsersOwnText) {
    EXPECT_THAT([] { readable_scene(replaced(commented, "frames", "farmes"), "scene.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr("line 9: unknown key 'farmes'")));
    EXPECT_THAT(
        [] {
            with_choice("[phase", {"bilin", 1e-5}, "scene.toml");
        },
        ThrowsMessage<InvalidInput>(HasSubstr("scene 'scene.toml' line 1")));
}

}  // namespace
}  // namespace tomodem::plan
