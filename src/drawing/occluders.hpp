// What can hide: the triangles of a page that cover an area, and the search for those near a place.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "math/page_grid.hpp"
#include "math/predicates.hpp"
#include "sightline/drawing.hpp"

namespace sightline {

/// A triangle of the page with its plane. Inside of it side() > 0 for all three sides.
struct Occluder {
    ScreenPoint p, q, r;
    std::array<std::uint32_t, 3> corners{};  ///< indices of p, q and r
    std::uint32_t id = kNone;                ///< of the triangle in the scene
    std::uint32_t sheet = kNone;             ///< whose plane it has, if any
    bool turned = false;                     ///< its corners run the other way in the scene
    bool has_own_plane = false;              ///< one that passes exactly through its corners
    std::int32_t near = 0, far = 0;          ///< z of its corners, and of its plane there
    Plane plane;                             ///< c > 0

    /// Corner k; side k runs from there to corner next(k).
    [[nodiscard]] const ScreenPoint& point(std::size_t k) const {
        return k == 0 ? p : k == 1 ? q : r;
    }
    [[nodiscard]] static std::size_t next(std::size_t k) { return k == 2 ? 0 : k + 1; }
    [[nodiscard]] SpaceBox extents() const;
    [[nodiscard]] PageTriangle triangle() const { return {p, q, r, extents()}; }
};

/// All occluders of a page, near ones together. Read-only once made.
class Occluders {
public:
    Occluders(const ScreenScene& page, TraceMethod method, int threads);

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(all_.size()); }
    [[nodiscard]] const Occluder& operator[](std::uint32_t k) const { return all_[k]; }
    /// Those that have the plane of a sheet, in any order.
    [[nodiscard]] std::span<const std::uint32_t> in_sheets() const { return in_sheets_; }

    /// PageGrid::walk() among the occluders; with TraceMethod::pairwise all of them are visited.
    template <class Visitor>
    void walk(const ScreenPoint& p, const ScreenPoint& q, std::int32_t far, VisitMarks& marks,
              Visitor& visitor) const {
        if (grid_) {
            grid_->walk(p, q, far, marks, visitor);
            return;
        }
        for (std::uint32_t k = 0; k < size(); ++k) static_cast<void>(visitor.visit(k));
    }
    /// visit(k) for every occluder that may touch a box and have a point no deeper than `far`; with
    /// TraceMethod::pairwise for all of them.
    template <class Visit>
    void near_box(const PageBounds& box, std::int32_t far, VisitMarks& marks,
                  const Visit& visit) const {
        if (grid_) {
            grid_->search(box, far, marks, visit);
            return;
        }
        for (std::uint32_t k = 0; k < size(); ++k) visit(k);
    }
    /// Parts of the search for pairs; see pairs().
    [[nodiscard]] std::size_t part_count() const {
        return grid_ ? grid_->cell_count() + size() : size();
    }
    /// visit(a, b) for occluders whose extents meet: over all parts, every such pair once.
    template <class Visit>
    void pairs(std::size_t begin, std::size_t end, VisitMarks& marks, const Visit& visit) const {
        const std::size_t cells = grid_ ? grid_->cell_count() : 0;
        if (begin < cells) grid_->pairs(begin, std::min(end, cells), visit);
        for (std::size_t part = std::max(begin, cells); part < end; ++part) {
            const auto k = static_cast<std::uint32_t>(part - cells);
            const auto visit_other = [&](std::uint32_t other) { visit(k, other); };
            if (grid_)
                grid_->partners(k, all_[k].triangle(), marks, visit_other);
            else
                for (std::uint32_t other = k + 1; other < size(); ++other) visit_other(other);
        }
    }

private:
    RawVector<Occluder> all_;
    std::vector<std::uint32_t> in_sheets_;
    std::optional<PageGrid> grid_;
};

}  // namespace sightline
