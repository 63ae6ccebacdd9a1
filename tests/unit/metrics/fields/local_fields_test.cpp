#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"
#include "tools/metrics/fields/field_radius.hpp"
#include "tools/metrics/fields/local_strain_fit.hpp"
#include "tools/metrics/fields/space_average.hpp"
#include "tools/metrics/fields/summary.hpp"

namespace tomodem::fields {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using testing::Pointwise;
using testing::ThrowsMessage;

const Box open_box{Vec3::Zero(), Vec3::Constant(10), {false, false, false}};

std::vector<Vec3> random_points(std::size_t count, double edge) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(0.0, edge);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random), uniform(random));
    return points;
}

std::vector<Vec3> mapped(const std::vector<Vec3>& points, const Eigen::Matrix3d& F) {
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.push_back(F * p + Vec3(3, -1, 2));
    return result;
}

Eigen::Matrix3d matrix(const Symmetric& s) {
    Eigen::Matrix3d m;
    m << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
    return m;
}

const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();

TEST(LocalStrain, OfAnyAffineMapIsThatOfTheMap) {
    const Vec3 stretch(std::exp(0.3), std::exp(-0.1), std::exp(-0.5));
    const Eigen::Matrix3d own_axes = Eigen::AngleAxisd(0.4, Vec3::UnitX()).toRotationMatrix();
    const Eigen::Matrix3d F = rotation * own_axes * stretch.asDiagonal() * own_axes.transpose();
    const auto points = random_points(800, 5.0);
    const LocalStrain strain = local_strain(points, open_box, mapped(points, F), open_box, 1.5, 1.0, {}, 2);
    ASSERT_EQ(strain.degenerate, 0);
    // In the present axes: turned with the map.
    const Eigen::Matrix3d turned = rotation * own_axes;
    const Eigen::Matrix3d expected = turned * Vec3(0.3, -0.1, -0.5).asDiagonal() * turned.transpose();
    const Vec3 deviator = Vec3(0.3, -0.1, -0.5) - Vec3::Constant(-0.1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_TRUE(matrix(strain.logarithmic[i]).isApprox(expected, 1e-10));
        EXPECT_TRUE(matrix(strain.small[i]).isApprox(0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity(), 1e-10));
        EXPECT_NEAR(strain.volumetric[i], -0.3, 1e-10);
        EXPECT_NEAR(strain.equivalent[i], std::sqrt(2.0 / 3.0) * deviator.norm(), 1e-10);
        EXPECT_NEAR(strain.non_affine[i], 0.0, 1e-12);
    }
}

TEST(LocalStrain, OfATurnIsNoneButTheLinearOneSeesIt) {
    const auto points = random_points(300, 4.0);
    const LocalStrain strain = local_strain(points, open_box, mapped(points, rotation), open_box, 2.0, 1.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_THAT(strain.logarithmic[i], Pointwise(DoubleNear(1e-12), Symmetric{}));
        EXPECT_NEAR(strain.equivalent[i], 0.0, 1e-12);
        EXPECT_NEAR(strain.small[i][0], rotation(0, 0) - 1.0, 1e-12);
    }
}

TEST(LocalStrain, OfOneDisplacedParticleIsAllNonAffine) {
    auto points = synthetic::cube(5, 1.0);
    const std::vector<Vec3> before = points;
    const std::size_t middle = 2 * 36 + 2 * 6 + 2;
    const Vec3 moved(0.3, 0.1, -0.2);
    points[middle] += moved;
    const LocalStrain strain = local_strain(before, open_box, points, open_box, 1.2, 0.5);
    EXPECT_NEAR(strain.equivalent[middle], 0.0, 1e-12);  // its six neighbours lie around it as before
    EXPECT_NEAR(strain.non_affine[middle], moved.squaredNorm() / 0.25, 1e-12);
    // A particle far away has not moved.
    EXPECT_NEAR(strain.non_affine[3 * 36 + 3 * 6 + 3], 0.0, 1e-12);
}

TEST(LocalStrain, SeesNeighboursThroughPeriodicSidesThatMoveWithTheBox) {
    const Box before{Vec3(-1, 0, 1), Vec3(5, 5, 5), {true, true, false}};
    std::vector<Vec3> points = random_points(700, 5.0);
    for (Vec3& p : points) p += before.origin;
    points[0].x() += 2 * before.edges.x();  // it crossed two sides long ago
    const Vec3 stretch(1.2, 0.7, 0.9);
    Box after = before;
    after.edges = before.edges.cwiseProduct(stretch);
    std::vector<Vec3> present;
    for (const Vec3& p : points) present.push_back(p.cwiseProduct(stretch));
    const LocalStrain strain = local_strain(points, before, present, after, 1.2, 1.0);
    EXPECT_EQ(strain.degenerate, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(strain.logarithmic[i][0], std::log(1.2), 1e-10);
        EXPECT_NEAR(strain.logarithmic[i][1], std::log(0.7), 1e-10);
        EXPECT_NEAR(strain.non_affine[i], 0.0, 1e-12);
    }
}

