#include "core/packing/structure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Lattice {
    Box box;
    std::vector<Vec3> points;
};

/// Copies of a cell; `edges` and `places` in nearest distances, `places` as fractions of the cell.
Lattice lattice(const Vec3& edges, const std::vector<Vec3>& places, int x, int y, int z) {
    Lattice made{{Vec3(1, -2, 3), edges.cwiseProduct(Vec3(x, y, z)), {true, true, true}}, {}};
    for (int i = 0; i < x; ++i)
        for (int j = 0; j < y; ++j)
            for (int k = 0; k < z; ++k)
                for (const Vec3& place : places)
                    made.points.push_back(made.box.origin + edges.cwiseProduct(Vec3(i, j, k) + place));
    return made;
}

Lattice fcc(int cells = 5) {
    const Vec3 edges = Vec3::Constant(std::numbers::sqrt2);
    return lattice(edges, {Vec3(0, 0, 0), Vec3(.5, .5, 0), Vec3(.5, 0, .5), Vec3(0, .5, .5)}, cells, cells, cells);
}

Lattice hcp() {
    const Vec3 edges(1.0, std::sqrt(3.0), std::sqrt(8.0 / 3.0));
    return lattice(edges, {Vec3(0, 0, 0), Vec3(.5, .5, 0), Vec3(.5, 5.0 / 6.0, .5), Vec3(0, 1.0 / 3.0, .5)}, 7, 4, 4);
}

Lattice bcc() {
    return lattice(Vec3::Constant(2.0 / std::sqrt(3.0)), {Vec3(0, 0, 0), Vec3(.5, .5, .5)}, 6, 6, 6);
}

Lattice simple_cubic() {
    return lattice(Vec3::Constant(1.0), {Vec3(0, 0, 0)}, 7, 7, 7);
}

Lattice shaken(Lattice made, double deviation) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal(0.0, deviation);
    for (Vec3& p : made.points) p += Vec3(normal(random), normal(random), normal(random));
    return made;
}

Lattice gas(std::size_t count, const Vec3& edges, std::array<bool, 3> periodic) {
    Lattice made{{Vec3(-1, 0, 2), edges, periodic}, {}};
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform;
    for (std::size_t i = 0; i < count; ++i)
        made.points.push_back(made.box.origin +
                              edges.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random))));
    return made;
}

std::vector<Order> orders(const Lattice& made) {
    return common_neighbour_analysis(NeighbourTable(made.points, made.box, 1.7, 2), 2);
}

class Neighbours : public testing::TestWithParam<std::tuple<std::array<bool, 3>, double>> {};

