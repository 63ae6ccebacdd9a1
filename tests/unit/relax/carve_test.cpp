#include "tools/relax/carve.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "tests/unit/relax/images.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem::relax {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A dense block of 4000 particles, 18 across, and pores in its image.
class Carve : public testing::Test {
 protected:
    Packing sample = packgen::compact({.particles = 4000, .density = 0.66}).packing;
    double edge = sample.box.edges[0];
    Vec3 middle = Vec3::Constant(edge / 2);

    LabelVolume image(const std::function<bool(const Vec3&)>& is_void, double scale = 1) const {
        return image_of({72, 72, 72}, Vec3::Constant(scale * edge / 72), Vec3::Zero(), is_void);
    }
    LabelVolume ball(double radius) const {
        return image([=, this](const Vec3& p) { return (p - middle).norm() < radius; });
    }
    static void erase(Packing& sample, const std::vector<std::size_t>& places) {
        for (auto place = places.rbegin(); place != places.rend(); ++place) {
            sample.position.erase(sample.position.begin() + std::ptrdiff_t(*place));
            sample.species.erase(sample.species.begin() + std::ptrdiff_t(*place));
            sample.id.erase(sample.id.begin() + std::ptrdiff_t(*place));
        }
    }
};

TEST_F(Carve, ReachesTheVolumeFromBelowInASampleThatDoesNotMove) {
    Carver carver(ball(5), sample, {.judged_across = 8});
    carver.measure_density(sample);
    EXPECT_NEAR(carver.density(), 0.66, 0.01);
    Assessment assessment = carver.assess(sample);
    EXPECT_EQ(assessment.all.volume, 0);
    EXPECT_FALSE(carver.is_done(assessment));
    erase(sample, carver.next_removal(sample, assessment, true));
    assessment = carver.assess(sample);
    EXPECT_NEAR(assessment.all.volume / assessment.all.target, 0.8, 0.03);
    for (int k = 0; k < 4 && !carver.is_done(assessment); ++k) {
        const double before = assessment.all.volume;
        erase(sample, carver.next_removal(sample, assessment, false));
        assessment = carver.assess(sample);
        EXPECT_GT(assessment.all.volume, before);
    }
    EXPECT_TRUE(carver.is_done(assessment));
    EXPECT_GT(assessment.iou(), 0.88);
    EXPECT_NEAR(assessment.grid_volume / assessment.all.target, 1, 0.03);
}

TEST_F(Carve, TakesTheInnermostParticlesFirst) {
    Carver carver(ball(5), sample, {});
    carver.measure_density(sample);
    const auto places = carver.next_removal(sample, carver.assess(sample), true);
    EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
    double farthest = 0, nearest_left = 1e300;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double radius = (sample.position[i] - middle).norm();
        if (std::binary_search(places.begin(), places.end(), i))
            farthest = std::max(farthest, radius);
        else
            nearest_left = std::min(nearest_left, radius);
    }
    EXPECT_LT(farthest, nearest_left + 0.15);
}

TEST_F(Carve, ReachesTheVolumeOfPoresThatFacesCut) {
    // Half of one, a quarter of another, and one behind a wall of a particle.
    const std::vector<std::pair<Vec3, double>> balls{
        {{0, edge / 2, edge / 2}, 3.5}, {{edge, edge, edge / 2}, 5.0}, {{10, 3.7, 5}, 2.7}};
    Carver carver(image([&](const Vec3& p) {
                      return std::any_of(balls.begin(), balls.end(),
                                         [&](const auto& ball) { return (p - ball.first).norm() < ball.second; });
                  }),
                  sample, {.pore_error = 0.1, .min_across = 3, .judged_across = 5});
    carver.set_density(0.66);
    Assessment assessment = carver.assess(sample);
    ASSERT_EQ(assessment.cut.count, 3);
    EXPECT_EQ(assessment.closed.count, 0);
    EXPECT_EQ(assessment.judged, 3);
    const auto ball = [](double radius) { return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3); };
    EXPECT_NEAR(assessment.cut.target / (ball(3.5) / 2 + ball(5) / 4 + ball(2.7)), 1, 0.02);
    EXPECT_LT(assessment.cut.volume, 0.03 * assessment.cut.target);  // gaps at the faces of a packing cut off
    for (int k = 0; k < 6 && !carver.is_done(assessment); ++k) {
        erase(sample, carver.next_removal(sample, assessment, k == 0));
        assessment = carver.assess(sample);
    }
    EXPECT_TRUE(carver.is_done(assessment));
    // Beside what is missing by count.
    const double particle = 4.0 / 3 * std::numbers::pi / 8 / carver.density();
    EXPECT_NEAR((4000 - double(sample.size())) * particle / assessment.cut.target, 1, 0.05);
    EXPECT_NEAR(assessment.grid_volume / assessment.all.target, 1, 0.04);
    EXPECT_GT(assessment.iou(), 0.85);
}

TEST_F(Carve, FindsWhereTheMaterialEnds) {
    std::erase_if(sample.position, [&](const Vec3& p) { return p[0] < 1 || p[1] > edge - 0.4; });
    Carver carver(ball(3), sample, {.min_across = 3});
    carver.set_density(0.66);
    const Ends ends = carver.ends_of(sample);
    EXPECT_NEAR(ends.low[0], 1, 0.12);
    EXPECT_NEAR(ends.high[0], edge, 0.12);
    EXPECT_NEAR(ends.low[1], 0, 0.12);
    EXPECT_NEAR(ends.high[1], edge - 0.4, 0.12);
    EXPECT_NEAR(ends.high[2], edge, 0.12);
}