TEST(LocalStrain, IsNoneWhereNeighboursAreFewOrFlatOrInsideOut) {
    std::vector<Vec3> sheet;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) sheet.emplace_back(i, j, 0.0);
    const LocalStrain flat = local_strain(sheet, open_box, sheet, open_box, 2.1, 1.0);
    EXPECT_EQ(flat.degenerate, 36);
    EXPECT_TRUE(std::isnan(flat.equivalent[14]) && std::isnan(flat.non_affine[14]) && std::isnan(flat.small[14][0]));

    const std::vector<Vec3> two{Vec3(0, 0, 0), Vec3(0.5, 0.5, 0.5)};
    EXPECT_EQ(local_strain(two, open_box, two, open_box, 2.0, 1.0).degenerate, 2);

    const auto points = random_points(200, 3.0);
    const Eigen::Matrix3d mirror = Vec3(-1, 1, 1).asDiagonal();
    EXPECT_EQ(local_strain(points, open_box, mapped(points, mirror), open_box, 2.0, 1.0).degenerate, 200);
}

TEST(LocalStrain, WithinAPhaseSeesNoOtherPhase) {
    const auto points = random_points(1500, 4.0);
    std::vector<std::int32_t> species(points.size());
    std::vector<Vec3> present = points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        species[i] = 1 + std::int32_t(i % 2);
        if (species[i] == 2) present[i] *= 1.5;
    }
    const LocalStrain strain = local_strain(points, open_box, present, open_box, 1.3, 1.0, species);
    EXPECT_EQ(strain.degenerate, 0);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(strain.volumetric[i], species[i] == 2 ? 3.0 * std::log(1.5) : 0.0, 1e-10);
}

TEST(LocalStrain, IsTheSameOnAnyNumberOfThreads) {
    const auto points = random_points(3000, 8.0), present = random_points(3000, 7.0);
    const LocalStrain one = local_strain(points, open_box, present, open_box, 1.5, 1.0, {}, 1);
    const LocalStrain three = local_strain(points, open_box, present, open_box, 1.5, 1.0, {}, 3);
    EXPECT_EQ(one.degenerate, three.degenerate);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_TRUE(one.non_affine[i] == three.non_affine[i] || std::isnan(one.non_affine[i]));
}

class Kernels : public testing::TestWithParam<Kernel> {};

TEST_P(Kernels, KeepAConstantEverywhereAndALinearFieldInside) {
    const Box box{Vec3::Zero(), Vec3::Constant(10), {false, false, false}};
    const auto points = synthetic::cube(10, 1.0);
    std::vector<double> values;
    for (const Vec3& p : points) {
        values.push_back(7.0);
        values.push_back(p.x() - 2.0 * p.z());
    }
    const auto mean = averaged_in_space(points, box, values, 2, {.kernel = GetParam(), .radius = 2.3}, 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(mean[2 * i], 7.0, 1e-12);
        const bool inside = (points[i] - Vec3::Constant(5)).cwiseAbs().maxCoeff() < 1.5;
        EXPECT_NEAR(mean[2 * i + 1], inside ? values[2 * i + 1] : mean[2 * i + 1], 1e-12);
    }
}

TEST_P(Kernels, SpreadAsFarAsTheirFormulasSay) {
    // The mean of x^2 around x = 0 is radius^2 / 5 in a ball, and for the Gaussian 0.9625 of that: it is cut off.
    constexpr double radius = 3.0, spacing = 0.5;
    const auto points = synthetic::cube(20, spacing, Vec3::Constant(-10 * spacing));
    std::vector<double> values;
    for (const Vec3& p : points) values.push_back(p.x() * p.x());
    const auto mean = averaged_in_space(points, open_box, values, 1, {.kernel = GetParam(), .radius = radius}, 2);
    const std::size_t middle = points.size() / 2;
    ASSERT_NEAR(points[middle].norm(), 0.0, 1e-12);
    const double expected = radius * radius / 5.0 * (GetParam() == Kernel::ball ? 1.0 : 0.9625);
    EXPECT_NEAR(mean[middle], expected, 0.01 * expected);
}

