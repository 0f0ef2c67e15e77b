// Fragments: their masks are the samples, their areas are exact and fit together, and what a pixel
// has does not depend on the order of the file.
#include "sightline/fragments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "math/predicates.hpp"
#include "support/nasty.hpp"
#include "support/scenes.hpp"
#include "visibility/pixel_coverage.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr std::int32_t kSize = 256;

ScreenPoint random_point(Random& random, std::int32_t extent, bool on_samples) {
    const auto place = [&] {
        const auto v = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(extent)));
        return on_samples ? v / 16 * 16 : v;
    };
    const std::int32_t x = place(), y = place();
    return {x, y, 0};
}

std::uint64_t sampled_mask(const OrientedTriangle& t, std::int32_t x, std::int32_t y) {
    std::uint64_t mask = 0;
    for (std::int32_t j = 0; j < 8; ++j)
        for (std::int32_t i = 0; i < 8; ++i)
            if (covers(t, x * kSize + 32 * i + 16, y * kSize + 32 * j + 16))
                mask |= std::uint64_t{1} << (8 * j + i);
    return mask;
}

// Of a triangle in a pixel, by clipping (Sutherland, Hodgman 1974) in double precision.
double clipped_area(const OrientedTriangle& t, std::int32_t x, std::int32_t y) {
    std::vector<glm::dvec2> polygon = {{t.p.x, t.p.y}, {t.q.x, t.q.y}, {t.r.x, t.r.y}};
    const auto clip = [&polygon](int axis, double bound, double sign) {
        std::vector<glm::dvec2> out;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const glm::dvec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
            const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
            if (da >= 0) out.push_back(a);
            if (da * db < 0) out.push_back(a + (b - a) * (da / (da - db)));
        }
        polygon = out;
    };
    clip(0, x * kSize, 1);
    clip(0, (x + 1) * kSize, -1);
    clip(1, y * kSize, 1);
    clip(1, (y + 1) * kSize, -1);
    double area = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const glm::dvec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
        area += 0.5 * (a.x * b.y - b.x * a.y);
    }
    return std::abs(area) / (double{kSize} * kSize);
}

TEST(Fragments, MasksAreTheSamplesAndAreasThoseOfClipping) {
    Random random(5);
    std::uint64_t full = 0, thin = 0, some = 0;
    for (int k = 0; k < 3000; ++k) {
        const bool on_samples = random.chance(0.4);
        const std::int32_t extent = random.chance(0.5) ? 2000 : 600;
        const ScreenPoint a = random_point(random, extent, on_samples),
                          b = random_point(random, extent, on_samples),
                          c = random_point(random, extent, on_samples);
        const OrientedTriangle t(a, b, c);
        const CoveredTriangle covered(a, b, c);
        if (!covered.has_area()) continue;
        for (std::int32_t y = -1; y < 9; ++y) {
            const auto columns = covered.columns(y * kSize, kSize);
            for (std::int32_t x = -1; x < 9; ++x) {
                const PixelCoverage coverage = covered.of({x * kSize, y * kSize, kSize});
                ASSERT_EQ(coverage.mask, sampled_mask(t, x, y));
                const double area = coverage.area / double{kFullArea};
                ASSERT_NEAR(area, clipped_area(t, x, y), 1e-8);
                ASSERT_TRUE(coverage.area == 0 || x < 0 ||
                            (columns.from <= x && x <= columns.last));
                full += coverage.area == kFullArea;
                thin += coverage.area > 0 && coverage.mask == 0;
                some += coverage.mask != 0;
            }
        }
    }
    EXPECT_GT(full, 800u);
    EXPECT_GT(thin, 300u);
    EXPECT_GT(some, 20000u);
}

