#include "tools/render/cut.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace tomodem::render {
namespace {

/// A cube of 20 x 20 x 20 spheres of radius 0.5, slightly off their lattice, without or with another label in a ball.
enum class Ball { pore, phase, object };

struct Place {
    Vec3 centre;
    double radius;
};

Packing cube(const std::vector<Place>& balls, Ball kind) {
    Packing packing;
    packing.seed_radius = 0.5;
    packing.box = {Vec3::Zero(), Vec3::Constant(20)};
    for (int k = 0; k < 8000; ++k) {
        const int x = k % 20, y = k / 20 % 20, z = k / 400;
        const Vec3 jitter = 0.05 * Vec3(std::sin(1.7 * k), std::sin(2.3 * k), std::sin(3.1 * k));
        const Vec3 centre = Vec3(x, y, z) + Vec3::Constant(0.5) + jitter;
        bool inside = false;
        for (const Place& ball : balls) inside |= (centre - ball.centre).norm() < ball.radius;
        if (inside && kind == Ball::pore) continue;
        packing.position.push_back(centre);
        packing.species.push_back(inside && kind == Ball::phase ? 2 : 1);
        packing.object.push_back(inside && kind == Ball::object ? 1 : 0);
        packing.id.push_back(k + 1);
    }
    return packing;
}

TEST(BestCut, GoesThroughTheMiddleOfTheOnlyBallWhateverItIs) {
    // The plane across y nearest to the middle that has 98 % of the ball's largest section is within a seventh of its
    // radius.
    const Place ball{{10, 5.5, 13}, 3.5};
    for (const Ball kind : {Ball::pore, Ball::phase, Ball::object}) {
        const CutPlane plane = best_cut(cube({ball}, kind));
        const double middle = plane.cut == Cut::y ? ball.centre.y() : ball.centre.x();
        EXPECT_NEAR(plane.place, middle, 1.2) << "kind " << static_cast<int>(kind);
    }
}

TEST(BestCut, TakesTheAxisAcrossWhichThereIsMore) {
    // Both lie in the plane x = 5, and no plane across y holds both.
    const CutPlane plane = best_cut(cube({{{5, 5, 10}, 3}, {{5, 15, 10}, 3}}, Ball::pore));
    EXPECT_EQ(plane.cut, Cut::x);
    EXPECT_NEAR(plane.place, 5, 1);
}

TEST(BestCut, IsInTheMiddleAcrossYWhereThereIsNothing) {
    const CutPlane plane = best_cut(cube({}, Ball::pore));
    EXPECT_EQ(plane.cut, Cut::y);
    EXPECT_NEAR(plane.place, 10, 0.1);
}

TEST(BestCut, GoesThroughTheSolidOfAnOpenStructure) {
    // Two struts of a fifth of the width, along z, in the planes y = 4 and y = 16; the rest is void.
    Packing packing = cube({}, Ball::pore), struts = packing;
    for (auto* numbers : {&struts.species, &struts.object}) numbers->clear();
    struts.position.clear();
    struts.id.clear();
    for (std::size_t k = 0; k < packing.size(); ++k) {
        const Vec3& centre = packing.position[k];
        const bool one = std::abs(centre.x() - 3) < 2 && std::abs(centre.y() - 4) < 2;
        const bool other = std::abs(centre.x() - 17) < 2 && std::abs(centre.y() - 16) < 2;
        if (!one && !other) continue;
        struts.position.push_back(centre);
        struts.species.push_back(1);
        struts.object.push_back(0);
        struts.id.push_back(packing.id[k]);
    }
    const CutPlane plane = best_cut(struts);
    const double place = plane.place;
    if (plane.cut == Cut::y)
        EXPECT_TRUE(std::abs(place - 4) < 2 || std::abs(place - 16) < 2) << place;
    else
        EXPECT_TRUE(std::abs(place - 3) < 2 || std::abs(place - 17) < 2) << place;
}

TEST(BestCut, OfVeryFewParticlesIsThereToo) {
    Packing packing = cube({}, Ball::pore);
    for (auto* numbers : {&packing.species, &packing.object}) numbers->resize(2);
    packing.position.resize(2);
    packing.id.resize(2);
    EXPECT_EQ(best_cut(packing).cut, Cut::y);
}

}  // namespace
}  // namespace tomodem::render
