// Parts of curves as they are found, joined and thinned into the lines of a drawing.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "sightline/drawing.hpp"

namespace sightline {

/// What a part of a curve is drawn as.
struct CurveStyle {
    EdgeKind kind = EdgeKind::upper;
    bool visible = true;
    std::uint32_t object = 0, number = 0;
    friend bool operator==(const CurveStyle&, const CurveStyle&) = default;
};

/// Points of the page that follow each other on one curve, in one style.
class CurveRun {
public:
    /// Appends a segment; what it does not go on from is put out first.
    void add(glm::dvec2 from, glm::dvec2 to, const CurveStyle& style, double tolerance,
             DrawnLines& out);
    /// Puts out what there is, with no more points than a curve within `tolerance` needs.
    void flush(double tolerance, DrawnLines& out);

private:
    CurveStyle style_;
    std::vector<glm::dvec2> points_;
};

/// Fills in the numbers and lengths of visible and hidden lines.
void count_lengths(const DrawnLines& lines, DrawingCounts& counts);

/// Adds the lines of `more`.
void append(DrawnLines& lines, const DrawnLines& more);

}  // namespace sightline