TEST_F(Carve, MasksVoidThatPassesThroughOnceAndDoesNotJudgeIt) {
    const auto from_axis = [](const Vec3& p) { return std::hypot(p[0] - 3, p[1] - 3); };
    Carver carver(image([&](const Vec3& p) { return (p - middle).norm() < 4 || from_axis(p) < 1.8; }), sample,
                  {.judged_across = 6});
    carver.measure_density(sample);
    Assessment assessment = carver.assess(sample);
    EXPECT_EQ(assessment.judged, 1);
    EXPECT_NEAR(assessment.all.target, 4.0 / 3 * 3.14159 * 64, 5);
    erase(sample, carver.next_removal(sample, assessment, true));
    for (const Vec3& point : sample.position) EXPECT_GT(from_axis(point), 1.6);
    sample.position[0] = Vec3(3, 3, 9);
    assessment = carver.assess(sample);
    const auto places = carver.next_removal(sample, assessment, false);
    EXPECT_FALSE(std::binary_search(places.begin(), places.end(), std::size_t(0)));
}

TEST_F(Carve, TakesNoMoreOutOfSmallPoresThanTheirTotalLacks) {
    // One of two small pores is too large by what the other lacks.
    const auto two = [&](double left, double right) {
        return image([=, this](const Vec3& p) {
            return (p - middle - Vec3(4.5, 0, 0)).norm() < left || (p - middle + Vec3(4.5, 0, 0)).norm() < right;
        });
    };
    Carver larger(two(2.2, 3.3), sample, {.min_across = 3});
    larger.measure_density(sample);
    erase(sample, larger.next_removal(sample, larger.assess(sample), true));
    erase(sample, larger.next_removal(sample, larger.assess(sample), false));
    Carver carver(two(3.0, 2.8), sample, {.min_across = 3});
    carver.set_density(larger.density());
    const Assessment assessment = carver.assess(sample);
    ASSERT_GT(assessment.pores[0].error() * assessment.pores[1].error(), -1);
    ASSERT_LT(assessment.pores[0].error() * assessment.pores[1].error(), 0);
    const double particle = 4.0 / 3 * std::numbers::pi / 8 / carver.density();
    const double taken = static_cast<double>(carver.next_removal(sample, assessment, false).size()) * particle;
    EXPECT_NEAR(taken, std::max(0.0, assessment.all.target - assessment.all.volume), particle);
}

TEST_F(Carve, HoldsBackWhereTooMuchCameOut) {
    Carver carver(ball(5), sample, {.judged_across = 8});
    carver.measure_density(sample);
    Assessment assessment = carver.assess(sample);
    erase(sample, carver.next_removal(sample, assessment, true));
    assessment = carver.assess(sample);
    const auto before = carver.next_removal(sample, assessment, false).size();
    Assessment overshot = assessment;
    overshot.pores[0].measure.volume = 1.2 * overshot.pores[0].target;
    EXPECT_TRUE(carver.has_overshot(overshot));
    EXPECT_TRUE(carver.hold_back(overshot));
    EXPECT_NEAR(double(carver.next_removal(sample, assessment, false).size()), double(before) / 2, 1);
    int times = 1;
    while (carver.hold_back(overshot)) ++times;
    EXPECT_LT(times, 10);
}

TEST_F(Carve, DoesNotDependOnTheNumberOfThreads) {
    const auto is_void = [&](const Vec3& p) {
        return (p - middle - Vec3(2.4, 0, 0)).norm() < 2.6 || (p - middle + Vec3(3, 0, 0)).norm() < 2.2;
    };
    Carver one(image(is_void), sample, {.threads = 1}), three(image(is_void), sample, {.threads = 3});
    one.measure_density(sample);
    three.measure_density(sample);
    const auto places = one.next_removal(sample, one.assess(sample), true);
    EXPECT_EQ(places, three.next_removal(sample, three.assess(sample), true));
    erase(sample, places);
    EXPECT_EQ(table_of({row_of(one.assess(sample), 1, 2, 3)}), table_of({row_of(three.assess(sample), 1, 2, 3)}));
}

TEST_F(Carve, RefusesAnImageOfAnotherSize) {
    EXPECT_THAT(([&] { Carver(image([&](const Vec3& p) { return (p - middle).norm() < 3; }, 1.5), sample, {}); }),
                ThrowsMessage<InvalidInput>(HasSubstr("do not lie over each other")));
}

TEST_F(Carve, RefusesAnImageOfVoidThatPassesThroughAlone) {
    EXPECT_THAT([&] { Carver(image([](const Vec3& p) { return p[0] < 5; }), sample, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no pore to carve")));
}

TEST_F(Carve, RefusesAPoreOutsideTheParticles) {
    for (Vec3& point : sample.position) point[2] *= 0.4;
    EXPECT_THAT([&] { Carver(ball(4), sample, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("outside the particles of the sample")));
}

TEST_F(Carve, KeepsItsRowsAsNumbers) {
    Carver carver(ball(5), sample, {});
    CarveRow row = row_of(carver.assess(sample), 3, 4000, 12);
    row.periods = 7;
    row.force_balance = 1e-4;
    EXPECT_EQ(table_of(rows_of(numbers_of({row, row}))), table_of({row, row}));
}

}  // namespace
}  // namespace tomodem::relax