TEST_P(Neighbours, AreThoseOfAllPairs) {
    const auto [periodic, cutoff] = GetParam();
    const Lattice made = gas(400, Vec3(3.0, 2.0, 5.0), periodic);
    std::vector<Vec3> points = made.points;
    for (std::size_t i = 0; i < points.size(); i += 7)  // another image, or outside an open face
        points[i].x() += made.box.edges.x();
    const NeighbourTable table(points, made.box, cutoff, 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::vector<std::int32_t> expected;
        for (std::size_t j = 0; j < points.size(); ++j) {
            Vec3 apart = points[j] - points[i];
            for (int axis = 0; axis < 3; ++axis)
                if (periodic[axis])
                    apart[axis] -= made.box.edges[axis] * std::round(apart[axis] / made.box.edges[axis]);
            if (j != i && apart.norm() < cutoff) expected.push_back(static_cast<std::int32_t>(j));
            EXPECT_LT((table.separation(i, j) - apart).norm(), 1e-12);
        }
        const auto found = table.of(i);
        ASSERT_EQ(std::vector(found.begin(), found.end()), expected) << "point " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(AxesAndCutoffs, Neighbours,
                         testing::Combine(testing::Values(std::array{true, true, true}, std::array{true, false, true},
                                                          std::array{false, true, false},
                                                          std::array{false, false, false}),
                                          testing::Values(0.21, 0.6, 1.0)));

TEST(NeighbourTable, RejectsACutoffAboveHalfOfAPeriodicEdgeAndPointsThatAreNoNumbers) {
    const Lattice made = gas(10, Vec3(3.0, 2.0, 5.0), {true, false, true});
    EXPECT_NO_THROW(NeighbourTable(made.points, made.box, 1.5));
    EXPECT_THAT(
        [&] { NeighbourTable(made.points, made.box, 1.51); },
        ThrowsMessage<InvalidInput>(HasSubstr("more than half of the shortest periodic edge of the box, 3 mm")));
    EXPECT_THAT([&] { NeighbourTable(made.points, made.box, 0.0); },
                ThrowsMessage<InvalidInput>(HasSubstr("is not positive")));
    std::vector<Vec3> points = made.points;
    points[3].y() = std::nan("");
    EXPECT_THAT([&] { NeighbourTable(points, made.box, 1.0); },
                ThrowsMessage<InvalidInput>(HasSubstr("point 4 (counted from 1)")));
}

// Five standard deviations: of the Poisson count of pairs in a shell, and in an open box of the share of the shells
// that happens to lie inside, about 0.3 from point to point.
void expect_one_everywhere(const Vec3& edges, std::array<bool, 3> periodic, double reach) {
    const Lattice made = gas(5000, edges, periodic);
    const RadialDistribution found = radial_distribution(made.points, made.box, reach, 20, 2);
    const double count = static_cast<double>(made.points.size());
    const double of_shares = made.box.periodic == std::array{true, true, true} ? 0.0 : 2.0 * 0.3 / std::sqrt(count);
    for (std::size_t k = 0; k < found.g.size(); ++k) {
        const double shell = 4.0 * std::numbers::pi * std::pow(found.radius(k), 2) * found.shell;
        const double pairs = 0.3 * 0.5 * count * count * shell / made.box.volume();
        EXPECT_NEAR(found.g[k], 1.0, 5.0 * std::hypot(1.0 / std::sqrt(pairs), of_shares)) << "shell " << k;
    }
}

TEST(RadialDistribution, OfAnIdealGasIsOneInAnyBox) {
    const Vec3 edges(6.0, 4.0, 9.0);
    expect_one_everywhere(edges, {true, true, true}, 2.0);
    expect_one_everywhere(edges, {true, true, false}, 2.0);
    expect_one_everywhere(edges, {true, false, false}, 3.0);
    expect_one_everywhere(edges, {false, false, false}, 4.0);
}

TEST(RadialDistribution, OfFccHoldsTheNumbersOfItsShells) {
    const Lattice made = fcc();
    const RadialDistribution found = radial_distribution(made.points, made.box, 3.0, 300);
    const double density = static_cast<double>(made.points.size() - 1) / made.box.volume();
    const auto neighbours = [&](double from, double to) {
        double sum = 0.0;
        for (std::size_t k = 0; k < found.g.size(); ++k)
            if (found.radius(k) > from && found.radius(k) < to) {
                const double inner = found.radius(k) - 0.5 * found.shell, outer = inner + found.shell;
                sum += found.g[k] * density * 4.0 / 3.0 * std::numbers::pi *
                       (outer * outer * outer - inner * inner * inner);
            }
        return sum;
    };
    EXPECT_NEAR(neighbours(0.0, 0.95), 0.0, 1e-12);
    EXPECT_NEAR(neighbours(0.95, 1.2), 12.0, 1e-9);
    EXPECT_NEAR(neighbours(1.2, 1.6), 6.0, 1e-9);
    EXPECT_NEAR(neighbours(1.6, 1.9), 24.0, 1e-9);
    EXPECT_NEAR(first_minimum(found, 1.05, 1.7), 0.5 * (1.0 + std::numbers::sqrt2), 0.2);
}

TEST(RadialDistribution, IsTheSameOnAnyNumberOfThreads) {
    const Lattice made = gas(5000, Vec3(3, 3, 3), {true, false, true});
    const auto expected = radial_distribution(made.points, made.box, 1.5, 50, 1).g;
    EXPECT_EQ(radial_distribution(made.points, made.box, 1.5, 50, 2).g, expected);
    EXPECT_EQ(radial_distribution(made.points, made.box, 1.5, 50, 5).g, expected);
}

TEST(RadialDistribution, RejectsWhatTheBoxCannotHold) {
    const Lattice made = gas(50, Vec3(3, 2, 5), {true, false, true});
    EXPECT_DOUBLE_EQ(longest_reach(made.box), 1.5);
    EXPECT_THAT([&] { radial_distribution(made.points, made.box, 1.6, 10); },
                ThrowsMessage<InvalidInput>(HasSubstr("half of the shortest periodic edge")));
    EXPECT_THAT([&] { radial_distribution(std::vector<Vec3>(1, Vec3::Zero()), made.box, 1.0, 10); },
                ThrowsMessage<InvalidInput>(HasSubstr("at least two points")));
    const RadialDistribution brief = radial_distribution(made.points, made.box, 1.0, 10);
    EXPECT_THAT([&] { first_minimum(brief, 1.1, 1.7); }, ThrowsMessage<InvalidInput>(HasSubstr("ends at 1 mm")));
}

TEST(CommonNeighbourAnalysis, FindsEveryParticleOfAPerfectLattice) {
    EXPECT_THAT(orders(fcc()), Each(Order::fcc));
    EXPECT_THAT(orders(hcp()), Each(Order::hcp));
    EXPECT_THAT(orders(bcc()), Each(Order::bcc));
    EXPECT_THAT(orders(simple_cubic()), Each(Order::none));
}

// Displacements of 3 % of the nearest distance on each axis.
TEST(CommonNeighbourAnalysis, FindsEveryParticleOfAShakenLattice) {
    EXPECT_THAT(orders(shaken(fcc(), 0.03)), Each(Order::fcc));
    EXPECT_THAT(orders(shaken(hcp(), 0.03)), Each(Order::hcp));
    EXPECT_THAT(orders(shaken(bcc(), 0.03)), Each(Order::bcc));
    EXPECT_THAT(orders(shaken(simple_cubic(), 0.03)), Each(Order::none));
}

TEST(CommonNeighbourAnalysis, DoesNotDependOnTheScale) {
    Lattice made = shaken(bcc(), 0.02);
    made.box.edges *= 1e-3;
    made.box.origin *= 1e-3;
    for (Vec3& p : made.points) p *= 1e-3;
    EXPECT_THAT(common_neighbour_analysis(NeighbourTable(made.points, made.box, 1.7e-3)), Each(Order::bcc));
}

std::vector<Vec3> icosahedron() {
    std::vector<Vec3> points{Vec3::Zero()};
    for (const double a : {-1.0, 1.0})
        for (const double b : {-std::numbers::phi, std::numbers::phi})
            for (const Vec3& p : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)}) points.push_back(p.normalized());
    return points;
}

