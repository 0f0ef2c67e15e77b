// Fragments: what the A-buffer keeps of each pixel. Every surface that can be seen in a pixel
// leaves one there, with how much of the pixel it covers and where.
//
// Source: L. Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/screen_scene.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// The area of a whole pixel, in the unit of Fragment::area.
inline constexpr std::uint32_t kFullArea = std::uint32_t{1} << 30;

/// Samples a side of the masks.
inline constexpr std::uint32_t kMaskSide = 8;

/// The part of one triangle in one pixel.
struct Fragment {
    std::uint32_t id = kNone;  ///< of the triangle in the scene
    /// Of kFullArea. Exact up to one rounding for each edge, which is the same for both triangles
    /// at the edge: the areas of triangles that tile a pixel add up to kFullArea.
    std::uint32_t area = 0;
    /// Bit 8 j + i: it covers sample (i, j) of 8 x 8 in the pixel, by the rule of all samples. One
    /// that covers none has the bit nearest to it, and `thin` is set.
    std::uint64_t mask = 0;
    /// Bounds of its z in the pixel, in units of the depth grid.
    float near = 0, far = 0;
    bool thin = false;
};

class FragmentSink {
public:
    virtual ~FragmentSink() = default;
    /// The fragments of the pixel in column x and row y, ordered by `near`.
    virtual void take(std::uint32_t x, std::uint32_t y, std::span<const Fragment> fragments) = 0;
};

/// All fragments of a picture that may be seen: those behind an opaque surface that covers the
/// whole pixel are left out. They are made in bands of rows. Refers to its ScreenScene.
class FragmentSource {
public:
    virtual ~FragmentSource() = default;
    /// Rows of pixels in a band; the last band may have fewer.
    [[nodiscard]] virtual std::uint32_t band_rows() const = 0;
    /// Hands over the pixels of a band that have fragments, each once, in any order. What a pixel
    /// has does not depend on the order of the triangles in the scene. Any number of threads may
    /// work on different bands.
    virtual void visit_band(std::uint32_t band, FragmentSink& sink) = 0;
    /// Appends what was counted so far to the counters of the options.
    virtual void report() = 0;
};

/// options.threads, .observer and .counters are used; observer and counters must outlive the
/// source. Time O(triangles + fragments + k log k for k fragments of a pixel); memory O(triangles)
/// and, for each thread, the fragments of a tile.
/// Error (bad_option): the scene has quadrics: tessellate_quadrics().
[[nodiscard]] Result<std::unique_ptr<FragmentSource>> open_fragments(const ScreenScene& screen,
                                                                     const ResolveOptions& options);

/// How much of a pixel each of its fragments contributes.
struct PixelShares {
    /// One a fragment, in units of kFullArea: the area of it that is seen, times its opacity, times
    /// what the surfaces in front let through.
    std::vector<double> weights;
    /// One a fragment, ascending from 0: fragments of one object that continue one another have the
    /// same number.
    std::vector<std::uint32_t> surfaces;
    /// What is left for the background. Exactly 0 where opaque surfaces cover the whole pixel.
    double rest = kFullArea;
};

/// Weighs the fragments of pixels. For one thread.
class PixelResolver {
public:
    explicit PixelResolver(const ScreenScene& screen);
    ~PixelResolver();
    PixelResolver(const PixelResolver&) = delete;
    PixelResolver& operator=(const PixelResolver&) = delete;

    /// Fragments as a FragmentSource gives them, and the opacity of each, 0..1. Valid until the
    /// next call.
    [[nodiscard]] const PixelShares& resolve(std::uint32_t x, std::uint32_t y,
                                             std::span<const Fragment> fragments,
                                             std::span<const float> opacities);

    /// Pixels in which surfaces cross, and comparisons of depths that they took.
    [[nodiscard]] std::uint64_t crossings() const;

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace sightline
