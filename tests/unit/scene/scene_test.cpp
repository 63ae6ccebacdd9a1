#include "core/scene/scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string whole = R"(seed_radius = 0.5

[phase.matrix]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }

[phase.inclusion]
label = 2
law = "bilin"
repulsive_stiffness = 2.65e9
natural_period = "800 ms"
objects = true

[contact]
self_contact = false
healing_time = inf

[load]
axis = "x"
steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = "1e-4 1/s" } ]

[accuracy]
time_step = "auto"
averaging_strain = 0.02
frames = 12
)";

/// The whole scene with one piece of it replaced.
std::string with(const std::string& piece, const std::string& replacement) {
    std::string text = whole;
    const std::size_t at = text.find(piece);
    EXPECT_NE(at, std::string::npos) << piece;
    return text.replace(at, piece.size(), replacement);
}

void expect_refused(const std::string& text, const std::string& line, const std::string& what) {
    EXPECT_THAT([&] { parse_scene(text, "s.toml"); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("scene 's.toml' line " + line + ":"), HasSubstr(what))));
}

TEST(Scene, IsReadWhole) {
    const Scene scene = parse_scene(whole, "s.toml");
    ASSERT_EQ(scene.phases.size(), 2u);
    EXPECT_EQ(scene.phase(1).name, "matrix");
    EXPECT_DOUBLE_EQ(scene.phase(1).norton->consistency, 95.9);
    EXPECT_DOUBLE_EQ(*scene.phase(2).natural_period, 0.8);
    EXPECT_TRUE(scene.phase(2).objects);
    EXPECT_EQ(scene.axis, 0);
    ASSERT_EQ(scene.steps.size(), 2u);
    EXPECT_EQ(scene.steps[1].rate, std::vector{1e-4});
    EXPECT_DOUBLE_EQ(scene.highest_rate(), 1e-3);
    EXPECT_DOUBLE_EQ(scene.path_length(), 0.3);
    EXPECT_FALSE(scene.time_step.has_value());
    EXPECT_EQ(scene.frames, 12);
    EXPECT_DOUBLE_EQ(scene.crown_radius, 0.75);
}

TEST(Scene, NamesTheLineOfAnUnknownKey) {
    expect_refused(with("objects = true", "object = true"), "13", "unknown key 'object' in [phase.inclusion]");
    expect_refused(with("frames", "frame"), "26", "unknown key 'frame' in [accuracy]");
    expect_refused(with("K = 95.9", "k = 95.9"), "6", "norton needs both K");
}

TEST(Scene, RefusesAQuantityWithoutUnit) {
    expect_refused(with("\"800 ms\"", "\"800\""), "12", "no unit");
    expect_refused(with("\"800 ms\"", "\"800 um\""), "12", "um");
}

TEST(Scene, RefusesBilinInTension) {
    expect_refused(with("strain = -0.3", "strain = -0.05"), "21", "from strain -0.1 to -0.05 is tension");
    expect_refused(with("strain = -0.1", "strain = 0.1"), "21", "is tension");
}

TEST(Scene, RefusesValuesOutOfRange) {
    expect_refused(with("seed_radius = 0.5", "seed_radius = 0"), "1", "expected more than 0");
    expect_refused(with("rate = 1e-3", "rate = -1e-3"), "21", "expected more than 0");
    expect_refused(with("frames = 12", "frames = 0"), "26", "at least 1");
    expect_refused(with("label = 2", "label = 1"), "3", "belongs to another phase");
    expect_refused(with("\"x\"", "\"w\""), "20", "axis must be");
}

TEST(Scene, RefusesAPhaseWithTwoDescriptionsOrNone) {
    expect_refused(with("objects = true", "norton = { K = 1, M = 0.1 }"), "8", "either norton");
    expect_refused(with("natural_period = \"800 ms\"", ""), "8", "either norton");
}

const std::string porous = R"([phase.metal]
label = 1
law = "trilin"
norton = { K = 49.1, M = 0.0714 }
hardening = { table = [[0, 1], [100, 1.5]] }

[contact]
self_contact = true
healing_time = "20 s"

