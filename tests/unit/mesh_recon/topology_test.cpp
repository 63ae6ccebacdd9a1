#include "tools/mesh_recon/topology.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <string>

namespace tomodem::mesh_recon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// A block of 21 x 13 x 13 and one of 6^3 beside it, on a cubic lattice; what a scene takes out is scattered far away.
class Scene {
 public:
    Scene& take(std::function<bool(const Vec3&)> from) {
        taken_.push_back(std::move(from));
        return *this;
    }
    Scene& take_box(const Vec3& centre, const Vec3& half) {
        return take([=](const Vec3& p) { return ((p - centre).cwiseAbs().array() < half.array()).all(); });
    }
    Scene& gap(double gap) {
        gap_ = gap;
        return *this;
    }
    std::vector<Vec3> positions() const {
        std::vector<Vec3> points;
        for (int k = 0; k <= 12; ++k)
            for (int j = 0; j <= 12; ++j)
                for (int i = 0; i <= 20; ++i) {
                    const Vec3 p(i, j, k);
                    bool taken = false;
                    for (const auto& from : taken_) taken |= from(p);
                    points.push_back(taken ? Vec3(100, 0, 0) + 5.0 * p : p);
                }
        for (int k = 0; k <= 5; ++k)
            for (int j = 0; j <= 5; ++j)
                for (int i = 0; i <= 5; ++i) points.emplace_back(20 + gap_ + i, 4 + j, 4 + k);
        return points;
    }

 private:
    std::vector<std::function<bool(const Vec3&)>> taken_;
    double gap_ = 6.0;
};

Scene& with_first_pore(Scene&& scene) {
    return scene.take_box({5, 6, 6}, {2.5, 2.5, 2.5});
}
Scene& with_pores(Scene&& scene) {
    return with_first_pore(std::move(scene)).take_box({13, 6, 6}, {2.5, 2.5, 2.5});
}

FrameTopology topology_of(const std::vector<Vec3>& positions) {
    return frame_topology(alpha_surface(positions, {.probe_radius = 1.0, .progress = {}, .seed_radius = 0.5}), {});
}

std::vector<Event> events_of(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
    return events_between(topology_of(before), topology_of(after), before, after, 2.0);
}

std::vector<std::string> names(const std::vector<Event>& events) {
    std::vector<std::string> names;
    for (const Event& event : events) names.emplace_back(name_of(event.change));
    return names;
}

std::vector<std::int64_t> numbers(const std::vector<Vec3>& positions) {
    const FrameTopology frame = topology_of(positions);
    return {frame.b0, frame.b1, frame.b2};
}

const std::vector<Vec3> whole = Scene{}.positions();
const std::vector<Vec3> one_pore = with_first_pore(Scene{}).positions();
const std::vector<Vec3> two_pores = with_pores(Scene{}).positions();
const std::vector<Vec3> joined_pores = with_pores(Scene{}).take_box({9, 6, 6}, {1.5, 1.5, 1.5}).positions();
const std::vector<Vec3> open_pore = with_pores(Scene{}).take_box({13, 6, 10}, {1.5, 1.5, 2.5}).positions();
const std::vector<Vec3> touching = Scene{}.gap(1.0).positions();
const std::vector<Vec3> pierced = Scene{}.take_box({10, 6, 6}, {2.5, 2.5, 7}).positions();

TEST(Topology, CountsPartsHandlesAndPores) {
    EXPECT_THAT(numbers(whole), ElementsAre(2, 0, 0));
    EXPECT_THAT(numbers(touching), ElementsAre(1, 0, 0));
    EXPECT_THAT(numbers(two_pores), ElementsAre(2, 0, 2));
    EXPECT_THAT(numbers(joined_pores), ElementsAre(2, 0, 1));
    EXPECT_THAT(numbers(open_pore), ElementsAre(2, 0, 1));
    EXPECT_THAT(numbers(pierced), ElementsAre(2, 1, 0));
}

TEST(Topology, NothingHappensBetweenEqualFrames) {
    EXPECT_THAT(events_of(two_pores, two_pores), IsEmpty());
}