const Box open_box{Vec3::Zero(), Vec3::Constant(1.0), {false, false, false}};

TEST(CommonNeighbourAnalysis, FindsTheCentreOfAnIcosahedronAlone) {
    const std::vector<Order> found = common_neighbour_analysis(NeighbourTable(icosahedron(), open_box, 1.7));
    EXPECT_EQ(found[0], Order::icosahedral);
    for (std::size_t i = 1; i < found.size(); ++i) EXPECT_EQ(found[i], Order::none);
}

TEST(CommonNeighbourAnalysis, FindsNoOrderAtTheSurfaceOfACrystal) {
    Lattice made = fcc();
    made.box.periodic = {true, true, false};
    const std::vector<Order> found = orders(made);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double z = made.points[i].z() - made.box.origin.z(), top = made.box.edges.z() - 0.5 * std::numbers::sqrt2;
        EXPECT_EQ(found[i], z > 0.1 && z < top - 0.1 ? Order::fcc : Order::none) << z;
    }
}

TEST(CommonNeighbourAnalysis, FindsAlmostNoOrderInAGas) {
    const Lattice made = gas(3000, Vec3::Constant(14.0), {true, true, true});
    const std::vector<Order> found = orders(made);
    EXPECT_LT(std::count_if(found.begin(), found.end(), [](Order o) { return o != Order::none; }), 3);
}

