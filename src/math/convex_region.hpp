// Convex regions of the page, as the half-planes that bound them. Their corners are crossings of
// neighbouring sides and are never computed: all questions go to sign_at_crossing(), so the answers
// are exact.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "math/page_line.hpp"

namespace sightline {

/// A convex region; side k and side k + 1 (the last and the first) cross in corner k, clockwise on
/// a page whose y grows down. Each side carries a tag of the user's.
template <class Tag>
class ConvexRegion {
public:
    struct Side {
        PageLine line;
        Tag tag;
    };

    ConvexRegion() = default;
    /// Precondition: the sides bound a region in order, none of them redundant.
    explicit ConvexRegion(std::vector<Side> sides) : sides_(std::move(sides)) {}

    [[nodiscard]] bool empty() const { return sides_.empty(); }
    [[nodiscard]] const std::vector<Side>& sides() const { return sides_; }

    /// On which sides of a line there are corners. All of them on the line: both are false, which
    /// takes a line that is 0 everywhere.
    struct Signs {
        bool negative = false, positive = false;
    };
    [[nodiscard]] Signs signs(const PageLine& line) const {
        Signs signs;
        for (std::size_t k = 0; k < sides_.size() && !(signs.negative && signs.positive); ++k) {
            const int s = sign_of_corner(k, line);
            signs.negative = signs.negative || s < 0;
            signs.positive = signs.positive || s > 0;
        }
        return signs;
    }

    /// Keeps the part on the positive side of a line; empty when that has no area.
    void clip(const PageLine& line, const Tag& tag) {
        const std::size_t n = sides_.size();
        if (n == 0) return;
        std::vector<int>& at = scratch();
        at.resize(n);
        bool negative = false, positive = false;
        for (std::size_t k = 0; k < n; ++k) {
            at[k] = sign_of_corner(k, line);
            negative = negative || at[k] < 0;
            positive = positive || at[k] > 0;
        }
        if (!negative && positive) return;
        std::vector<Side> kept;
        if (positive) {
            kept.reserve(n + 1);
            for (std::size_t k = 0; k < n; ++k) {
                const int before = at[k == 0 ? n - 1 : k - 1];
                if (before > 0 || at[k] > 0) kept.push_back(sides_[k]);
                if (before > 0 && at[k] <= 0) kept.push_back({line, tag});
            }
        }
        sides_ = std::move(kept);
    }

    /// A box around the region, in units of the screen: within `known`, a box that is sure.
    [[nodiscard]] PageBounds bounds(const PageBounds& known) const {
        if (sides_.empty()) return known;
        PageBounds box{known.x1, known.x0, known.y1, known.y0};
        for (std::size_t k = 0; k < sides_.size(); ++k) {
            const PageBounds corner = bounds_of_crossing(
                sides_[k].line, sides_[k + 1 == sides_.size() ? 0 : k + 1].line, known);
            box.x0 = std::min(box.x0, corner.x0);
            box.x1 = std::max(box.x1, corner.x1);
            box.y0 = std::min(box.y0, corner.y0);
            box.y1 = std::max(box.y1, corner.y1);
        }
        return box;
    }

private:
    [[nodiscard]] int sign_of_corner(std::size_t k, const PageLine& line) const {
        return sign_at_crossing(sides_[k].line, sides_[k + 1 == sides_.size() ? 0 : k + 1].line,
                                line);
    }
    static std::vector<int>& scratch() {
        thread_local std::vector<int> signs;
        return signs;
    }

    std::vector<Side> sides_;
};

}  // namespace sightline
