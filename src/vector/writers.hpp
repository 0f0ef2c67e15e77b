// What the writers of drawings share: how lines look, and where things lie on the page.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "sightline/vector.hpp"

namespace sightline {

/// Hidden lines are thinner than visible ones, construction lines thinner still.
inline constexpr double kHiddenWidth = 0.6, kGuideWidth = 0.4;  // of VectorOptions::stroke
/// Dashes and the gaps between them. The round ends of a dash take a width from a gap.
inline constexpr double kDash = 4, kGap = 3;  // of VectorOptions::stroke
/// Regions are outlined in their own colour, lest the background shine through where two of them
/// meet and each covers a part of the pixels. Thin, since half of it covers a neighbour.
inline constexpr double kHairline = 0.6;  // pixels of the camera

/// 8-bit sRGB, as files want it.
using Rgb8 = std::array<std::uint8_t, 3>;
[[nodiscard]] Rgb8 rgb8(glm::vec3 linear);
/// Of the construction lines towards the vanishing points of x, y and z.
inline constexpr std::array<Rgb8, 3> kGuideColors = {
    {{0xCC, 0x33, 0x33}, {0x33, 0x99, 0x33}, {0x33, 0x66, 0xCC}}};

/// How lines of a kind look.
struct Look {
    double width = 1;  ///< of VectorOptions::stroke
    Rgb8 color{0, 0, 0};
    friend bool operator==(const Look&, const Look&) = default;
};
[[nodiscard]] Look look_of(EdgeKind kind);

/// Words are so high: pixels of the camera.
inline constexpr double kTextHeight = 13;
/// From the baseline to the middle of digits and capitals, and to their top.
inline constexpr double kToMiddle = 0.36, kToTop = 0.72;  // of kTextHeight

/// Where the baseline of a word is below its place, in its height.
[[nodiscard]] inline double baseline_of(const Label& label) {
    return label.away.y < 0 ? 0 : label.away.y > 0 ? kToTop : kToMiddle;
}

/// Regions whose colours are equal as 8-bit sRGB stand together, in their own order.
struct ColoredRegion {
    std::uint32_t color;  ///< 0xRRGGBB
    std::uint32_t region;
};
[[nodiscard]] std::vector<ColoredRegion> by_color(const DrawnRegions& regions);

[[nodiscard]] inline glm::dvec2 on_page(const PageLayout& layout, glm::dvec2 pixel) {
    return layout.offset + layout.scale * pixel;
}

/// The part of a guide that lies on the page, in units of the page. Vanishing points may be so far
/// out that a file has no numbers for them.
[[nodiscard]] std::optional<std::array<glm::dvec2, 2>> clipped(const GuideLine& guide,
                                                               const PageLayout& layout);

/// `paths` are the lines of the drawing, chained.
[[nodiscard]] Status write_svg(const std::string& path, const Drawing& drawing, const Paths& paths,
                               const VectorOptions& options);
[[nodiscard]] Status write_dxf(const std::string& path, const Drawing& drawing, const Paths& paths,
                               const VectorOptions& options);
/// PDF, EPS and PNG.
[[nodiscard]] Status write_with_cairo(const std::string& path, VectorFormat format,
                                      const Drawing& drawing, const Paths& paths,
                                      const VectorOptions& options);

}  // namespace sightline
