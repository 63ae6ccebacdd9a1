#include "tools/packgen/compaction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <ostream>

#include "core/base/error.hpp"
#include "core/packing/structure.hpp"
#include "tests/unit/packgen/packing_measures.hpp"
#include "tools/packgen/contact_force.hpp"

namespace tomodem::packgen {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// Several tests look at the same packing of 4000 spheres.
const CompactedPacking& made(double density) {
    static std::map<double, CompactedPacking> packings;
    const auto [place, is_new] = packings.try_emplace(density);
    if (is_new) place->second = compact({.particles = 4000, .density = density, .threads = 2});
    return place->second;
}

TEST(Compaction, HasTheDensityThatWasAskedFor) {
    for (const double density : {0.1, 0.3, 0.64, 0.74, 0.85}) {
        const Packing packing = compact({.particles = 500, .density = density, .seed_radius = 0.0125}).packing;
        EXPECT_NEAR(packing.density(), density, 1e-13);
        EXPECT_EQ(packing.size(), 500U);
    }
}

TEST(Compaction, GivesSortedIdsOfOneSpeciesInsideAPeriodicCubeAtTheOrigin) {
    const Packing& packing = made(0.70).packing;
    EXPECT_EQ(packing.box.origin, Vec3::Zero());
    EXPECT_EQ(packing.box.edges, Vec3::Constant(packing.box.edges[0]));
    EXPECT_EQ(packing.box.periodic, (std::array<bool, 3>{true, true, true}));
    EXPECT_FALSE(packing.relaxed);
    EXPECT_TRUE(packing.object.empty());
    for (std::size_t i = 0; i < packing.size(); ++i) {
        EXPECT_EQ(packing.id[i], static_cast<std::int64_t>(i) + 1);
        EXPECT_EQ(packing.species[i], 1);
        EXPECT_TRUE((packing.position[i].array() >= 0.0).all());
        EXPECT_TRUE((packing.position[i].array() < packing.box.edges[0]).all());
    }
}

TEST(Compaction, PutsParticlesOfCloseIdsCloseTogether) {
    const Packing& packing = made(0.70).packing;
    double steps = 0.0;
    for (std::size_t i = 1; i < packing.size(); ++i) steps += (packing.position[i] - packing.position[i - 1]).norm();
    // At random it would be two thirds of the edge, ten diameters.
    EXPECT_LT(steps / static_cast<double>(packing.size() - 1), 2.0);
}

TEST(Compaction, HasTheSameBitsOnAnyNumberOfThreads) {
    const Compaction wanted{.particles = 1000, .density = 0.70, .random_seed = 7};
    const std::vector<Vec3> expected = compact(wanted).packing.position;
    for (const int threads : {2, 3, 5}) {
        Compaction parallel = wanted;
        parallel.threads = threads;
        EXPECT_EQ(compact(parallel).packing.position, expected) << threads << " threads";
    }
}

TEST(Compaction, HasTheSameBitsOnEveryInstructionSet) {
    const Compaction wanted{.particles = 300, .density = 0.70};
    const std::vector<Vec3> expected = compact(wanted).packing.position;
    use_instruction_set(InstructionSet::baseline);
    const std::vector<Vec3> baseline = compact(wanted).packing.position;
    use_instruction_set(InstructionSet::best);
    EXPECT_EQ(baseline, expected);
}

TEST(Compaction, DependsOnTheRandomSeedButScalesWithTheRadius) {
    const Compaction wanted{.particles = 200, .density = 0.65};
    Compaction reseeded = wanted, larger = wanted;
    reseeded.random_seed = 2;
    larger.seed_radius = 4.0 * wanted.seed_radius;
    const Packing packing = compact(wanted).packing;
    EXPECT_NE(compact(reseeded).packing.position, packing.position);
    const Packing scaled = compact(larger).packing;
    for (std::size_t i = 0; i < packing.size(); ++i)
        EXPECT_LT((scaled.position[i] - 4.0 * packing.position[i]).norm(), 1e-12);
}

TEST(Compaction, LeavesSmallNetForces) {
    const CompactedPacking& rest = made(0.70);
    std::vector<Vec3> force(rest.packing.size(), Vec3::Zero());
    for (const Pair& pair : pairs_within(rest.packing, 1.0)) {
        const Vec3 f = (1.0 - pair.distance) * pair.direction;
        force[pair.i] -= f;
        force[pair.j] += f;
    }
    double squared = 0.0;
    for (const Vec3& f : force) squared += f.squaredNorm();
    const double net = std::sqrt(squared / static_cast<double>(force.size()));
    EXPECT_NEAR(net, rest.residual, 1e-9);
    EXPECT_LE(rest.residual, 1e-3 * rest.load);
}

TEST(Compaction, BelowJammingEndsWithoutOverlap) {
    for (const double density : {0.3, 0.5, 0.6}) {
        // Net forces of 1e-6 k d are left; the largest of 4000 overlaps may be some tens of times that.
        EXPECT_LT(contact_statistics(made(density).packing).max_overlap, 1e-4) << "density " << density;
    }
}

// Random close packing of frictionless spheres: 6 contacts a particle (isostatic, Maxwell's count 2 x 3), a few percent
// of rattlers without any, and no overlap. D = 0.64 is within 0.003 of jamming, where dZ = 7.7 sqrt(D - D_J) and
// overlaps are (D - D_J) / 3 D: hence Z up to 6.4 and 0.2 %. O'Hern et al., Phys. Rev. E 68 (2003) 011306.
TEST(Compaction, AtRandomClosePackingTouchesSixNeighboursWithoutOverlap) {
    const ContactStatistics contacts = contact_statistics(made(0.64).packing);
    EXPECT_NEAR(contacts.mean_coordination, 6.1, 0.4);
    EXPECT_LT(contacts.mean_overlap, 2.5e-3);
    EXPECT_LT(contacts.max_overlap, 1.5e-2);
}

// Overlaps of a linear law grow in proportion to D - D_J, so two densities give the jamming density: 0.639 +- 0.001 for
// rapidly quenched spheres in O'Hern et al.; 0.005 more for the curvature between these densities.
TEST(Compaction, JamsAtTheKnownDensity) {
    const double low = contact_statistics(made(0.66).packing).mean_overlap;
    const double high = contact_statistics(made(0.70).packing).mean_overlap;
    EXPECT_NEAR(0.66 - low * (0.70 - 0.66) / (high - low), 0.639, 0.006);
}

TEST(Compaction, AtHighDensityOverlapsModerately) {
    const ContactStatistics contacts = contact_statistics(made(0.74).packing);
    // An affine squeeze from 0.64 would give (0.74 / 0.64)^(1/3) - 1 = 0.050; new contacts with less dilute the mean.
    EXPECT_NEAR(contacts.mean_overlap, 0.035, 0.015);
    EXPECT_LT(contacts.max_overlap, 0.2);
    EXPECT_NEAR(contacts.mean_coordination, 6.0 + 7.7 * std::sqrt(0.74 - 0.639), 0.6);
}

class Structure : public testing::TestWithParam<double> {};

TEST_P(Structure, IsAmorphous) {
    const Packing& packing = made(GetParam()).packing;
    const std::vector<double> g = radial_distribution(packing, 6.0, 120);  // shells of 0.05 d
    // First peak at contact, the deep minimum where a cubic crystal has its second shell (sqrt 2), the second peak
    // that ends at 2 d, and no order from 4 d on.
    const auto peak = static_cast<std::size_t>(std::max_element(g.begin(), g.end()) - g.begin());
    EXPECT_NEAR((static_cast<double>(peak) + 0.5) * 0.05, GetParam() > 0.7 ? 0.97 : 1.0, 0.05);
    EXPECT_LT(g[28], 0.8);
    EXPECT_GT(*std::max_element(g.begin() + 34, g.begin() + 41), 1.2);
    for (std::size_t shell = 80; shell < g.size(); ++shell) EXPECT_NEAR(g[shell], 1.0, 0.08) << "shell " << shell;
    EXPECT_LT(global_q6(pairs_within(packing, 1.3)), 0.05);
}

TEST_P(Structure, IsIsotropic) {
    const std::vector<Pair> contacts = pairs_within(made(GetParam()).packing, 1.02);
    const Eigen::Vector3d share = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(fabric(contacts)).eigenvalues();
    // Independent directions scatter by sqrt(4 / 45 / contacts) about one third.
    const double scatter = std::sqrt(4.0 / 45.0 / static_cast<double>(contacts.size()));
    EXPECT_LT((share.array() - 1.0 / 3.0).abs().maxCoeff(), 5.0 * scatter);
}

TEST_P(Structure, IsHomogeneous) {
    // 64 cells of 62 spheres: independent points would give 1.
    EXPECT_LT(number_variance(made(GetParam()).packing, 4), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Densities, Structure, testing::Values(0.64, 0.70, 0.74));

TEST(Measures, DistinguishACrystalFromAGlass) {
    const Packing crystal = fcc(6);
    EXPECT_NEAR(global_q6(pairs_within(crystal, 1.3)), 0.575, 0.001);
    EXPECT_GT(radial_distribution(crystal, 4.0, 80)[28], 2.0);  // the second shell at sqrt 2
}

TEST(ContactStatistics, AreThoseOfAllPairs) {
    const Packing& packing = made(0.70).packing;
    const std::vector<Pair> pairs = pairs_within(packing, 1.0);
    const ContactStatistics contacts = contact_statistics(packing);
    EXPECT_EQ(contacts.contacts, static_cast<std::int64_t>(pairs.size()));
    double largest = 0.0, sum = 0.0;
    for (const Pair& pair : pairs) {
        largest = std::max(largest, 1.0 - pair.distance);
        sum += 1.0 - pair.distance;
    }
    EXPECT_NEAR(contacts.max_overlap, largest, 1e-12);
    EXPECT_NEAR(contacts.mean_overlap, sum / static_cast<double>(pairs.size()), 1e-12);
}

// A hash of every bit: bricks that were kept, and those of papers, can be made again. A change of this number is a
// change of algorithm_version (brick_cache.hpp).
TEST(Compaction, MakesTheSameParticlesFromVersionToVersion) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const Vec3& p : compact({.particles = 200, .density = 0.65}).packing.position)
        for (const double s : {p.x(), p.y(), p.z()}) hash = (hash ^ std::bit_cast<std::uint64_t>(s)) * 0x100000001b3ULL;
    EXPECT_EQ(hash, 11470902264872419445ULL);
}

