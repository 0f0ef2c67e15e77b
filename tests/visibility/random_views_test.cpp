// Every algorithm on every vector target against brute force, from wherever a camera may stand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "support/models.hpp"
#include "support/nasty.hpp"
#include "support/soak.hpp"

namespace sightline {
namespace {

using namespace testing;

bool full() { return std::getenv("SIGHTLINE_FULL") != nullptr; }

constexpr std::uint64_t kParts = 4;

// A part of the samples; scripts/soak.sh makes as many as one likes.
std::uint64_t samples_of_part() {
#ifdef SIGHTLINE_SANITIZED
    constexpr std::uint64_t kFull = 4'000'000, kQuick = 400'000;
#else
    constexpr std::uint64_t kFull = 100'000'000, kQuick = 10'000'000;
#endif
    return (full() ? kFull : kQuick) / kParts;
}

class RandomViews : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomViews, EveryAlgorithmOnEveryTargetEqualsBruteForce) {
    std::ostringstream log;
    Soak soak(log);
    soak.compare_samples(GetParam() * 1'000'000'000, samples_of_part());
    EXPECT_EQ(soak.sum().differing, 0u) << log.str();
    EXPECT_GE(soak.sum().samples, samples_of_part());
#ifndef SIGHTLINE_SANITIZED
    // The views are worth something.
    const Soak::Views& views = soak.views();
    EXPECT_GT(views.covered, views.samples * 4 / 10);
    EXPECT_GT(views.clipped_and_tiny, views.views / 10);
    EXPECT_GE(views.of_models, views.views / 50);
    // Every algorithm had its share on every target.
    for (const auto& [key, row] : soak.rows())
        EXPECT_GT(row.samples, samples_of_part() / 10'000) << key.first << " " << key.second;
#endif
}

INSTANTIATE_TEST_SUITE_P(Parts, RandomViews, ::testing::Range(std::uint64_t{0}, kParts));

TEST(RandomViews, OfNastyScenesEqualBruteForce) {
    std::ostringstream log;
    Soak soak(log);
#ifdef SIGHTLINE_SANITIZED
    const std::uint64_t views = full() ? 20 : 2;
#else
    const std::uint64_t views = full() ? 1000 : 20;
#endif
    for (const NastyScene& nasty : nasty_scenes())
        for (std::uint64_t seed = 0; seed < views; ++seed)
            soak.compare_view(nasty.scene, seed, !nasty.entangled);
    EXPECT_EQ(soak.sum().differing, 0u) << log.str();
}

// Larger than what the soak test takes, so that triangles are tiny and many.
TEST(RandomViews, OfLargeModelsEqualBruteForce) {
    std::ostringstream log;
    Soak soak(log);
#ifdef SIGHTLINE_SANITIZED
    const std::uint64_t views = 1;
#else
    const std::uint64_t views = full() ? 300 : 6;
#endif
    const std::optional<Scene> scene = real_model("stanford-bunny.obj");
    if (!scene) GTEST_SKIP() << models_folder() << " is not there; set SIGHTLINE_MODELS";
    for (std::uint64_t seed = 0; seed < views; ++seed) soak.compare_view(*scene, seed, false);
    EXPECT_EQ(soak.sum().differing, 0u) << log.str();
}

}  // namespace
}  // namespace sightline