[load]
steps = [ { strain = -0.3, rate = 1e-3 }, { strain = 0.1, rate = 1e-3 } ]
)";

TEST(Scene, ReadsALawThatCarriesTensionWithSelfContactAndHardening) {
    const Scene scene = parse_scene("radius_dispersion = 0.05\n" + porous, "s.toml");
    EXPECT_EQ(scene.law().name(), "trilin");
    EXPECT_DOUBLE_EQ(scene.crown_radius, 0.7);
    EXPECT_DOUBLE_EQ(scene.radius_dispersion, 0.05);
    EXPECT_TRUE(scene.self_contact);
    EXPECT_EQ(scene.healing_time, 20);
    EXPECT_DOUBLE_EQ(scene.phases[0].stiffness_ratio, 3);
    EXPECT_DOUBLE_EQ(scene.phases[0].hardening->factor(50), 1.25);
    EXPECT_DOUBLE_EQ(scene.phases[0].hardening->factor(1000), 1.5);
}

std::string viscous(const std::string& accuracy, const std::string& law = "norton", const std::string& load = "",
                    const std::string& contact = "") {
    return fmt::format(
        "[phase.a]\nlabel = 1\nlaw = \"{}\"\nnorton = {{ K = 49.1, M = 0.0714 }}\n{}[load]\n"
        "steps = [ {{ strain = -0.1, rate = 1e-3 }} ]\n{}[accuracy]\n{}\n",
        law, contact, load, accuracy);
}

TEST(Scene, IsQuasiStaticUnderNortonUnlessItSaysOtherwise) {
    const Scene plain = parse_scene(viscous("time_step = \"auto\""), "s");
    EXPECT_EQ(plain.scheme, Scheme::quasi_static);
    EXPECT_DOUBLE_EQ(plain.max_imbalance, 1e-2);
    EXPECT_FALSE(plain.strain_per_step.has_value());
    const std::string without_accuracy = viscous("").substr(0, viscous("").find("[accuracy]"));
    EXPECT_EQ(parse_scene(without_accuracy, "s").scheme, Scheme::quasi_static);
    const Scene finer = parse_scene(viscous("max_imbalance = 1e-3\nstrain_per_step = 4e-3"), "s");
    EXPECT_DOUBLE_EQ(finer.max_imbalance, 1e-3);
    EXPECT_DOUBLE_EQ(finer.step_strain(), 4e-3);
    EXPECT_EQ(parse_scene(viscous("scheme = \"quasi_static\""), "s").scheme, Scheme::quasi_static);
    EXPECT_EQ(parse_scene(viscous("scheme = \"explicit\""), "s").scheme, Scheme::explicit_steps);
    for (const char* law : {"bilin", "trilin"}) {
        EXPECT_EQ(parse_scene(viscous("", law), "s").scheme, Scheme::explicit_steps);
        EXPECT_EQ(parse_scene(viscous("scheme = \"explicit\"", law), "s").scheme, Scheme::explicit_steps);
    }
}

TEST(Scene, OfQuasiStaticStepsRefusesWhatBelongsToExplicitOnes) {
    for (const std::string scheme : {"", "scheme = \"quasi_static\"\n"}) {
        const std::string line = scheme.empty() ? "8" : "9";
        for (const std::string key : {"inertia_share = 0.02", "time_step = 0.1", "averaging_strain = 0.01"}) {
            const std::string name = key.substr(0, key.find(' '));
            expect_refused(viscous(scheme + key), line, name + " belongs to explicit steps");
            expect_refused(viscous(scheme + key), line, "add scheme = \"explicit\" to [accuracy], or remove " + name);
            // As told.
            EXPECT_EQ(parse_scene(viscous("scheme = \"explicit\"\n" + key), "s").scheme, Scheme::explicit_steps);
        }
        const std::string initiation = "initiation = { strain = 0.01 }\n";
        expect_refused(viscous(scheme, "norton", initiation), "5", "initiation belongs to explicit steps");
        EXPECT_NO_THROW(parse_scene(viscous("scheme = \"explicit\"", "norton", initiation), "s"));
        expect_refused(viscous(scheme + "strain_per_step = 0.06"), line, "takes at most 0.05");
        expect_refused(viscous(scheme + "max_imbalance = 0.2"), line, "at most 0.1");
    }
    const std::string by_force = "scheme = \"quasi_static\"";
    expect_refused(viscous(by_force, "bilin"), "8", "law \"bilin\" is solved in explicit steps only");
    expect_refused(viscous(by_force, "trilin"), "8", "take law = \"norton\"");
    expect_refused(viscous("scheme = \"implicit\""), "8", "expected \"explicit\" or \"quasi_static\"");
    expect_refused(viscous("max_imbalance = 1e-3", "bilin"), "8", "goes with quasi-static steps");
    const std::string explicit_steps = "scheme = \"explicit\"\n";
    expect_refused(viscous(explicit_steps + "max_imbalance = 1e-3"), "9", "goes with quasi-static steps");
    expect_refused(viscous(explicit_steps + "strain_per_step = 1e-3"), "9", "or remove scheme");
}