// A page that triangles tile without gaps: corners anywhere, also many in one pixel.
Scene tiled_page(std::uint32_t side, double jitter) {
    SceneBuilder b;
    Random random(side);
    std::vector<glm::dvec3> corners;
    const double step = 2.4 / side;
    for (std::uint32_t j = 0; j <= side; ++j)
        for (std::uint32_t i = 0; i <= side; ++i)
            corners.push_back({-1.2 + step * (i + jitter * random.uniform(-0.5, 0.5)),
                               -1.2 + step * (j + jitter * random.uniform(-0.5, 0.5)),
                               random.uniform(-0.1, 0.1)});
    for (std::uint32_t j = 0; j < side; ++j) {
        for (std::uint32_t i = 0; i < side; ++i) {
            const std::uint32_t k = j * (side + 1) + i;
            b.triangle(corners[k], corners[k + 1], corners[k + side + 2]);
            b.triangle(corners[k], corners[k + side + 2], corners[k + side + 1]);
        }
    }
    return b.build();
}

// Gathers all pixels.
class Gather final : public FragmentSink {
public:
    void take(std::uint32_t x, std::uint32_t y, std::span<const Fragment> fragments) override {
        EXPECT_TRUE(pixels.emplace(std::pair{x, y}, std::vector(fragments.begin(), fragments.end()))
                        .second);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Fragment>> pixels;
};

Gather fragments_of(const ScreenScene& screen) {
    const auto source = must(open_fragments(screen, {}));
    Gather gather;
    const std::uint32_t rows = source->band_rows();
    for (std::uint32_t b = 0; b * rows < screen.resolution().height; ++b)
        source->visit_band(b, gather);
    return gather;
}

TEST(Fragments, AreasOfNeighboursFitTogether) {
    for (const std::uint32_t side : {7u, 30u, 200u}) {
        const Scene scene = tiled_page(side, 0.5);
        const ScreenScene screen =
            must(project(scene, page_camera(scene, {60, 60}), {Cull::none, 0}));
        const Gather gather = fragments_of(screen);
        EXPECT_EQ(gather.pixels.size(), 60u * 60);
        for (const auto& [place, fragments] : gather.pixels) {
            std::uint64_t area = 0, mask = 0, bits = 0;
            for (const Fragment& f : fragments) {
                area += f.area;
                mask |= f.thin ? 0 : f.mask;
                bits += f.thin ? 0u : static_cast<unsigned>(std::popcount(f.mask));
            }
            ASSERT_EQ(area, kFullArea) << place.first << " " << place.second;
            ASSERT_EQ(mask, ~std::uint64_t{0});
            ASSERT_EQ(bits, 64u);
        }
    }
}

TEST(Fragments, WholeSurfacesLeaveNothingForTheBackground) {
    const Scene scene = tiled_page(60, 0.5);
    const ScreenScene screen = must(project(scene, page_camera(scene, {60, 60}), {Cull::none, 0}));
    PixelResolver resolver(screen);
    for (const auto& [place, fragments] : fragments_of(screen).pixels) {
        const std::vector<float> opaque(fragments.size(), 1.0f);
        const PixelShares& shares = resolver.resolve(place.first, place.second, fragments, opaque);
        ASSERT_EQ(shares.rest, 0);
        double sum = 0;
        for (const double weight : shares.weights) sum += weight;
        ASSERT_NEAR(sum, kFullArea, 1e-3);
        const std::vector<float> half(fragments.size(), 0.5f);
        ASSERT_NEAR(resolver.resolve(place.first, place.second, fragments, half).rest,
                    kFullArea / 2, 64);
    }
}

// Weights at the precision of the masks: every sample's triangles, sorted exactly.
std::vector<double> sorted_weights(const ScreenScene& screen, std::uint32_t x, std::uint32_t y,
                                   const std::vector<Fragment>& fragments, float opacity) {
    std::vector<double> weights(fragments.size(), 0);
    const std::int32_t step = (1 << screen.subpixel_bits()) / 8;
    for (std::int32_t s = 0; s < 64; ++s) {
        const std::int32_t sx = static_cast<std::int32_t>(8 * x) * step + (s % 8) * step + step / 2,
                           sy = static_cast<std::int32_t>(8 * y) * step + (s / 8) * step + step / 2;
        std::vector<std::size_t> order;
        for (std::size_t k = 0; k < fragments.size(); ++k)
            if (!fragments[k].thin && (fragments[k].mask >> s & 1) != 0) order.push_back(k);
        std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
            const int sign = compare_depth_exactly(screen.plane(fragments[a].id),
                                                   screen.plane(fragments[b].id), sx, sy);
            return sign != 0 ? sign < 0 : fragments[a].id < fragments[b].id;
        });
        double light = 1.0 / 64;
        for (const std::size_t k : order) {
            weights[k] += light * double{opacity};
            light *= 1 - double{opacity};
        }
    }
    return weights;
}