struct Shape {
    double dispersion;
    std::array<double, 3> aspect;
    std::array<bool, 3> periodic;
};

void PrintTo(const Shape& shape, std::ostream* out) {
    *out << "dispersion " << shape.dispersion << " aspect " << shape.aspect[0] << ":" << shape.aspect[1] << ":"
         << shape.aspect[2] << " periodic " << shape.periodic[0] << shape.periodic[1] << shape.periodic[2];
}

class AnyShape : public testing::TestWithParam<Shape> {
 protected:
    static Compaction wanted(std::int64_t particles, double density) {
        const Shape& shape = GetParam();
        return {.particles = particles,
                .density = density,
                .seed_radius = 0.25,
                .dispersion = shape.dispersion,
                .aspect = shape.aspect,
                .periodic = shape.periodic};
    }
};

TEST_P(AnyShape, HasTheSameBitsOnAnyNumberOfThreadsAndInstructionSet) {
    Compaction parallel = wanted(600, 0.68);
    const Packing expected = compact(parallel).packing;
    for (const int threads : {2, 3}) {
        parallel.threads = threads;
        const Packing found = compact(parallel).packing;
        EXPECT_EQ(found.position, expected.position) << threads << " threads";
        EXPECT_EQ(found.radius, expected.radius) << threads << " threads";
    }
    use_instruction_set(InstructionSet::baseline);
    const Packing baseline = compact(parallel).packing;
    use_instruction_set(InstructionSet::best);
    EXPECT_EQ(baseline.position, expected.position);
}

