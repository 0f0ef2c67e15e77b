// Pictures joined by depth: flat ones, and deep ones against the formulas of the text.
#include "sightline/composite.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "composite/optics.hpp"

namespace {

using namespace sightline;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// -- flat pictures -----------------------------------------------------------------------------

FlatPicture row_of(const std::vector<float>& depths, float shade) {
    FlatPicture picture;
    const auto width = static_cast<std::uint32_t>(depths.size());
    picture.color = ColorImage(width, 1, glm::vec4(shade, 0, 0, 1));
    picture.depth = DepthImage(width, 1);
    picture.depth.pixels = depths;
    picture.objects = IdImage(width, 1, static_cast<std::uint32_t>(shade));
    return picture;
}

TEST(CompositeFlat, TheNearestPixelWinsAndTiesGoToTheFirst) {
    std::vector<std::uint64_t> taken;
    CompositeOptions options;
    options.taken = &taken;
    const auto joined =
        composite({row_of({1, 5, 3, kInf, kInf, kNan, kNan}, 1),
                   row_of({2, 4, 3, kInf, 9, 7, kInf}, 2), row_of({3, 3, 3, kInf, 8, 8, kNan}, 3)},
                  options);
    ASSERT_TRUE(joined.ok());
    const auto& flat = std::get<FlatPicture>(*joined);
    const std::vector<std::uint32_t> owners = {1, 3, 1, 1, 3, 2, 1};
    EXPECT_EQ(flat.objects->pixels, owners);
    for (std::size_t i = 0; i < owners.size(); ++i) {
        EXPECT_EQ(flat.color.pixels[i].r, static_cast<float>(owners[i]));
    }
    EXPECT_EQ(flat.depth.pixels[1], 3);
    EXPECT_EQ(taken, (std::vector<std::uint64_t>{2, 1, 2}));
}

TEST(CompositeFlat, LayersThatNotAllHaveAreDropped) {
    auto without = row_of({1, 5}, 2);
    without.objects.reset();
    const auto joined = composite({row_of({2, 2}, 1), without});
    ASSERT_TRUE(joined.ok());
    EXPECT_FALSE(std::get<FlatPicture>(*joined).objects);
    const auto turned = composite({without, row_of({2, 2}, 1)});
    EXPECT_FALSE(std::get<FlatPicture>(*turned).objects);
}

TEST(CompositeFlat, NothingNeverWins) {
    // Other programs write 0, or what they like, where nothing is seen: alpha 0 tells.
    FlatPicture zeros = row_of({0, 0, 2, 0}, 1);
    zeros.color.pixels = {glm::vec4(0), glm::vec4(0), glm::vec4(1), {0, 0, 0, 0}};
    const FlatPicture other = row_of({5, kInf, 5, 7}, 2);
    std::vector<std::uint64_t> taken;
    for (const bool turned : {false, true}) {
        CompositeOptions options;
        options.taken = &taken;
        const auto joined = composite(
            turned ? std::vector<ExrPicture>{other, zeros} : std::vector<ExrPicture>{zeros, other},
            options);
        ASSERT_TRUE(joined.ok());
        const auto& flat = std::get<FlatPicture>(*joined);
        EXPECT_EQ(flat.depth.pixels, (std::vector<float>{5, kInf, 2, 7}));
        EXPECT_EQ(flat.objects->pixels[0], 2u);
        EXPECT_EQ(flat.objects->pixels[1], turned ? 2u : 1u) << "that of the first stays";
        EXPECT_EQ(flat.objects->pixels[2], 1u);
        EXPECT_EQ(taken[turned ? 1 : 0], 1u);
        EXPECT_EQ(taken[turned ? 0 : 1], 2u);
    }
}

// -- data windows ------------------------------------------------------------------------------

const Placement::Frame kWhole{{-2, -1}, {9, 6}};

/// A picture of some pixels of the whole; what they are depends on where they stand.
FlatPicture part_of_whole(glm::ivec2 first, glm::ivec2 last, float depth, float shade) {
    const glm::uvec2 size(last - first + 1);
    FlatPicture picture;
    picture.color = ColorImage(size.x, size.y);
    picture.depth = DepthImage(size.x, size.y);
    picture.objects = IdImage(size.x, size.y);
    picture.placement = {first, kWhole};
    for (std::uint32_t y = 0; y < size.y; ++y) {
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const glm::ivec2 at = first + glm::ivec2(x, y);
            const bool seen = (at.x + at.y) % 3 != 0;
            picture.color.at(x, y) = glm::vec4(shade, at.x, at.y, 1);
            picture.depth.at(x, y) = seen ? depth + static_cast<float>(at.x % 2) : kInf;
            picture.objects->at(x, y) = static_cast<std::uint32_t>(shade);
        }
    }
    return picture;
}