TEST(Fragments, WeightsFollowTheExactOrderOfTheSamples) {
    double sum = 0;
    std::uint64_t count = 0, crossings = 0;
#ifdef SIGHTLINE_SANITIZED
    constexpr std::uint64_t kScenes = 10;
#else
    constexpr std::uint64_t kScenes = 40;
#endif
    for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
        const Scene scene = hostile_scene(seed);
        const ScreenScene screen =
            must(project(scene, hostile_camera(scene, seed, {40, 30}), {Cull::none, 0}));
        PixelResolver resolver(screen);
        for (const auto& [place, fragments] : fragments_of(screen).pixels) {
            for (const float opacity : {1.0f, 0.5f}) {
                const std::vector<float> opacities(fragments.size(), opacity);
                const PixelShares& shares =
                    resolver.resolve(place.first, place.second, fragments, opacities);
                const auto expected =
                    sorted_weights(screen, place.first, place.second, fragments, opacity);
                double all = shares.rest;
                for (std::size_t k = 0; k < fragments.size(); ++k) {
                    const double weight = shares.weights[k] / kFullArea;
                    ASSERT_GE(weight, 0);
                    all += shares.weights[k];
                    const double d = weight - expected[k];
                    sum += d * d;
                    ++count;
                }
                ASSERT_NEAR(all, kFullArea, 16);
            }
        }
        crossings += resolver.crossings();
    }
    EXPECT_GT(crossings, 25 * kScenes);
    // Areas tell more than 64 samples do, and these scenes are full of slivers.
    EXPECT_LT(std::sqrt(sum / static_cast<double>(count)), 0.06);
}

TEST(Fragments, DoNotDependOnTheOrderOfTheFile) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Scene scene = hostile_scene(seed);
        std::vector<std::uint32_t> order;
        const Scene other = shuffled(scene, seed, order);
        const Camera camera = hostile_camera(scene, seed, {60, 45});
        const ScreenScene first = must(project(scene, camera, {Cull::none, 0})),
                          second = must(project(other, camera, {Cull::none, 0}));
        const Gather a = fragments_of(first), b = fragments_of(second);
        ASSERT_EQ(a.pixels.size(), b.pixels.size());
        for (const auto& [place, fragments] : a.pixels) {
            const std::vector<Fragment>& others = b.pixels.at(place);
            ASSERT_EQ(fragments.size(), others.size());
            for (std::size_t k = 0; k < fragments.size(); ++k) {
                ASSERT_EQ(fragments[k].mask, others[k].mask);
                ASSERT_EQ(fragments[k].area, others[k].area);
                ASSERT_EQ(fragments[k].near, others[k].near);
            }
        }
    }
}

TEST(Fragments, WhatIsHiddenIsLeftOut) {
    SceneBuilder b;
    for (int k = 0; k < 100; ++k) {
        const double z = 0.01 * k - 0.5;
        b.quad({-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z});
    }
    const Scene scene = b.build();
    const ScreenScene screen = must(project(scene, page_camera(scene, {64, 64}), {Cull::none, 0}));
    for (const auto& [place, fragments] : fragments_of(screen).pixels)
        ASSERT_LE(fragments.size(), 2u) << place.first << " " << place.second;
}

}  // namespace
}  // namespace sightline
