#include "core/surface/selection.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Packing three_particles() {
    Packing packing;
    packing.position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    packing.species = {1, 2, 2};
    packing.id = {1, 2, 3};
    packing.object = {0, 1, 2};
    return packing;
}

TEST(Selection, OfNothingIsTheWholeSample) {
    EXPECT_EQ(selected_centres(three_particles(), {}).size(), 3u);
}

TEST(Selection, OfASpeciesIsItsParticles) {
    const std::vector<Vec3> centres = selected_centres(three_particles(), {.species = 2});
    ASSERT_EQ(centres.size(), 2u);
    EXPECT_EQ(centres[0], Vec3(1, 0, 0));
}

TEST(Selection, OfAnObjectIsItsParticles) {
    const std::vector<Vec3> centres = selected_centres(three_particles(), {.object = 2});
    ASSERT_EQ(centres.size(), 1u);
    EXPECT_EQ(centres[0], Vec3(2, 0, 0));
}

TEST(Selection, RejectsASpeciesThatIsNotThereAndNamesThoseThatAre) {
    EXPECT_THAT([] { selected_centres(three_particles(), {.species = 3}); },
                ThrowsMessage<InvalidInput>(HasSubstr("it has 1, 2")));
}

TEST(Selection, RejectsAnObjectThatIsNotThere) {
    EXPECT_THAT([] { selected_centres(three_particles(), {.object = 7}); },
                ThrowsMessage<InvalidInput>(HasSubstr("numbered 1 to 2")));
}

TEST(Selection, RejectsAnObjectWhereObjectsAreNotToldApart) {
    Packing packing = three_particles();
    packing.object.clear();
    EXPECT_THAT([&] { selected_centres(packing, {.object = 1}); },
                ThrowsMessage<InvalidInput>(HasSubstr("carry no object numbers")));
}

}  // namespace
}  // namespace tomodem