TEST(Scene, RefusesSelfContactUnderALawThatKeepsNoMemoryOfPairs) {
    const std::string contact = "[contact]\nself_contact = true\n";
    for (const std::string accuracy : {"", "scheme = \"explicit\"\n"})
        expect_refused(viscous(accuracy, "norton", "", contact), "6", "remove self_contact, or take law \"trilin\"");
    EXPECT_FALSE(parse_scene(viscous("", "norton", "", "[contact]\nself_contact = false\n"), "s").self_contact);
    EXPECT_TRUE(parse_scene(viscous("", "trilin", "", contact), "s").self_contact);
    EXPECT_TRUE(parse_stored_scene(viscous("", "norton", "", contact), "s").self_contact) << "of an earlier version";
}

TEST(Scene, StoredInARunSaysTheSchemeThatItsLawChose) {
    const Scene written = parse_scene(viscous("frames = 3"), "s");
    EXPECT_THAT(written.text, testing::StartsWith(viscous("frames = 3")));
    EXPECT_THAT(written.text, testing::HasSubstr("[resolved]\nscheme = \"quasi_static\"\n"));
    for (const Scene& again : {parse_stored_scene(written.text, "s"), parse_scene(written.text, "s")}) {
        EXPECT_EQ(again.scheme, Scheme::quasi_static);
        EXPECT_EQ(again.text, written.text);
    }
    const std::string inline_table = "accuracy = { frames = 3 }\n" + viscous("").substr(0, viscous("").find("[acc"));
    EXPECT_EQ(parse_stored_scene(parse_scene(inline_table, "s").text, "s").scheme, Scheme::quasi_static);
    for (const std::string given : {"scheme = \"explicit\"", "scheme = \"quasi_static\""})
        EXPECT_EQ(parse_scene(viscous(given), "s").text, viscous(given));
    EXPECT_EQ(parse_scene(viscous("", "bilin"), "s").text, viscous("", "bilin"));
}

TEST(Scene, StoredInARunOfAnEarlierVersionIsExplicit) {
    for (const std::string accuracy : {"", "inertia_share = 0.03", "averaging_strain = 0.02\ntime_step = 1e-3"})
        EXPECT_EQ(parse_stored_scene(viscous(accuracy), "s").scheme, Scheme::explicit_steps) << accuracy;
    EXPECT_EQ(parse_stored_scene(viscous("scheme = \"quasi_static\""), "s").scheme, Scheme::quasi_static);
}

TEST(Scene, SaysTheNewNameOfAKeyThatWasRenamed) {
    const auto text = [](const char* law, const char* key) {
        return fmt::format(
            "[phase.a]\nlabel = 1\nlaw = \"{}\"\nnorton = {{ K = 49.1, M = 0.0714 }}\n[load]\n"
            "steps = [ {{ strain = -0.1, rate = 1e-3 }} ]\n[accuracy]\n{} = 0.01\n",
            law, key);
    };
    expect_refused(text("bilin", "equilibrium_error"), "8", "equilibrium_error is called max_equilibrium_error now");
    expect_refused(text("norton", "equilibrium_error"), "8", "equilibrium_error is called inertia_share now");
    expect_refused(text("trilin", "equilibrium_error"), "8", "choose strain_per_step");
    expect_refused(text("bilin", "inertia_share"), "8", "belongs to law \"norton\"");
    expect_refused(text("norton", "max_equilibrium_error"), "8", "belongs to law \"bilin\"");
    const std::string explicit_steps = text("norton", "scheme = \"explicit\"\ninertia_share");
    EXPECT_EQ(number_of(parse_scene(explicit_steps, "s").law_accuracy, "inertia_share"), 0.01);
    EXPECT_EQ(number_of(parse_scene(text("bilin", "max_equilibrium_error"), "s").law_accuracy, "max_equilibrium_error"),
              0.01);
}

