#include "tools/relax/carve.hpp"

#include <gmock/gmock.h>

#include <algorithm>

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
    EXPECT_EQ(assessment.volume, 0);
    EXPECT_FALSE(carver.is_done(assessment));
    erase(sample, carver.next_removal(sample, assessment, true));
    assessment = carver.assess(sample);
    EXPECT_NEAR(assessment.volume / assessment.target, 0.8, 0.03);
    for (int k = 0; k < 4 && !carver.is_done(assessment); ++k) {
        const double before = assessment.volume;
        erase(sample, carver.next_removal(sample, assessment, false));
        assessment = carver.assess(sample);
        EXPECT_GT(assessment.volume, before);
    }
    EXPECT_TRUE(carver.is_done(assessment));
    EXPECT_GT(assessment.iou(), 0.88);
    EXPECT_NEAR(assessment.grid_volume / assessment.target, 1, 0.03);
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

TEST_F(Carve, MasksOpenPoresOnceAndDoesNotJudgeThem) {
    Carver carver(image([&](const Vec3& p) { return (p - middle).norm() < 4 || p.norm() < 5; }), sample,
                  {.judged_across = 6});
    carver.measure_density(sample);
    Assessment assessment = carver.assess(sample);
    EXPECT_EQ(assessment.judged, 1);
    EXPECT_NEAR(assessment.target, 4.0 / 3 * 3.14159 * 64, 5);
    erase(sample, carver.next_removal(sample, assessment, true));
    for (const Vec3& point : sample.position) EXPECT_GT(point.norm(), 4.7);
    sample.position[0] = Vec3(1, 1, 1);
    assessment = carver.assess(sample);
    const auto places = carver.next_removal(sample, assessment, false);
    EXPECT_FALSE(std::binary_search(places.begin(), places.end(), std::size_t(0)));
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

TEST_F(Carve, RefusesAnImageWithOpenPoresAlone) {
    EXPECT_THAT([&] { Carver(image([](const Vec3& p) { return p.norm() < 5; }), sample, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no closed pore")));
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