TEST_P(AnyShape, HasTheBoxTheRadiiAndTheDensityThatWereAskedFor) {
    const Shape& shape = GetParam();
    for (const double density : {0.55, 0.76}) {
        const CompactedPacking made = compact(wanted(1000, density));
        const Packing& packing = made.packing;
        double volume = 0.0, mean = 0.0, variance = 0.0;
        for (std::size_t i = 0; i < packing.size(); ++i) {
            volume += 4.0 / 3.0 * std::numbers::pi * std::pow(packing.radius_of(i), 3);
            mean += packing.radius_of(i) / 1000.0;
        }
        for (std::size_t i = 0; i < packing.size(); ++i) variance += std::pow(packing.radius_of(i) - mean, 2) / 1000.0;
        EXPECT_NEAR(volume / packing.box.volume(), density, 1e-12);
        EXPECT_NEAR(packing.density(), density, 1e-12);
        EXPECT_NEAR(mean, 0.25, 1e-12);
        EXPECT_NEAR(std::sqrt(variance) / mean, shape.dispersion, 1e-12);
        EXPECT_EQ(packing.radius.empty(), shape.dispersion == 0.0);
        EXPECT_EQ(packing.box.periodic, shape.periodic);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(packing.box.edges[axis] / packing.box.edges[0], shape.aspect[axis] / shape.aspect[0], 1e-12);
            for (const Vec3& p : packing.position) {
                EXPECT_GE(p[axis], 0.0);
                EXPECT_LE(p[axis], packing.box.edges[axis]);
            }
        }
        // Below jamming there is room for all, the walls' spheres too; above, the overlaps of a random packing.
        const ContactStatistics contacts = contact_statistics(packing, OpenFaces::walls);
        EXPECT_LT(contacts.max_overlap, density < 0.6 ? 2e-4 : 0.4);
        if (density > 0.6) {
            EXPECT_NEAR(contacts.mean_coordination, 9.2, 1.0);
        }
    }
}