// Steinhardt et al., Phys. Rev. B 28 (1983) 784, table I; bcc with 8 and 14 neighbours.
TEST(BondOrder, IsTheKnownOneOfEachLattice) {
    const auto expect_q6 = [](const Lattice& made, double cutoff, double expected) {
        const BondOrder found = bond_order(NeighbourTable(made.points, made.box, cutoff), cutoff, 0.5, 2);
        for (const double q6 : found.q6) EXPECT_NEAR(q6, expected, 1e-4);
        return found;
    };
    const auto all_connected = [](const BondOrder& found, int neighbours) {
        EXPECT_THAT(found.connections, Each(neighbours));
    };
    const BondOrder cubic = expect_q6(fcc(), 1.2, 0.57452);
    EXPECT_NEAR(cubic.global_q6, 0.57452, 1e-4);
    all_connected(cubic, 12);
    expect_q6(hcp(), 1.2, 0.48476);
    expect_q6(bcc(), 1.08, 0.62854);
    all_connected(expect_q6(bcc(), 1.4, 0.51069), 14);
    all_connected(expect_q6(simple_cubic(), 1.2, 0.35355), 6);
    const BondOrder centre = bond_order(NeighbourTable(icosahedron(), open_box, 1.02), 1.02);
    EXPECT_NEAR(centre.q6[0], 0.66332, 1e-4);
}

TEST(BondOrder, OfAShakenCrystalStaysConnected) {
    for (const Lattice& made : {shaken(fcc(), 0.03), shaken(hcp(), 0.03), shaken(bcc(), 0.03)}) {
        const BondOrder found = bond_order(NeighbourTable(made.points, made.box, 1.4), 1.35, 0.7);
        EXPECT_GE(*std::min_element(found.connections.begin(), found.connections.end()), 11);
    }
}

TEST(BondOrder, TurnsWithTheCrystal) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.4, 0.5, 0.7).normalized();
    std::vector<Vec3> points = shaken(fcc(3), 0.05).points;
    const std::vector<double> before = bond_order(NeighbourTable(points, open_box, 1.2), 1.2).q6;
    for (Vec3& p : points) p = turn * p;
    const std::vector<double> after = bond_order(NeighbourTable(points, open_box, 1.2), 1.2).q6;
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
}

TEST(BondOrder, OfAGasHasFewSolidLikeConnections) {
    const Lattice made = gas(3000, Vec3::Constant(14.0), {true, true, true});
    const BondOrder found = bond_order(NeighbourTable(made.points, made.box, 1.4), 1.4, 0.7);
    const double bonds = 4.0 / 3.0 * std::numbers::pi * std::pow(1.4, 3) * 3000.0 / std::pow(14.0, 3);
    double connections = 0.0;
    for (const std::int32_t c : found.connections) connections += c / 3000.0;
    EXPECT_LT(connections, 0.1 * bonds);
    EXPECT_LT(found.global_q6, 5.0 / std::sqrt(3000.0 * bonds));
}

TEST(BondOrder, RejectsACutoffBeyondTheTable) {
    const Lattice made = fcc(3);
    const NeighbourTable table(made.points, made.box, 1.2);
    EXPECT_THAT([&] { bond_order(table, 1.3); }, ThrowsMessage<InvalidInput>(HasSubstr("up to 1.2 mm")));
}