TEST_P(Kernels, AreTheSumOverAllPairsAlsoAtAFaceAndThroughAPeriodicSide) {
    const Box box{Vec3::Zero(), Vec3::Constant(4), {true, false, false}};
    const auto points = random_points(300, 4.0);
    std::vector<double> values;
    std::vector<std::int32_t> species;
    for (std::size_t k = 0; k < 6 * points.size(); ++k) values.push_back(std::sin(double(k)));
    for (std::size_t i = 0; i < points.size(); ++i) species.push_back(1 + std::int32_t(i % 3));
    constexpr double radius = 1.1;
    const auto mean =
        averaged_in_space(points, box, values, 6, {.kernel = GetParam(), .radius = radius, .species = species}, 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        double weights = 0.0, sum = 0.0;
        for (std::size_t j = 0; j < points.size(); ++j) {
            Vec3 apart = points[j] - points[i];
            apart.x() -= 4.0 * std::round(apart.x() / 4.0);
            const bool ball = GetParam() == Kernel::ball;
            if (species[i] != species[j] || apart.norm() >= (ball ? radius : 1.5 * radius)) continue;
            const double weight = ball ? 1.0 : std::exp(-2.5 * apart.squaredNorm() / (radius * radius));
            weights += weight;
            sum += weight * values[6 * j + 4];
        }
        EXPECT_NEAR(mean[6 * i + 4], sum / weights, 1e-12);
    }
}

INSTANTIATE_TEST_SUITE_P(BallAndGaussian, Kernels, testing::Values(Kernel::ball, Kernel::gaussian));

TEST(SpaceAverage, RefusesARadiusOfZero) {
    EXPECT_THAT([] { averaged_in_space(std::vector<Vec3>(3), open_box, std::vector<double>(3), 1, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("not positive")));
}

TEST(SignedEquivalent, IsTheUniaxialStressWithItsSign) {
    EXPECT_DOUBLE_EQ(signed_equivalent(Symmetric{0, 0, -5, 0, 0, 0}), -5.0);
    EXPECT_DOUBLE_EQ(signed_equivalent(Symmetric{4, 0, 0, 0, 0, 0}), 4.0);
    EXPECT_DOUBLE_EQ(pressure(Symmetric{0, 0, -6, 1, 2, 3}), 2.0);
}

TEST(SignedEquivalent, OfShearIsRootThreeTimesItAndOfPressureNothing) {
    for (std::size_t k = 3; k < 6; ++k) {
        Symmetric shear{};
        shear[k] = -2.0;
        EXPECT_DOUBLE_EQ(signed_equivalent(shear), 2.0 * std::sqrt(3.0));
    }
    EXPECT_NEAR(signed_equivalent(Symmetric{-3, -3, -3, 0, 0, 0}), 0.0, 1e-15);
}

TEST(SignedEquivalent, DoesNotDependOnTheAxes) {
    Eigen::Matrix3d stress;
    stress << -3, 1, 2, 1, -5, 0.5, 2, 0.5, 1;
    const Eigen::Matrix3d turned = rotation * stress * rotation.transpose();
    const auto components = [](const Eigen::Matrix3d& m) {
        return Symmetric{m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
    };
    EXPECT_NEAR(signed_equivalent(components(turned)), signed_equivalent(components(stress)), 1e-12);
    EXPECT_NEAR(pressure(components(turned)), pressure(components(stress)), 1e-12);
}

TEST(Summary, IsOverFiniteValuesOfTheLabel) {
    const std::vector<double> values{1, 10, 2, 20, 3, std::nan(""), 100, 40};
    const std::vector<std::int32_t> species{1, 1, 1, 2};
    const Summary second = summary({values, 2, 1}, species, 1);
    EXPECT_EQ(second.count, 2);
    EXPECT_DOUBLE_EQ(second.mean, 15.0);
    EXPECT_DOUBLE_EQ(second.deviation, 5.0);
    EXPECT_DOUBLE_EQ(summary({values, 2, 0}, species).max, 100.0);
    EXPECT_EQ(summary({values, 2, 0}, species, 7).count, 0);
    EXPECT_TRUE(std::isnan(summary({values, 2, 0}, species, 7).mean));
}

TEST(FieldRadius, MustBeSmallerThanTheSample) {
    const Packing packing = synthetic::sample(synthetic::cube(3, 1.0));
    EXPECT_NO_THROW(require_smaller_than_sample(2.9, packing));
    EXPECT_THAT([&] { require_smaller_than_sample(3.1, packing); },
                ThrowsMessage<InvalidInput>(HasSubstr("larger than the sample")));
}

}  // namespace
}  // namespace tomodem::fields
