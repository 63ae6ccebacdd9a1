#include "solver_plugin/run/run_plan.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "solver_plugin/run/run_curves.hpp"

namespace tomodem {
namespace {

/// A load whose rate jumps a thousandfold, of 10 and 20 steps of strain.
Scene jumping(const std::string& accuracy) {
    return parse_scene(
        "[phase.a]\nlabel = 1\nlaw = \"norton\"\nnorton = { K = 100, M = 0.3 }\n[load]\n"
        "steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = 1 } ]\n[output]\nstress = "
        "true\n[accuracy]\n" +
            accuracy,
        "test");
}

Model stepping(const Scene& scene) {
    Model model{};
    model.scheme = scene.scheme;
    model.strain_per_step = 0.01;
    model.time_step = 0.01;
    return model;
}

TEST(RunPlan, OfAQuasiStaticRunHasAPointAtEveryStepAndItsFramesAtTheRightTimes) {
    const Scene scene = jumping("frames = 6\n");
    const auto path = load_path(scene, stepping(scene));
    const auto clocks = clocks_of(path);
    const auto plan = plan_points(scene, path);
    ASSERT_EQ(plan.size(), 30u);
    std::vector<double> strains, times;
    for (std::size_t k = 0; k < plan.size(); ++k) {
        EXPECT_EQ(plan[k].to - plan[k].from, 1);
        EXPECT_NEAR(plan[k].travelled, 0.01 * static_cast<double>(k + 1), 1e-12);
        EXPECT_EQ(plan[k].rest, (k + 1) % 10 == 0) << k;
        EXPECT_EQ(plan[k].sampled, plan[k].frame) << "the stress of a frame is that of its step";
        if (!plan[k].frame) continue;
        strains.push_back(plan[k].travelled);
        times.push_back(clocks[plan[k].segment].at((plan[k].segment == 0 ? 0 : path[0].steps) + plan[k].to));
    }
    const auto near = [](double value) { return testing::DoubleNear(value, 1e-9); };
    EXPECT_THAT(strains, testing::ElementsAre(near(0.05), near(0.1), near(0.15), near(0.2), near(0.25), near(0.3)));
    EXPECT_THAT(times, testing::ElementsAre(near(50), near(100), near(100.05), near(100.1), near(100.15), near(100.2)));
    EXPECT_THAT(sample_steps(1, 7), testing::ElementsAre(1));
}

TEST(RunPlan, OfExplicitStepsAveragesOverAWindow) {
    const Scene scene = jumping("scheme = \"explicit\"\nframes = 6\n");
    EXPECT_EQ(window_points(scene), points_per_window);
    const auto plan = plan_points(scene, load_path(scene, stepping(scene)));
    // 0.1 at 1e-5 a step has a hundred points 1e-3 apart; 0.2 at 0.01 a step no more than its 20 steps.
    ASSERT_EQ(plan.size(), 120u);
    EXPECT_EQ(plan[0].to, 100);
}

TEST(ForceWindow, OfAQuasiStaticRunIsTheLastPoint) {
    ForceWindow window(window_points(jumping("")));
    window.add({{1, 2, 1}, {}, 1});
    window.add({{3, 4, 1}, {}, 1});
    EXPECT_EQ(window.mean().planes.top, 3);
    EXPECT_EQ(window.mean().planes.bottom, 4);
}

}  // namespace
}  // namespace tomodem
