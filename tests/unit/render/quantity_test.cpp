#include "tools/render/quantity.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Two particles, two frames; every value says its frame, particle and component: 0.21 is frame 0, particle 2,
/// component 1.
class QuantityOfARun : public InTemporaryFolder {
 protected:
    QuantityOfARun() {
        Packing packing;
        packing.box.edges = Vec3::Ones();
        packing.seed_radius = 0.1;
        packing.position = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
        packing.species = {1, 1};
        packing.id = {1, 2};
        packing.property["temperature"] = {20, 30};
        {
            RunWriter writer(packing, folder / "plain.h5", {});
            writer.add_frame({0, 0.0, packing.position});
            writer.add_frame({1, 1.0, packing.position});
            writer.commit();
        }
        const RunReader plain(folder / "plain.h5");
        FieldWriter writer(plain, {0, 1}, {{"stress", "Pa", 6}, {"outward", "mm", 3}, {"d2min", "", 1}},
                           folder / "run.h5", {});
        for (const std::size_t f : {0u, 1u}) {
            std::vector<std::vector<double>> values{std::vector<double>(12), std::vector<double>(6),
                                                    std::vector<double>(2)};
            for (std::size_t k = 0; k < 12; ++k) values[0][k] = value(f, k / 6, k % 6);
            for (std::size_t k = 0; k < 6; ++k) values[1][k] = value(f, k / 3, k % 3);
            for (std::size_t k = 0; k < 2; ++k) values[2][k] = value(f, k, 0);
            writer.add_frame(plain.frame(f), values);
        }
        writer.commit();
    }
    static double value(std::size_t frame, std::size_t particle, std::size_t component) {
        return double(frame) + 0.1 * double(particle + 1) + 0.01 * double(component);
    }
};

TEST_F(QuantityOfARun, IsAComponentByItsName) {
    const RunReader run(folder / "run.h5");
    EXPECT_THAT(Quantity(run, "stress_zz").values(1), ElementsAre(value(1, 0, 2), value(1, 1, 2)));
    EXPECT_THAT(Quantity(run, "stress yz").values(0), ElementsAre(value(0, 0, 5), value(0, 1, 5)));
    EXPECT_THAT(Quantity(run, "outward_x").values(0), ElementsAre(value(0, 0, 0), value(0, 1, 0)));
    EXPECT_EQ(Quantity(run, "stress_zz").title(), "stress zz");
    EXPECT_EQ(Quantity(run, "stress_zz").unit(), "Pa");
}

TEST_F(QuantityOfARun, IsTheLengthOfAVectorAndTheValueOfANumber) {
    const RunReader run(folder / "run.h5");
    EXPECT_THAT(Quantity(run, "outward").values(1),
                ElementsAre(Vec3(1.1, 1.11, 1.12).norm(), Vec3(1.2, 1.21, 1.22).norm()));
    EXPECT_THAT(Quantity(run, "d2min").values(1), ElementsAre(value(1, 0, 0), value(1, 1, 0)));
}

TEST_F(QuantityOfARun, IsAPropertyOfTheSample) {
    const RunReader run(folder / "plain.h5");
    EXPECT_THAT(Quantity(run, "temperature").values(1), ElementsAre(20, 30));
}

TEST_F(QuantityOfARun, ThatIsNotThereIsToldWithWhatThereIs) {
    const RunReader run(folder / "run.h5"), plain(folder / "plain.h5");
    EXPECT_THAT([&] { Quantity(run, "stress"); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no 'stress' to colour by")));
    EXPECT_THAT([&] { Quantity(run, "pressure"); }, ThrowsMessage<InvalidInput>(HasSubstr("stress_xx, stress_yy")));
    EXPECT_THAT([&] { Quantity(plain, "stress_zz"); },
                ThrowsMessage<InvalidInput>(HasSubstr("the file has temperature")));
}

TEST_F(QuantityOfARun, AsAVectorWantsThreeComponents) {
    const RunReader run(folder / "run.h5"), plain(folder / "plain.h5");
    EXPECT_EQ(vectors(run, "outward", 1)[1], Vec3(value(1, 1, 0), value(1, 1, 1), value(1, 1, 2)));
    EXPECT_THAT([&] { vectors(run, "stress", 1); },
                ThrowsMessage<InvalidInput>(HasSubstr("no vector 'stress' to draw as arrows; it has outward")));
    EXPECT_THAT([&] { vectors(plain, "outward", 1); }, ThrowsMessage<InvalidInput>(HasSubstr("self_contact = true")));
}

}  // namespace
}  // namespace tomodem::render