TEST_P(AnyShape, IsAtRest) {
    const CompactedPacking made = compact(wanted(1000, 0.72));
    const Packing& packing = made.packing;
    const double d = 2.0 * packing.seed_radius;
    double squared = 0.0, load = 0.0;
    for (std::size_t i = 0; i < packing.size(); ++i) {
        Vec3 force = Vec3::Zero();
        const auto push = [&](double depth, const Vec3& direction) {
            if (depth <= 0.0) return;
            force += depth / d * direction;
            load += depth / d;
        };
        for (std::size_t j = 0; j < packing.size(); ++j) {
            if (j == i) continue;
            Vec3 apart = packing.position[i] - packing.position[j];
            for (int axis = 0; axis < 3; ++axis) {
                const double edge = packing.box.edges[axis];
                if (packing.box.periodic[axis]) apart[axis] -= edge * std::nearbyint(apart[axis] / edge);
            }
            push(packing.radius_of(i) + packing.radius_of(j) - apart.norm(), apart.normalized());
        }
        for (int axis = 0; axis < 3; ++axis)
            if (!packing.box.periodic[axis]) {
                push(packing.radius_of(i) - packing.position[i][axis], Vec3::Unit(axis));
                push(packing.radius_of(i) - (packing.box.edges[axis] - packing.position[i][axis]), -Vec3::Unit(axis));
            }
        squared += force.squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(squared / 1000.0), made.residual, 1e-9);
    EXPECT_NEAR(load / 1000.0, made.load, 1e-9);
    EXPECT_LE(made.residual, 1e-3 * made.load);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, AnyShape,
    testing::Values(Shape{0.0, {1, 1, 1}, {true, true, true}}, Shape{0.2, {1, 1, 1}, {true, true, true}},
                    Shape{0.0, {1, 1, 10}, {true, true, true}}, Shape{0.0, {10, 1, 1}, {true, false, true}},
                    Shape{0.1, {1, 2, 1.5}, {false, true, false}}, Shape{0.2, {2, 1, 1}, {false, false, false}}));

TEST(Compaction, DrawsRadiiFromANormalDistributionCutAtThreeStandardDeviations) {
    std::vector<double> radius = compact({.particles = 20000, .density = 0.3, .dispersion = 0.1}).packing.radius;
    std::sort(radius.begin(), radius.end());
    // Stretched by 1 / 0.98658, the standard deviation of a normal variable that is cut at 3.
    EXPECT_GT(radius.front(), 0.5 * (1 - 0.3045));
    EXPECT_LT(radius.back(), 0.5 * (1 + 0.3045));
    EXPECT_GT(radius.back(), 0.5 * (1 + 0.29));
    double worst = 0.0;  // Kolmogorov's distance; 1.95 / sqrt(N) is exceeded once in 1000
    for (std::size_t i = 0; i < radius.size(); ++i) {
        const double deviate = (radius[i] / 0.5 - 1.0) / 0.1 * 0.98658;
        const double normal = 0.5 * std::erfc(-deviate / std::numbers::sqrt2), tail = 0.00134990;
        worst = std::max(worst, std::abs((normal - tail) / (1 - 2 * tail) - (static_cast<double>(i) + 0.5) / 20000));
    }
    EXPECT_LT(worst, 1.95 / std::sqrt(20000.0));
}