TEST(CompositeFlat, TheResultHasTheUnionOfTheDataWindows) {
    const std::vector<ExrPicture> parts = {part_of_whole({0, 0}, {3, 4}, 2, 1),
                                           part_of_whole({2, 3}, {6, 5}, 2.5f, 2),
                                           part_of_whole({-1, 2}, {2, 2}, 1.5f, 3)};
    const auto joined = composite(parts);
    ASSERT_TRUE(joined.ok()) << joined.error().message;
    const auto& flat = std::get<FlatPicture>(*joined);
    EXPECT_EQ(flat.placement.origin, glm::ivec2(-1, 0));
    ASSERT_EQ(glm::uvec2(flat.color.width, flat.color.height), glm::uvec2(8, 6));
    EXPECT_EQ(flat.placement.frame->last, kWhole.last);
    for (std::uint32_t y = 0; y < 6; ++y) {
        for (std::uint32_t x = 0; x < 8; ++x) {
            // By hand: the nearest that sees something, else the first that has the pixel.
            glm::vec4 color(0);
            float depth = kInf;
            bool there = false;
            for (const ExrPicture& part : parts) {
                const auto& p = std::get<FlatPicture>(part);
                const glm::ivec2 at = glm::ivec2(x, y) + flat.placement.origin - p.placement.origin;
                if (at.x < 0 || at.y < 0 || at.x >= static_cast<int>(p.color.width) ||
                    at.y >= static_cast<int>(p.color.height))
                    continue;
                const float z =
                    p.depth.at(static_cast<unsigned>(at.x), static_cast<unsigned>(at.y));
                if (there && !(z < depth)) continue;
                color = p.color.at(static_cast<unsigned>(at.x), static_cast<unsigned>(at.y));
                depth = z;
                there = true;
            }
            EXPECT_EQ(flat.color.at(x, y), color) << x << ' ' << y;
            EXPECT_EQ(flat.depth.at(x, y), depth);
            EXPECT_EQ(flat.objects->at(x, y), there ? static_cast<std::uint32_t>(color.r) : ~0u);
        }
    }
}

TEST(CompositeDeep, TheResultHasTheUnionOfTheDataWindows) {
    const auto part = [](glm::ivec2 origin, std::uint32_t width, std::uint32_t height, float z) {
        DeepImage image{width, height, {0}, {}, {origin, kWhole}};
        for (std::uint32_t i = 0; i < width * height; ++i) {
            for (std::uint32_t k = 0; k < i % 3; ++k) {
                const float at = z + static_cast<float>(k);
                image.samples.push_back({at, at, {0, 0, 0, 0.5f}, i, k});
            }
            image.first.push_back(image.samples.size());
        }
        return image;
    };
    const std::vector<DeepImage> parts = {part({1, 1}, 3, 2, 1), part({0, 2}, 2, 3, 1.25f),
                                          part({4, 4}, 1, 2, 7)};
    const auto joined = composite({parts[0], parts[1], parts[2]});
    ASSERT_TRUE(joined.ok()) << joined.error().message;
    const auto& deep = std::get<DeepImage>(*joined);
    EXPECT_EQ(deep.placement.origin, glm::ivec2(0, 1));
    ASSERT_EQ(glm::uvec2(deep.width, deep.height), glm::uvec2(5, 5));
    for (std::uint32_t i = 0; i < 25; ++i) {
        std::vector<DeepSample> expected;
        for (const DeepImage& p : parts) {
            const glm::ivec2 at =
                glm::ivec2(i % 5, i / 5) + deep.placement.origin - p.placement.origin;
            if (at.x < 0 || at.y < 0 || at.x >= static_cast<int>(p.width) ||
                at.y >= static_cast<int>(p.height))
                continue;
            const auto samples =
                p.pixel(static_cast<std::size_t>(at.y) * p.width + static_cast<std::size_t>(at.x));
            expected.insert(expected.end(), samples.begin(), samples.end());
        }
        std::ranges::stable_sort(expected, {}, &DeepSample::z);
        const auto samples = deep.pixel(i);
        EXPECT_EQ(std::vector(samples.begin(), samples.end()), expected) << i;
    }
}

