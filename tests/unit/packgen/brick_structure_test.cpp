#include "tools/packgen/brick_structure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/packgen/packing_measures.hpp"
#include "tools/packgen/compaction.hpp"

namespace tomodem::packgen {
namespace {

/// 5000 equal spheres at random close packing; shares of it scatter by 1e-3 and less.
const BrickStructure& random_close_packing() {
    static const BrickStructure found =
        structure_of(compact({.particles = 5000, .density = 0.64, .threads = 2}).packing, 2);
    return found;
}

/// Mean of g over distances of a brick of d = 1.
double mean_g(const RadialDistribution& distribution, double from, double to) {
    double sum = 0.0, shells = 0.0;
    for (std::size_t k = 0; k < distribution.g.size(); ++k)
        if (distribution.radius(k) > from && distribution.radius(k) < to) {
            sum += distribution.g[k];
            shells += 1.0;
        }
    return sum / shells;
}

// The contact peak, the split second peak with its maxima at sqrt 3 d (two triangles in a plane) and 2 d (three in a
// row), the drop behind 2 d, and nothing at sqrt 2 d, where cubic crystals have their second shell: Silbert, Liu &
// Nagel, Phys. Rev. E 73 (2006) 041304; Donev, Torquato & Stillinger, Phys. Rev. E 71 (2005) 011105.
TEST(RandomClosePacking, HasThePeaksOfItsRadialDistribution) {
    const RadialDistribution& g = random_close_packing().distribution;
    EXPECT_NEAR(g.shell, 0.02, 1e-12);
    const auto largest = static_cast<std::size_t>(std::max_element(g.g.begin(), g.g.end()) - g.g.begin());
    EXPECT_NEAR(g.radius(largest), 1.0, 0.011);
    EXPECT_EQ(mean_g(g, 0.0, 0.97), 0.0);
    const auto highest = [&](double from, double to) {
        std::size_t best = 0;
        for (std::size_t k = 0; k < g.g.size(); ++k)
            if (g.radius(k) > from && g.radius(k) < to && (best == 0 || g.g[k] > g.g[best])) best = k;
        return g.radius(best);
    };
    EXPECT_NEAR(highest(1.5, 1.85), std::sqrt(3.0), 0.03);
    EXPECT_NEAR(highest(1.85, 2.3), 2.0, 0.03);
    EXPECT_GT(mean_g(g, 1.72, 1.76), 1.08 * mean_g(g, 1.80, 1.86));  // the split
    EXPECT_GT(mean_g(g, 1.96, 2.0), 1.5 * mean_g(g, 2.02, 2.06));    // the drop
    EXPECT_LT(mean_g(g, 1.39, 1.44), 0.7);
    EXPECT_LT(mean_g(g, 1.39, 1.44), 1.15 * mean_g(g, 1.33, 1.39));  // no peak there
    EXPECT_NEAR(mean_g(g, 4.5, 5.0), 1.0, 0.02);
}

// Isostatic: 6 contacts for each sphere that is held (O'Hern et al., Phys. Rev. E 68 (2003) 011306). At 0.64, up to
// 0.003 above jamming, dZ = 7.7 sqrt(D - D_J) adds up to 0.42. Rattlers: 1.5 to 2.5 % at jamming (Donev et al. 2005;
// Atkinson, Stillinger & Torquato, Phys. Rev. E 88 (2013) 062208), fewer above it.
TEST(RandomClosePacking, TouchesSixNeighboursAndHasFewRattlers) {
    const ContactStatistics& contacts = random_close_packing().contacts;
    EXPECT_NEAR(contacts.backbone_coordination, 6.2, 0.3);
    const double rattlers = static_cast<double>(contacts.rattlers) / 5000.0;
    EXPECT_GT(rattlers, 0.003);
    EXPECT_LT(rattlers, 0.03);
}

// No local fcc or hcp below a density of 0.649 (Kapfer, Mickel, Mecke & Schroeder-Turk, Phys. Rev. E 85 (2012) 030301,
// by Minkowski tensors of exactly crystalline cells). Common-neighbour analysis tells topologies, so it calls some
// loose shells crystalline too: 1 % is allowed, and 2 % for solid-like bonds; a packing with nuclei has many times
// that.
TEST(RandomClosePacking, HasNoCrystals) {
    const BrickStructure& found = random_close_packing();
    EXPECT_LT(found.crystalline(), 0.01);
    EXPECT_LT(found.icosahedral, 0.01);
    EXPECT_LT(found.solid_like, 0.02);
    EXPECT_LT(found.global_q6, 0.03);  // about 1 / sqrt(bonds) = 0.004 were bonds independent
    EXPECT_NEAR(found.mean_q6, 0.40, 0.05);
    EXPECT_NEAR(found.bond_cutoff, 1.36, 0.08);
}

TEST(BrickStructure, OfACrystalIsThatOfItsLattice) {
    const BrickStructure found = structure_of(fcc(5));
    EXPECT_EQ(found.fcc, 1.0);
    EXPECT_EQ(found.crystalline(), 1.0);
    EXPECT_NEAR(found.mean_q6, 0.57452, 1e-4);
    EXPECT_NEAR(found.global_q6, 0.57452, 1e-4);
    EXPECT_NEAR(found.solid_like, 1.0, 1e-9);
    EXPECT_GT(mean_g(found.distribution, 1.39, 1.44), 2.0);
}

// Too short for a table of neighbours by itself, and for a radial distribution up to 1.7 d.
TEST(BrickStructure, OfASmallBoxIsThatOfItsRepetition) {
    const BrickStructure found = structure_of(fcc(2));
    EXPECT_EQ(found.fcc, 1.0);
    EXPECT_NEAR(found.global_q6, 0.57452, 1e-4);
    EXPECT_NEAR(found.distribution.reach(), std::sqrt(2.0), 0.02);
    EXPECT_DOUBLE_EQ(found.bond_cutoff, 1.4);
}

TEST(BrickStructure, BetweenWallsSeesLayers) {
    const Packing walled = compact({.particles = 3000, .density = 0.62, .periodic = {true, true, false}}).packing;
    const BrickStructure found = structure_of(walled, 2);
    EXPECT_GT(found.contacts.wall_contacts, 100);
    EXPECT_LT(found.crystalline(), 0.05);
    EXPECT_NEAR(mean_g(found.distribution, 4.0, 5.0), 1.0, 0.05);
}

TEST(BrickStructure, IsTheSameOnAnyNumberOfThreads) {
    const Packing packing = compact({.particles = 2500, .density = 0.66, .dispersion = 0.1}).packing;
    const BrickStructure one = structure_of(packing, 1), three = structure_of(packing, 3);
    EXPECT_EQ(one.distribution.g, three.distribution.g);
    EXPECT_EQ(one.mean_q6, three.mean_q6);
    EXPECT_EQ(one.global_q6, three.global_q6);
    EXPECT_EQ(one.contacts.mean_overlap, three.contacts.mean_overlap);
}

}  // namespace
}  // namespace tomodem::packgen