Packing packing_of(const Lattice& made, double seed_radius) {
    Packing packing;
    packing.box = made.box;
    packing.position = made.points;
    packing.seed_radius = seed_radius;
    return packing;
}

TEST(ContactStatistics, OfCompressedFccAreTwelveContactsOfOneOverlap) {
    const ContactStatistics contacts = contact_statistics(packing_of(fcc(4), 0.5 / 0.98));
    EXPECT_EQ(contacts.contacts, 256 * 6);
    EXPECT_DOUBLE_EQ(contacts.mean_coordination, 12.0);
    EXPECT_DOUBLE_EQ(contacts.backbone_coordination, 12.0);
    EXPECT_EQ(contacts.rattlers, 0);
    EXPECT_NEAR(contacts.mean_overlap, 0.02, 1e-12);
    EXPECT_NEAR(contacts.max_overlap, 0.02, 1e-12);
}

TEST(ContactStatistics, TakeTheRadiiOfTheParticles) {
    Packing packing = packing_of(simple_cubic(), 0.5);
    packing.radius.assign(packing.size(), 0.45);
    packing.radius[10] = 0.65;  // overlaps its six neighbours: 1.1 over 1
    const ContactStatistics contacts = contact_statistics(packing);
    EXPECT_EQ(contacts.contacts, 6);
    EXPECT_NEAR(contacts.max_overlap, 1.0 - 1.0 / 1.1, 1e-12);
    EXPECT_EQ(contacts.rattlers, 343);  // a star holds nobody
}

TEST(ContactStatistics, CountWallsWhereThereAreSome) {
    Lattice made = simple_cubic();  // 7^3 touching spheres of radius 0.51, their outermost centres 0.5 from the faces
    for (Vec3& p : made.points) p += Vec3::Constant(0.5);
    made.box.periodic = {false, false, false};
    const ContactStatistics walled = contact_statistics(packing_of(made, 0.51), OpenFaces::walls);
    EXPECT_EQ(walled.contacts, 3 * 6 * 49);
    EXPECT_EQ(walled.wall_contacts, 6 * 49);
    EXPECT_DOUBLE_EQ(walled.mean_coordination, 6.0);
    EXPECT_EQ(walled.rattlers, 0);
    // Without walls the corners have 3 contacts; without them the edges have too few, then the faces, then all.
    const ContactStatistics free = contact_statistics(packing_of(made, 0.51));
    EXPECT_EQ(free.wall_contacts, 0);
    EXPECT_EQ(free.rattlers, 343);
    EXPECT_EQ(free.backbone_coordination, 0.0);
}

TEST(ContactStatistics, LeaveOutALoneSphereAndWhatHangsOnIt) {
    Lattice made = fcc(3);
    made.box.edges.z() += 3.0;  // a slab with a gap above it, and a chain of two in the gap
    made.points.push_back(made.box.origin + Vec3(1.0, 1.0, made.box.edges.z() - 1.5));
    made.points.push_back(made.points.back() + Vec3(0.99, 0, 0));
    const ContactStatistics contacts = contact_statistics(packing_of(made, 0.501));
    EXPECT_EQ(contacts.rattlers, 2);
    EXPECT_EQ(contacts.contacts, 3 * 3 * 3 * 4 * 6 - 3 * 3 * 2 * 4 + 1);
}

/// Two labels in turns on a simple cubic lattice: every neighbour at distance 1 is of the other one.
Packing rock_salt() {
    Lattice made = lattice(Vec3::Constant(1.0), {Vec3(0, 0, 0)}, 6, 6, 6);
    Packing packing = packing_of(made, 0.505);
    packing.species.resize(packing.size());
    for (std::size_t i = 0; i < packing.size(); ++i) {
        const Vec3 p = packing.position[i] - made.box.origin;
        packing.species[i] = 1 + std::int32_t(std::llround(p.sum())) % 2;
    }
    return packing;
}