TEST(CompositeFlat, WindowsThatSpanTooMuchAreRefused) {
    const auto joined = composite(
        {part_of_whole({0, 0}, {1, 1}, 1, 1), part_of_whole({70'000, 0}, {70'001, 1}, 1, 1)});
    ASSERT_FALSE(joined.ok());
    EXPECT_NE(joined.error().message.find("70002x2"), std::string::npos) << joined.error().message;
}

TEST(CompositeFlat, MisfitsNameBothFiles) {
    const std::vector<std::string> names = {"a.exr", "b.exr"};
    CompositeOptions options;
    options.names = names;
    const auto expect = [&](std::vector<ExrPicture> pictures,
                            std::initializer_list<const char*> needles) {
        const auto joined = composite(std::move(pictures), options);
        ASSERT_FALSE(joined.ok());
        EXPECT_EQ(joined.error().kind, ErrorKind::bad_input);
        for (const char* needle : needles) {
            EXPECT_NE(joined.error().message.find(needle), std::string::npos)
                << joined.error().message;
        }
    };
    expect({row_of({1, 2}, 1), row_of({1, 2, 3}, 1)}, {"'a.exr' has 2x1", "'b.exr' has 3x1"});
    auto moved = row_of({1, 2}, 1);
    moved.placement.origin = {4, -2};
    expect({row_of({1, 2}, 1), moved}, {"a.exr", "(0, 0)", "b.exr", "(4, -2)"});
    const DeepImage deep{2, 1, {0, 0, 0}, {}, {}};
    expect({row_of({1, 2}, 1), deep}, {"'b.exr' is deep but 'a.exr' is flat"});
    expect({deep, row_of({1, 2}, 1)}, {"'a.exr' is deep but 'b.exr' is flat"});
}

// -- one deep pixel ----------------------------------------------------------------------------

using Samples = std::vector<DeepSample>;

DeepImage pixel_of(const Samples& samples) { return {1, 1, {0, samples.size()}, samples, {}}; }

Samples joined(const std::vector<Samples>& pixels) {
    std::vector<ExrPicture> pictures;
    for (const Samples& pixel : pixels) pictures.emplace_back(pixel_of(pixel));
    const auto result = composite(std::move(pictures));
    return std::get<DeepImage>(*result).samples;
}

/// The formulas of the text for a part and for two samples that coincide, with the C library.
glm::dvec4 part_of(const glm::dvec4& c, double t) {
    if (c.a >= 1) return c;
    if (c.a <= 0) return c * t;
    const double alpha = -std::expm1(t * std::log1p(-c.a));
    return {glm::dvec3(c) * (alpha / c.a), alpha};
}

glm::dvec4 merge(const glm::dvec4& c1, const glm::dvec4& c2) {
    if (c1.a >= 1 && c2.a >= 1) return (c1 + c2) * 0.5;
    if (c1.a >= 1) return c1;
    if (c2.a >= 1) return c2;
    const double alpha = c1.a + c2.a - c1.a * c2.a;
    const double u1 = -std::log1p(-c1.a), u2 = -std::log1p(-c2.a), u = u1 + u2;
    const double v1 = c1.a > 0 ? u1 / c1.a : 1, v2 = c2.a > 0 ? u2 / c2.a : 1;
    const double w = u > 0 ? alpha / u : 1;
    return {(glm::dvec3(c1) * v1 + glm::dvec3(c2) * v2) * w, alpha};
}

void expect_near(const DeepSample& sample, float z, float z_back, const glm::dvec4& color) {
    EXPECT_EQ(sample.z, z);
    EXPECT_EQ(sample.z_back, z_back);
    for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(sample.color[k], color[k], 1e-6 * std::abs(color[k])) << "component " << k;
    }
}

void expect_tidy(std::span<const DeepSample> samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_LE(samples[i].z, samples[i].z_back);
        if (i == 0) continue;
        const DeepSample &a = samples[i - 1], &b = samples[i];
        ASSERT_LE(a.z_back, b.z);
        ASSERT_FALSE(a.z == a.z_back && b.z == b.z_back && a.z == b.z);
    }
}