TEST(Scene, StoredInARunIsReadWithTheKeysOfItsTime) {
    const auto text = [](const char* law) {
        return fmt::format(
            "[phase.a]\nlabel = 1\nlaw = \"{}\"\nnorton = {{ K = 49.1, M = 0.0714 }}\n[contact]\nbetween_objects = "
            "true\n"
            "[load]\nsteps = [ {{ strain = -30, rate = 1e-3 }} ]\n[accuracy]\nequilibrium_error = 0.01\n",
            law);
    };
    expect_refused(text("bilin"), "6", "between_objects is called objects_only_push now");
    const Scene bilin = parse_stored_scene(text("bilin"), "s.toml"),
                norton = parse_stored_scene(text("norton"), "s.toml");
    EXPECT_TRUE(bilin.objects_only_push);
    EXPECT_EQ(number_of(bilin.law_accuracy, "max_equilibrium_error"), 0.01);
    EXPECT_EQ(number_of(norton.law_accuracy, "inertia_share"), 0.01);
    EXPECT_EQ(bilin.text, text("bilin"));
}

TEST(Scene, RefusesWhatALawDoesNotHave) {
    const auto changed = [](const std::string& piece, const std::string& replacement) {
        std::string text = porous;
        return text.replace(text.find(piece), piece.size(), replacement);
    };
    expect_refused(with("natural_period = \"800 ms\"", "natural_period = 1\ngreatest_attraction = 1e8"), "13",
                   "belongs to law \"trilin\"");
    expect_refused(with("law = \"bilin\"\nrepulsive", "law = \"trilin\"\nrepulsive"), "3", "one law");
    expect_refused(with("law = \"bilin\"", "law = \"trulin\""), "5", "\"bilin\", \"trilin\" or \"norton\"");
    expect_refused(changed("self_contact = true\n", ""), "8", "has no effect");
    expect_refused(changed("[100, 1.5]", "[0, 1.5]"), "5", "times rising");
    expect_refused(changed("[100, 1.5]", "[100, -1]"), "5", "factors above 0");
    expect_refused("radius_dispersion = 0.5\n" + porous, "1", "expected 0 to 0.3");
}

TEST(Hardening, IsTheThesisCrystallisationLaw) {
    // Thesis chapter 13: strength after 600 s and after half an hour more.
    const Hardening law{{}, 2.91e-4, 1.82e-3, 4.24, 0.951, 600};
    EXPECT_NEAR(law.factor(0), 1.011, 0.001);
    EXPECT_NEAR(law.factor(1800), 2.91e-4 * std::exp(1.82e-3 * 2400 + 4.24) + 0.951, 1e-12);
}

TEST(Scene, ReadsAPolynomialRate) {
    const Scene scene = parse_scene(with("rate = 1e-3", "rate = [1e-3, 2e-5]"), "s.toml");
    EXPECT_EQ(scene.steps[0].rate, (std::vector{1e-3, 2e-5}));
    // 1e-3 t + 1e-5 t^2 = 0.1 after 61.8 s.
    EXPECT_NEAR(scene.highest_rate(), std::sqrt(1e-6 + 4 * 1e-5 * 0.1), 1e-12);
}