TEST(Topology, TwoPartsThatMeetMergeWhereTheyMeet) {
    const std::vector<Event> events = events_of(whole, touching);
    ASSERT_THAT(names(events), ElementsAre("merge"));
    EXPECT_LT((events[0].place - Vec3(20.5, 6.5, 6.5)).norm(), 1e-9);
    EXPECT_NEAR(events[0].volume, 125.0, 1e-9);
    EXPECT_THAT(events[0].before, ElementsAre(0, 1));
    EXPECT_THAT(events[0].after, ElementsAre(0));
}

TEST(Topology, APartThatFallsInTwoSplitsWhereItHeldTogether) {
    const std::vector<Event> events = events_of(touching, whole);
    ASSERT_THAT(names(events), ElementsAre("split"));
    EXPECT_LT((events[0].place - Vec3(20.5, 6.5, 6.5)).norm(), 1e-9);
    EXPECT_THAT(events[0].before, ElementsAre(0));
    EXPECT_THAT(events[0].after, ElementsAre(0, 1));
}

TEST(Topology, APoreOpensAndClosesInItsPlace) {
    const std::vector<Event> opened = events_of(whole, one_pore), closed = events_of(one_pore, whole);
    ASSERT_THAT(names(opened), ElementsAre("pore_opened"));
    ASSERT_THAT(names(closed), ElementsAre("pore_closed"));
    for (const Event& event : {opened[0], closed[0]}) EXPECT_LT((event.place - Vec3(5, 6, 6)).norm(), 1e-9);
    EXPECT_NEAR(opened[0].volume, closed[0].volume, 1e-9);
}

TEST(Topology, TwoPoresCoalesceAndPartInTheMiddleOfTheirWall) {
    const std::vector<Event> joined = events_of(two_pores, joined_pores), parted = events_of(joined_pores, two_pores);
    ASSERT_THAT(names(joined), ElementsAre("coalescence"));
    ASSERT_THAT(names(parted), ElementsAre("pore_split"));
    for (const Event& event : {joined[0], parted[0]}) EXPECT_LT((event.place - Vec3(9, 6, 6)).norm(), 1.0);
}

TEST(Topology, APoreThatFindsAWayOutIsBreachedAndOneCutOffIsSealed) {
    const std::vector<Event> breached = events_of(two_pores, open_pore), sealed = events_of(open_pore, two_pores);
    ASSERT_THAT(names(breached), ElementsAre("pore_breached"));
    ASSERT_THAT(names(sealed), ElementsAre("pore_sealed"));
    for (const Event& event : {breached[0], sealed[0]}) EXPECT_LT((event.place - Vec3(13, 6, 6)).norm(), 1e-9);
}

TEST(Topology, APoreThatGrowsOrShrinksByALayerIsTheSame) {
    const std::vector<Vec3> larger = Scene{}.take_box({5, 6, 6}, {3.5, 3.5, 3.5}).positions();
    EXPECT_THAT(events_of(one_pore, larger), IsEmpty());
    EXPECT_THAT(events_of(larger, one_pore), IsEmpty());
}

TEST(Topology, SeveralEventsOfOneFrameAreAllListed) {
    EXPECT_THAT(names(events_of(touching, two_pores)), UnorderedElementsAre("split", "pore_opened", "pore_opened"));
}

TEST(Topology, APartThatIsScatteredVanishes) {
    std::vector<Vec3> scattered = whole;
    for (std::size_t i = scattered.size() - 216; i < scattered.size(); ++i)
        scattered[i] = Vec3(0, 100, 0) + 5.0 * scattered[i];
    const std::vector<Event> events = events_of(whole, scattered);
    ASSERT_THAT(names(events), ElementsAre("part_vanished"));
    EXPECT_THAT(names(events_of(scattered, whole)), ElementsAre("part_appeared"));
    EXPECT_LT((events[0].place - Vec3(28.5, 6.5, 6.5)).norm(), 1e-9);
}

TEST(Topology, CountsButDoesNotFollowWhatIsSmall) {
    const AlphaSurface surface = alpha_surface(two_pores, {.probe_radius = 1.0, .progress = {}, .seed_radius = 0.5});
    const FrameTopology frame = frame_topology(surface, {.particles = 217, .pore = 1000.0});
    EXPECT_EQ(frame.b0, 2);
    EXPECT_EQ(frame.b2, 2);
    EXPECT_EQ(frame.parts.size(), 1u);
    EXPECT_THAT(frame.pores, IsEmpty());
}

}  // namespace
}  // namespace tomodem::mesh_recon