TEST(CompositeOptics, FollowTheCLibrary) {
    EXPECT_EQ(optical_depth(0), 0);
    EXPECT_EQ(optical_depth(1), std::numeric_limits<double>::infinity());
    EXPECT_EQ(opacity(0), 0);
    EXPECT_EQ(opacity(std::numeric_limits<double>::infinity()), 1);
    for (float alpha = 0x1p-126f; alpha < 1; alpha *= 1.37f) {
        const double depth = -std::log1p(-double{alpha});
        ASSERT_NEAR(optical_depth(alpha), depth, 1e-14 * depth) << alpha;
        ASSERT_NEAR(opacity(depth), alpha, 1e-13 * alpha) << alpha;
        ASSERT_EQ(static_cast<float>(opacity(optical_depth(alpha))), alpha);
    }
    EXPECT_EQ(static_cast<float>(opacity(optical_depth(0x1p-149f))), 0x1p-149f);
    EXPECT_NEAR(optical_depth(1 - 0x1p-24f), 24 * std::log(2.0), 1e-12);
}

TEST(CompositeDeep, OverlappingVolumesAreSplitAndMerged) {
    const DeepSample a{1, 4, {0.3f, 0.1f, 0, 0.5f}, 10, 100};
    const DeepSample b{2, 8, {0, 0.4f, 0.2f, 0.8f}, 20, 200};
    const Samples out = joined({{a}, {b}});
    ASSERT_EQ(out.size(), 3U);
    expect_tidy(out);
    const glm::dvec4 ca = a.color, cb = b.color;
    expect_near(out[0], 1, 2, part_of(ca, 1.0 / 3));
    expect_near(out[1], 2, 4, merge(part_of(ca, 2.0 / 3), part_of(cb, 2.0 / 6)));
    expect_near(out[2], 4, 8, part_of(cb, 4.0 / 6));
    EXPECT_EQ(out[0].object, 10U);
    // In the middle b absorbs more: ln 5 / 3 > 2 ln 2 / 3.
    EXPECT_EQ(out[1].object, 20U);
    EXPECT_EQ(out[1].triangle, 200U);
    EXPECT_EQ(out[2].object, 20U);
}

TEST(CompositeDeep, ASurfaceInAVolumeSplitsIt) {
    const DeepSample fog{0, 4, {0.2f, 0.2f, 0.2f, 0.4f}, 1, 1}, wall{1, 1, {1, 0, 0, 1}, 2, 2};
    const Samples out = joined({{fog}, {wall}});
    ASSERT_EQ(out.size(), 3U);
    expect_near(out[0], 0, 1, part_of(fog.color, 0.25));
    EXPECT_EQ(out[1], wall);
    expect_near(out[2], 1, 4, part_of(fog.color, 0.75));
}

TEST(CompositeDeep, NeighboursAreNoOverlap) {
    const DeepSample front{1, 2, {0.1f, 0, 0, 0.2f}, 1, 1}, back{2, 3, {0, 0.1f, 0, 0.2f}, 2, 2},
        wall{3, 3, {0, 0, 1, 1}, 3, 3}, film{1, 1, {0, 0, 0.1f, 0.1f}, 4, 4};
    EXPECT_EQ(joined({{wall, back}, {front, film}}), (Samples{film, front, back, wall}));
}

TEST(CompositeDeep, SamplesThatCoincideAreMerged) {
    const auto merged = [](const glm::vec4& a, const glm::vec4& b) {
        const Samples out = joined({{{2, 3, a, 1, 1}}, {{2, 3, b, 2, 2}}});
        EXPECT_EQ(out.size(), 1U);
        expect_near(out[0], 2, 3, merge(a, b));
        return out[0];
    };
    EXPECT_EQ(merged({0.1f, 0.2f, 0.3f, 0.5f}, {0.4f, 0.2f, 0, 0.5f}).object, 1U);  // a tie
    EXPECT_EQ(merged({0.1f, 0.2f, 0.3f, 0.5f}, {0.4f, 0.2f, 0, 0.6f}).object, 2U);
    EXPECT_EQ(merged({1, 0, 0, 1}, {0, 1, 0, 1}).object, 1U);        // two opaque ones
    EXPECT_EQ(merged({0.4f, 0, 0, 0.9f}, {0, 1, 0, 1}).object, 2U);  // one
    merged({0.5f, 0, 0, 0}, {0, 0.25f, 0, 0});                       // fire: light without alpha
    merged({0.5f, 0, 0, 0}, {0, 0.25f, 0, 0.25f});
    merged({0, 0, 0, 0}, {0, 0, 0, 0});
    merged({1e-20f, 0, 0, 1e-20f}, {0, 1e-9f, 0, 1e-9f});
    const Samples surfaces =
        joined({{{2, 2, {0.5f, 0, 0, 0.5f}, 1, 1}}, {{2, 2, {0, 0.25f, 0, 0.25f}, 2, 2}}});
    ASSERT_EQ(surfaces.size(), 1U);
    expect_near(surfaces[0], 2, 2, merge({0.5, 0, 0, 0.5}, {0, 0.25, 0, 0.25}));
}

