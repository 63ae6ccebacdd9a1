#include "core/scene/unusual_values.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "core/scene/model.hpp"

namespace tomodem {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string scene(const std::string& phase, const std::string& steps = "{ strain = -0.3, rate = 1e-3 }") {
    return fmt::format("[phase.a]\nlabel = 1\nlaw = \"bilin\"\n{}\n[load]\nsteps = [ {} ]\n", phase, steps);
}

const std::string usual = "norton = { K = 95.9, M = 2.45e-3 }";

/// Refused with what is said, unless the scene insists, as the message advises.
void expect_refused(const std::string& text, const std::string& what) {
    EXPECT_THAT([&] { parse_scene(text, "s.toml"); },
                ThrowsMessage<InvalidInput>(
                    AllOf(HasSubstr("scene 's.toml' line "), HasSubstr(what),
                          HasSubstr("if it is meant, write unusual_values = true as the scene's first line"))));
    EXPECT_NO_THROW(parse_scene("unusual_values = true\n" + text, "s.toml"));
}

TEST(UnusualValues, AFlowStressInPascalIsRefused) {
    expect_refused(
        scene("norton = { K = 95.9e6, M = 2.45e-3 }"),
        "K = 9.59e+07 of [phase.a] makes a flow stress of 9.43e+04 GPa at 0.001 /s, which no material has: K is "
        "in MPa.s^M (if this one is in Pa.s^M, write 95.9)");
    // M = 0.5 at 1e-2 /s: a tenth of K.
    const std::string fast = "{ strain = -0.3, rate = 1e-2 }";
    expect_refused(scene("norton = { K = 1.001e5, M = 0.5 }", fast), "flow stress of 10 GPa");
    EXPECT_NO_THROW(parse_scene(scene("norton = { K = 0.999e5, M = 0.5 }", fast), "s.toml"));
}

TEST(UnusualValues, AStiffnessBeyondDiamondIsRefused) {
    const std::string text = "natural_period = 0.1\nrepulsive_stiffness = ";
    expect_refused(scene(text + "1.01e12"), "repulsive_stiffness = 1.01e+12 uN/mm of [phase.a] is 1.01e+03 GPa");
    EXPECT_NO_THROW(parse_scene(scene(text + "0.99e12"), "s.toml"));
}

TEST(UnusualValues, AStrainInPerCentIsRefused) {
    expect_refused(
        scene(usual, "{ strain = -30, rate = 1e-3 }"),
        "line 6: strain = -30 leaves 9.4e-14 times the height: strains are true strains, ln(H / H0) (-30 % of the "
        "height is -0.3567)");
    expect_refused(scene(usual, "{ strain = -3.01, rate = 1e-3 }"), "strain = -3.01");
    EXPECT_NO_THROW(parse_scene(scene(usual, "{ strain = -3, rate = 1e-3 }"), "s.toml"));
}

TEST(UnusualValues, ARateOfAnotherUnitIsRefused) {
    expect_refused(scene(usual, "{ strain = -0.3, rate = 1.01e6 }"),
                   "the rate is 1.01e+06 /s, where 1e-12 to 1e+06 is usual");
    expect_refused(scene(usual, "{ strain = -0.3, rate = 0.99e-12 }"), "the rate is 9.9e-13 /s");
    expect_refused(scene(usual, "{ strain = -0.3, rate = [1e5, 1e13] }"), "the rate is 2.45153e+06 /s");
    EXPECT_NO_THROW(parse_scene(scene(usual, "{ strain = -0.3, rate = 0.99e6 }"), "s.toml"));
    EXPECT_NO_THROW(parse_scene(scene(usual, "{ strain = -0.3, rate = 1.01e-12 }"), "s.toml"));
    expect_refused("[phase.a]\nlabel = 1\nlaw = \"bilin\"\n" + usual +
                       "\n[load]\nduration = 1\nrate = 1e7\n[[wall]]\nname = \"w\"\nsurface = \"w.stl\"\n",
                   "rate = 1e+07 in [load]");
}

TEST(UnusualValues, HardeningInPerCentIsRefused) {
    expect_refused(scene(usual + "\nhardening = { table = [[0, 100], [600, 120]] }"),
                   "hardening of [phase.a] has the factor 100 at 0 s");
    expect_refused(scene(usual + "\nhardening = { table = [[0, 1], [600, 0.019]] }"), "has the factor 0.019 at 600 s");
    EXPECT_NO_THROW(
        parse_scene(scene(usual + "\nhardening = { table = [[0, 1], [600, 49], [700, 0.021]] }"), "s.toml"));
    // The load lasts 300 s: exp(3) + 1 = 21, exp(6) + 1 = 404.
    const std::string rising = "\nhardening = {{ amplitude = 1, rate = {}, exponent = 0, base = 1 }}";
    EXPECT_NO_THROW(parse_scene(scene(usual + fmt::format(fmt::runtime(rising), 0.01)), "s.toml"));
    expect_refused(scene(usual + fmt::format(fmt::runtime(rising), 0.02)), "has the factor 404.429 at 300 s");
}

Packing cube(double seed_radius) {
    Packing packing;
    packing.box = {Vec3::Zero(), Vec3::Constant(4 * seed_radius)};
    packing.seed_radius = seed_radius;
    for (int k = 0; k < 8; ++k) {
        packing.position.emplace_back(2 * seed_radius * (k & 1), seed_radius * (k & 2), 0.5 * seed_radius * (k & 4));
        packing.species.push_back(k < 4 ? 1 : 2);
        packing.id.push_back(k + 1);
    }
    return packing;
}

const std::string two_phases =
    "[phase.matrix]\nlabel = 1\nlaw = \"bilin\"\nnorton = { K = 95.9, M = 2.45e-3 }\n"
    "[phase.inclusion]\nlabel = 2\nlaw = \"bilin\"\nnorton = { K = 200, M = 2.45e-3 }\n"
    "[load]\nsteps = [ { strain = -0.3, rate = 1e-3 } ]\n";

TEST(UnusualValues, ASampleOfAtomsOrOfRocksIsRefused) {
    const Scene scene = parse_scene(two_phases, "s.toml");
    for (const double radius : {0.9e-6, 101.0})
        EXPECT_THAT([&] { compile_model(scene, cube(radius)); },
                    ThrowsMessage<InvalidInput>(HasSubstr("was the voxel size given in the right unit?")));
    EXPECT_NO_THROW(compile_model(parse_scene("unusual_values = true\n" + two_phases, "s.toml"), cube(101)));
    EXPECT_NO_THROW(compile_model(scene, cube(1.1e-6)));
    EXPECT_NO_THROW(compile_model(scene, cube(99)));
}

TEST(NamesOfLabels, SwappedBetweenSampleAndSceneAreRefused) {
    const Scene scene = parse_scene(two_phases, "s.toml");
    Packing sample = cube(0.5);
    sample.label_names = {{1, "Inclusion"}, {2, "matrix"}};
    EXPECT_THAT([&] { compile_model(scene, sample); },
                ThrowsMessage<InvalidInput>(HasSubstr("has label 2, but in the sample (vol2pack --labels) label 1 is "
                                                      "'Inclusion'; write label = 1 there")));
    sample.label_names = {{1, "void"}, {2, "matrix"}};
    EXPECT_THAT([&] { compile_model(scene, sample); }, ThrowsMessage<InvalidInput>(HasSubstr("label 2 is 'matrix'")));
}

TEST(NamesOfLabels, ThatDifferInWordsAloneAreSaidAndThatAgreeAreNot) {
    const Scene scene = parse_scene(two_phases, "s.toml");
    Packing sample = cube(0.5);
    EXPECT_TRUE(other_names(scene, sample).empty());
    sample.label_names = {{1, "Matrix"}, {2, "inclusion"}};
    EXPECT_NO_THROW(compile_model(scene, sample));
    EXPECT_TRUE(other_names(scene, sample).empty());
    sample.label_names = {{1, "iron"}, {2, "inclusion"}};
    EXPECT_NO_THROW(compile_model(scene, sample));
    EXPECT_EQ(other_names(scene, sample),
              std::vector<std::string>{
                  "label 1 is 'iron' in the sample and [phase.matrix] in the scene: are they the same?"});
}

}  // namespace
}  // namespace tomodem
