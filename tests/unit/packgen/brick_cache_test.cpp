#include "tools/packgen/brick_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/unit/temporary_folder.hpp"

namespace tomodem::packgen {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

class Kept : public InTemporaryFolder {
 protected:
    Kept() { made = compact(wanted); }
    void expect_found(const BrickCache& cache) const {
        const auto found = cache.find(wanted);
        ASSERT_TRUE(found.has_value());
        EXPECT_EQ(found->packing.position, made.packing.position);
        EXPECT_EQ(found->packing.radius, made.packing.radius);
        EXPECT_EQ(found->packing.id, made.packing.id);
        EXPECT_EQ(found->packing.box.edges, made.packing.box.edges);
        EXPECT_EQ(found->packing.box.periodic, made.packing.box.periodic);
        EXPECT_EQ(found->steps, made.steps);
        EXPECT_EQ(found->residual, made.residual);
        EXPECT_EQ(found->load, made.load);
    }
    Compaction wanted{.particles = 60, .density = 0.5, .dispersion = 0.05, .periodic = {true, false, true}};
    CompactedPacking made;
};

TEST_F(Kept, IsFoundAgainWithEveryBit) {
    const BrickCache cache(folder / "a" / "b");
    EXPECT_FALSE(cache.find(wanted).has_value());
    EXPECT_TRUE(cache.keep(wanted, made));
    expect_found(cache);
    Compaction other_threads = wanted;
    other_threads.threads = 5;
    EXPECT_TRUE(cache.find(other_threads).has_value());
}

TEST_F(Kept, IsFoundForNothingElse) {
    const BrickCache cache(folder);
    ASSERT_TRUE(cache.keep(wanted, made));
    const auto not_found = [&](auto change) {
        Compaction other = wanted;
        change(other);
        EXPECT_FALSE(cache.find(other).has_value());
        EXPECT_NE(cache.path_of(other), cache.path_of(wanted));
    };
    not_found([](Compaction& c) { c.particles = 61; });
    not_found([](Compaction& c) { c.density = std::nextafter(0.5, 1.0); });
    not_found([](Compaction& c) { c.seed_radius = 0.25; });
    not_found([](Compaction& c) { c.dispersion = 0.0; });
    not_found([](Compaction& c) { c.aspect[1] = 2.0; });
    not_found([](Compaction& c) { c.periodic = {true, true, false}; });
    not_found([](Compaction& c) { c.random_seed = 2; });
    not_found([](Compaction& c) { c.max_residual = 1e-4; });
}

TEST_F(Kept, IsNotFoundUnderTheNameOfAnother) {
    const BrickCache cache(folder);
    ASSERT_TRUE(cache.keep(wanted, made));
    Compaction other = wanted;
    other.random_seed = 2;
    std::filesystem::copy_file(cache.path_of(wanted), cache.path_of(other));
    EXPECT_FALSE(cache.find(other).has_value());
}

TEST_F(Kept, IsNotFoundWhereItIsDamagedAnywhere) {
    const BrickCache cache(folder);
    ASSERT_TRUE(cache.keep(wanted, made));
    const std::string bytes = content(cache.path_of(wanted));
    for (std::size_t parts = 0; parts < 16; ++parts) {
        put(cache.path_of(wanted), bytes.substr(0, parts * bytes.size() / 16));
        EXPECT_FALSE(cache.find(wanted).has_value()) << parts;
    }
    // One bit of a position, found by its bytes.
    const auto* x = reinterpret_cast<const char*>(made.packing.position[17].data());
    const std::size_t at = bytes.find(std::string(x, 8));
    ASSERT_NE(at, std::string::npos);
    std::string bad = bytes;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    put(cache.path_of(wanted), bad);
    EXPECT_FALSE(cache.find(wanted).has_value());
    // Whatever byte is wrong, what is found is what was kept.
    for (std::size_t place = 0; place < bytes.size(); place += 53) {
        bad = bytes;
        for (std::size_t k = place; k < std::min(place + 4, bytes.size()); ++k) bad[k] = '\xff';
        put(cache.path_of(wanted), bad);
        if (cache.find(wanted).has_value()) expect_found(cache);
    }
    ASSERT_TRUE(cache.keep(wanted, made));
    expect_found(cache);
}

TEST_F(Kept, LeavesNothingBehindWhereItCannotBeWritten) {
    put(folder / "file", "");
    const BrickCache cache(folder / "file" / "cache");
    EXPECT_FALSE(cache.keep(wanted, made));
    EXPECT_FALSE(cache.find(wanted).has_value());
    const BrickCache nowhere{std::filesystem::path()};
    EXPECT_FALSE(nowhere.keep(wanted, made));
    EXPECT_FALSE(nowhere.find(wanted).has_value());
    EXPECT_THAT(names(), SizeIs(1));
}

TEST(UsersFolder, FollowsTheConventions) {
    const char* home = std::getenv("HOME");
    const std::string before = home == nullptr ? "" : home;
    const char* xdg = std::getenv("XDG_CACHE_HOME");
    const std::string cache_before = xdg == nullptr ? "" : xdg;
    setenv("HOME", "/home/somebody", 1);
    setenv("XDG_CACHE_HOME", "/scratch/cache", 1);
    EXPECT_EQ(BrickCache::users_folder(), "/scratch/cache/tomodem/packgen");
    setenv("XDG_CACHE_HOME", "relative", 1);  // to be ignored, says the specification
    EXPECT_EQ(BrickCache::users_folder(), "/home/somebody/.cache/tomodem/packgen");
    unsetenv("XDG_CACHE_HOME");
    EXPECT_EQ(BrickCache::users_folder(), "/home/somebody/.cache/tomodem/packgen");
    unsetenv("HOME");
    EXPECT_THAT(BrickCache::users_folder().string(), IsEmpty());
    if (home != nullptr) setenv("HOME", before.c_str(), 1);
    if (xdg != nullptr) setenv("XDG_CACHE_HOME", cache_before.c_str(), 1);
}

}  // namespace
}  // namespace tomodem::packgen