TEST(ContactDetail, TellsWhichLabelsTouch) {
    const ContactDetail detail = contact_detail(rock_salt());
    EXPECT_EQ(detail.all.contacts, 216 * 3);
    EXPECT_EQ(detail.between.size(), 1u);
    const PairContacts& mixed = detail.between.at({1, 2});
    EXPECT_EQ(mixed.contacts, 216 * 3);
    EXPECT_NEAR(mixed.mean_overlap, 1.0 - 1.0 / 1.01, 1e-12);
    EXPECT_THAT(detail.contacts, Each(6));
    EXPECT_THAT(detail.backbone_contacts, Each(6));
}

TEST(ContactDetail, CountsWithinALongerReachButOverlapsOnlyWhereThereIsOne) {
    const ContactDetail detail = contact_detail(rock_salt(), 1.5);  // 1.515: the 12 second neighbours too
    EXPECT_THAT(detail.contacts, Each(18));
    EXPECT_EQ(detail.between.at({1, 1}).contacts, 108 * 6);
    EXPECT_EQ(detail.between.at({1, 1}).max_overlap, 0.0);
    EXPECT_EQ(detail.between.at({2, 2}).contacts, 108 * 6);
    EXPECT_EQ(detail.between.at({1, 2}).contacts, 216 * 3);
    EXPECT_NEAR(detail.all.mean_overlap, 1.0 - 1.0 / 1.01, 1e-12);
}

TEST(ContactDetail, SaysWhichParticlesAreRattlers) {
    Lattice made = fcc(3);
    made.box.edges.z() += 3.0;
    made.points.push_back(made.box.origin + Vec3(1.0, 1.0, made.box.edges.z() - 1.5));
    const ContactDetail detail = contact_detail(packing_of(made, 0.501), 1.0, OpenFaces::free, 2);
    EXPECT_EQ(std::count(detail.rattler.begin(), detail.rattler.end(), 1), 1);
    EXPECT_EQ(detail.rattler.back(), 1);
    EXPECT_EQ(detail.backbone_contacts.back(), 0);
}

TEST(SurfacePoints, AreNoneInAPeriodicLatticeShakenOrNot) {
    for (const Lattice& made : {fcc(), hcp(), bcc(), shaken(fcc(), 0.03), shaken(bcc(), 0.03)}) {
        const NeighbourTable near(made.points, made.box, 1.7);
        EXPECT_THAT(surface_points(near, 2), Each(0));
    }
}

TEST(SurfacePoints, AreTheOutermostLayersOfACrystal) {
    Lattice made = shaken(fcc(6), 0.02);
    made.box.periodic = {true, true, false};  // a slab of twelve layers
    const auto surface = surface_points(NeighbourTable(made.points, made.box, 1.7));
    for (std::size_t i = 0; i < made.points.size(); ++i) {
        const auto layer = std::lround((made.points[i].z() - made.box.origin.z()) * std::numbers::sqrt2);
        EXPECT_EQ(surface[i], layer == 0 || layer == 11 ? 1 : 0) << "layer " << layer;
    }
}

TEST(SurfacePoints, AreAllOfASheetOrAChain) {
    std::vector<Vec3> sheet, chain;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) sheet.emplace_back(i + 0.5 * (j % 2), j * std::sqrt(0.75), 0.0);
    for (int i = 0; i < 9; ++i) chain.emplace_back(i, 0.0, 0.0);
    const Box open{Vec3::Zero(), Vec3::Constant(10), {false, false, false}};
    EXPECT_THAT(surface_points(NeighbourTable(sheet, open, 1.7)), Each(1));
    EXPECT_THAT(surface_points(NeighbourTable(chain, open, 1.7)), Each(1));
}

}  // namespace
}  // namespace tomodem