TEST(CompositeDeep, OddSamplesAreMadeReasonable) {
    const Samples out = joined({{{kNan, 1, glm::vec4(1), 1, 1},
                                 {5, 3, {0, 0, 0, 2}, 2, 2},
                                 {4, kNan, {1, 0, 0, -1}, 3, 3},
                                 {kInf, kInf, {0, 0, 1, 1}, 4, 4}}});
    EXPECT_EQ(out, (Samples{{4, 4, {1, 0, 0, 0}, 3, 3},
                            {5, 5, {0, 0, 0, 1}, 2, 2},
                            {kInf, kInf, {0, 0, 1, 1}, 4, 4}}));
    // A volume without an end has a finite one, so that its parts can be told.
    const Samples endless =
        joined({{{1, kInf, {0.5f, 0, 0, 0.5f}, 1, 1}}, {{2, 2, {0, 0, 1, 1}, 2, 2}}});
    ASSERT_EQ(endless.size(), 3U);
    expect_tidy(endless);
    for (const DeepSample& sample : endless) EXPECT_TRUE(std::isfinite(sample.color.r));
}

TEST(CompositeDeep, TheOrderOfFilesAndSamplesDoesNotMatterForTheLook) {
    std::mt19937 random(7);
    const auto number = [&](std::uint32_t n) { return static_cast<float>(random() % n); };
    for (int round = 0; round < 300; ++round) {
        std::vector<Samples> pixels(1 + random() % 4);
        for (Samples& pixel : pixels) {
            pixel.resize(random() % 6);
            for (DeepSample& sample : pixel) {
                sample.z = number(10);
                sample.z_back = sample.z + number(4);
                const float alpha = number(9) / 8;
                sample.color = {alpha * number(5) / 4, 0, alpha, alpha};
            }
        }
        const Samples out = joined(pixels);
        expect_tidy(out);
        const FlatPicture look = flatten(pixel_of(out));
        // A tidy list stays as it is, and one untidy list looks like many.
        ASSERT_EQ(joined({out}), out);
        Samples all;
        for (const Samples& pixel : pixels) all.insert(all.end(), pixel.rbegin(), pixel.rend());
        const FlatPicture other = flatten(pixel_of(all));
        EXPECT_EQ(look.depth.pixels[0], other.depth.pixels[0]);
        for (int k = 0; k < 4; ++k) {
            EXPECT_NEAR(look.color.pixels[0][k], other.color.pixels[0][k], 2e-6f);
        }
    }
}

TEST(CompositeDeep, TwoFilesFlattenAsTheirSamplesOverOneAnother) {
    const DeepSample near{1, 1, {0.2f, 0.1f, 0, 0.4f}, 1, 1},
        middle{2, 3, {0, 0.3f, 0, 0.5f}, 2, 2}, far{4, 4, {0, 0, 1, 1}, 3, 3},
        hidden{5, 5, {1, 1, 1, 1}, 4, 4};
    const DeepImage image = pixel_of(joined({{hidden, near, far}, {middle}}));
    const FlatPicture flat = flatten(image);
    const auto over = [](const glm::vec4& a, const glm::vec4& b) { return a + (1 - a.a) * b; };
    const glm::vec4 wanted = over(near.color, over(middle.color, far.color));
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(flat.color.pixels[0][k], wanted[k], 1e-6f);
    EXPECT_EQ(flat.depth.pixels[0], 1);
    const FlatPicture nothing = flatten(pixel_of({}));
    EXPECT_EQ(nothing.color.pixels[0], glm::vec4(0));
    EXPECT_EQ(nothing.depth.pixels[0], kInf);
    const FlatPicture clear = flatten(pixel_of({{1, 1, {0, 0, 0, 0}, 1, 1}, far}));
    EXPECT_EQ(clear.depth.pixels[0], 4);
}

}  // namespace