TEST(Compaction, OfWalledSpheresTouchesTheWalls) {
    const Packing packing = compact({.particles = 2000, .density = 0.62, .periodic = {true, true, false}}).packing;
    std::int64_t below = 0, above = 0;
    for (const Vec3& p : packing.position) {
        below += p.z() < 0.5 + 1e-3;
        above += p.z() > packing.box.edges.z() - 0.5 - 1e-3;
        EXPECT_GT(p.z(), 0.5 - 5e-3);
    }
    // A layer at a wall: near to the density of a triangular or square lattice of touching discs.
    const double section = packing.box.edges.x() * packing.box.edges.y();
    EXPECT_GT(static_cast<double>(below), 0.5 * section);
    EXPECT_GT(static_cast<double>(above), 0.5 * section);
}

// Dispersed spheres jam denser, by about 0.013 at 20 % (Desmond & Weeks, Phys. Rev. E 90 (2014) 022204), so at one
// density they overlap less.
TEST(Compaction, OfDispersedSpheresIsLooserAtTheSameDensity) {
    const auto overlap = [](double dispersion) {
        return contact_statistics(
                   compact({.particles = 3000, .density = 0.68, .dispersion = dispersion, .threads = 2}).packing)
            .mean_overlap;
    };
    EXPECT_LT(overlap(0.2), overlap(0.0));
}

TEST(Compaction, WorksInTheSmallestBox) {
    for (const std::int64_t seed : {1, 2, 3, 4, 5}) {
        const CompactedPacking rest = compact({.particles = 20, .density = 0.65, .random_seed = seed});
        EXPECT_LT(contact_statistics(rest.packing).max_overlap, 0.15);
    }
    EXPECT_EQ(compact({.particles = 3, .density = 0.1}).packing.size(), 3U);
}

TEST(Compaction, ReportsItsProgressFromNoneToAll) {
    double first = -1.0, last = -1.0;
    compact({.particles = 200, .density = 0.7, .progress = [&](double done) {
                 if (first < 0.0) first = done;
                 EXPECT_GE(done, 0.0);
                 EXPECT_LE(done, 1.0);
                 last = done;
             }});
    EXPECT_LT(first, 0.01);
    EXPECT_GT(last, 0.6);
}

TEST(Compaction, RejectsADensityOutOfRange) {
    for (const double density : {0.0999, 0.851, -1.0, std::nan("")}) {
        EXPECT_THAT([&] { compact({.particles = 1000, .density = density}); },
                    ThrowsMessage<InvalidInput>(HasSubstr("is out of range: expected 0.1 to 0.85")));
    }
}

TEST(Compaction, RejectsABoxShorterThanThreeCrownRadiiAndSaysHowManyParticlesFillIt) {
    EXPECT_THAT([] { compact({.particles = 14, .density = 0.65}); },
                ThrowsMessage<InvalidInput>(HasSubstr("take at least 15 particles")));
    EXPECT_NO_THROW(compact({.particles = 15, .density = 0.65}));
}

TEST(Compaction, RejectsADispersionAndAnAspectOutOfRange) {
    EXPECT_THAT([] { compact({.particles = 1000, .density = 0.7, .dispersion = 0.21}); },
                ThrowsMessage<InvalidInput>(HasSubstr("dispersion 0.21 is out of range: expected 0 to 0.2")));
    for (const std::array<double, 3> aspect : {std::array{1.0, 0.0, 1.0}, {1.0, 101.0, 1.0}, {1.0, -1.0, 1.0}})
        EXPECT_THAT([&] { compact({.particles = 1000, .density = 0.7, .aspect = aspect}); },
                    ThrowsMessage<InvalidInput>(HasSubstr("is out of range: expected three positive numbers")));
}

TEST(Compaction, RejectsAnElongatedBoxThatIsTooThinAndSaysHowManyParticlesFillIt) {
    EXPECT_THAT(
        [] {
            compact({.particles = 141, .density = 0.65, .aspect = {1, 1, 10}});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("take at least 142 particles")));
    EXPECT_NO_THROW(compact({.particles = 142, .density = 0.65, .aspect = {1, 1, 10}}));
    EXPECT_THAT([] { compact({.particles = 20, .density = 0.65, .dispersion = 0.2}); },
                ThrowsMessage<InvalidInput>(HasSubstr("three crown radii of the largest sphere")));
}

TEST(Compaction, SaysWhenItDidNotComeToRest) {
    EXPECT_THAT([] { compact({.particles = 100, .density = 0.7, .max_steps = 3}); },
                ThrowsMessage<InvalidInput>(HasSubstr("did not come to rest in 3 steps")));
}

}  // namespace
}  // namespace tomodem::packgen