TEST(Scene, RefusesARateThatFallsToZeroBeforeTheTarget) {
    // 1e-3 t - 1e-5 t^2 / 2 ends at 0.05.
    expect_refused(with("rate = 1e-3", "rate = [1e-3, -1e-5]"), "21", "falls to zero after 100 s, at strain -0.05");
    expect_refused(with("rate = 1e-3", "rate = []"), "21", "coefficients of a polynomial");
    expect_refused(with("rate = 1e-3", "rate = [0, 1e-3]"), "21", "the first above 0");
    expect_refused(with("rate = 1e-3", "rate = [1e-3, inf]"), "21", "coefficients of a polynomial");
    expect_refused(with("rate = 1e-3", "rate = [1e-3, \"2\"]"), "21", "rate in a step of [load] must be a number");
}

/// The whole scene with walls behind it; the first line of `walls` is 27.
std::string with_walls(const std::string& walls) {
    return whole + walls;
}

const std::string tool = "[[wall]]\nname = \"tool\"\nsurface = \"tool.stl\"\n";

TEST(Scene, ReadsWalls) {
    const Scene scene =
        parse_scene(with_walls(tool + "unit = \"um\"\nvelocity = [0, 0.5, -1]\nstart = \"1 min\"\nstop = 90\n"
                                      "[[wall]]\nname = \"die\"\nsurface = \"/abs/die.ply\"\n"),
                    "folder/s.toml");
    ASSERT_EQ(scene.walls.size(), 2u);
    EXPECT_EQ(scene.walls[0].name, "tool");
    EXPECT_EQ(scene.walls[0].surface, "folder/tool.stl");
    EXPECT_DOUBLE_EQ(scene.walls[0].unit, 1e-3);
    EXPECT_EQ(scene.walls[0].velocity, (std::array{0.0, 0.5, -1.0}));
    EXPECT_EQ(scene.walls[0].start, 60);
    EXPECT_EQ(scene.walls[0].stop, 90);
    EXPECT_EQ(scene.walls[0].line, 27);
    EXPECT_EQ(scene.walls[1].surface, "/abs/die.ply");
    EXPECT_EQ(scene.walls[1].velocity, (std::array{0.0, 0.0, 0.0}));
}

TEST(Scene, RefusesAWallThatIsNotDescribed) {
    expect_refused(with_walls("[[wall]]\nsurface = \"t.stl\"\n"), "27", "[[wall]] has no 'name'");
    expect_refused(with_walls("[[wall]]\nname = \"t\"\n"), "27", "[[wall]] has no 'surface'");
    expect_refused(with_walls("[[wall]]\nname = \"a b\"\nsurface = \"t.stl\"\n"), "28", "letters, digits");
    expect_refused(with_walls("[[wall]]\nname = 3\nsurface = \"t.stl\"\n"), "28", "name in [[wall]] must be a string");
    expect_refused(with_walls(tool + tool), "30", "two walls are called 'tool'");
    expect_refused(with_walls("[wall]\nname = \"t\"\n"), "27", "walls are written [[wall]]");
    expect_refused(with_walls(tool + "unit = \"s\"\n"), "30", "expected a length");
    expect_refused(with_walls(tool + "velocity = [0, 1]\n"), "30", "three numbers");
    expect_refused(with_walls(tool + "velocity = 1\n"), "30", "three numbers");
    expect_refused(with_walls(tool + "velocity = [0, 1, inf]\n"), "30", "three numbers");
    expect_refused(with_walls(tool + "start = -1\n"), "30", "expected 0 or more");
    expect_refused(with_walls(tool + "start = 2\nstop = 1\n"), "27", "must stop after its start");
    expect_refused(with_walls(tool + "speed = 2\n"), "30", "unknown key 'speed' in [[wall]]");
}

/// The whole scene with its steps replaced by `load`.
std::string loaded(const std::string& load) {
    return with("steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = \"1e-4 1/s\" } ]", load);
}

TEST(Scene, ReadsADurationForWallsAlone) {
    const Scene scene = parse_scene(loaded("duration = \"5 min\"\nrate = 1e-3") + tool, "s.toml");
    EXPECT_TRUE(scene.steps.empty());
    EXPECT_EQ(scene.duration, 300);
    EXPECT_EQ(scene.highest_rate(), 1e-3);
    EXPECT_DOUBLE_EQ(scene.path_length(), 0.3);
}

TEST(Scene, RefusesALoadThatIsNoneOrTwo) {
    expect_refused(loaded(""), "19", "[load] has no 'steps'");
    expect_refused(loaded("duration = 300\nrate = 1e-3"), "21", "for scenes with walls");
    expect_refused(loaded("duration = 300") + tool, "19", "[load] has no 'rate'");
    expect_refused(loaded("duration = \"300\"\nrate = 1e-3") + tool, "21", "no unit");
    expect_refused(loaded("steps = [ { strain = -0.1, rate = 1e-3 } ]\nduration = 300") + tool, "21", "both steps and");
    expect_refused(loaded("steps = [ { strain = -0.1, rate = 1e-3 } ]\nrate = 1"), "22", "goes with duration");
}

TEST(Scene, ReadsTheInitiationAndTheLateralSides) {
    const Scene scene = parse_scene(
        with("axis = \"x\"", "axis = \"x\"\ninitiation = { strain = 0.02, noise = 0.1 }\nlateral = \"periodic\""),
        "s.toml");
    EXPECT_DOUBLE_EQ(scene.initiation->strain, 0.02);
    EXPECT_DOUBLE_EQ(scene.initiation->noise, 0.1);
    EXPECT_TRUE(scene.initiation->affine);
    EXPECT_EQ(scene.lateral, Lateral::periodic);
    const Scene plain = parse_scene(whole, "s.toml");
    EXPECT_FALSE(plain.initiation.has_value());
    EXPECT_EQ(plain.lateral, Lateral::free);
}

TEST(Scene, RefusesAnInitiationOrSidesThatCannotBe) {
    const auto load = [](const std::string& text) { return with("axis = \"x\"", text); };
    expect_refused(load("initiation = { noise = 0.1 }"), "20", "has no 'strain'");
    expect_refused(load("initiation = { strain = 0 }"), "20", "expected more than 0");
    expect_refused(load("initiation = { strain = 0.01, noise = -1 }"), "20", "expected 0 to 10");
    expect_refused(load("initiation = { strain = 0.01, affine = 1 }"), "20", "must be true or false");
    expect_refused(load("initiation = { strain = 0.06 }"), "20", "longer than half the step from 0 to -0.1");
    expect_refused(load("initiation = 0.02"), "20", "must be a table");
    expect_refused(load("lateral = \"fixed\""), "20", "must be \"free\", \"periodic\" or \"isochoric\"");
    const std::string alone = "duration = 300\nrate = 1e-3\n";
    expect_refused(loaded(alone + "lateral = \"periodic\"") + tool, "23", "needs steps");
    expect_refused(loaded(alone + "initiation = { strain = 0.01 }") + tool, "23", "needs steps");
}

TEST(Scene, RefusesASyntaxErrorWithItsLine) {
    expect_refused(with("label = 1", "label = "), "4", "");
}

TEST(Scene, RefusesALabelThatNoPhaseHas) {
    const Scene scene = parse_scene(whole, "s.toml");
    EXPECT_THAT([&] { scene.phase(3); }, ThrowsMessage<InvalidInput>(HasSubstr("no phase with label 3")));
}

TEST(SceneOutput, IsOffUntilItIsAskedFor) {
    EXPECT_FALSE(parse_scene(whole, "test").write_velocity);
    EXPECT_FALSE(parse_scene(whole, "test").write_stress);
    const Scene scene = parse_scene(whole + "\n[output]\nvelocity = true\nstress = true\n", "test");
    EXPECT_TRUE(scene.write_velocity);
    EXPECT_TRUE(scene.write_stress);
}

TEST(SceneOutput, RefusesWhatIsNoSwitch) {
    EXPECT_THAT([] { parse_scene(whole + "\n[output]\nvelocity = 1\n", "test"); },
                ThrowsMessage<InvalidInput>(HasSubstr("velocity in [output] must be true or false")));
    EXPECT_THAT([] { parse_scene(whole + "\n[output]\nspeed = true\n", "test"); },
                ThrowsMessage<InvalidInput>(HasSubstr("unknown key 'speed' in [output]")));
}

}  // namespace
}  // namespace tomodem
