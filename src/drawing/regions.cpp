#include "drawing/regions.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/clipped_triangle.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t kNoHider = kNone;

std::size_t next_of(std::size_t k) { return Occluder::next(k); }
std::size_t previous_of(std::size_t k) { return k == 0 ? 2 : k - 1; }

/// Whether a side of one triangle has all of the other one on its outside, or on itself.
bool separates(const Occluder& f, const Occluder& g) {
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &a = f.point(k), &b = f.point(next_of(k));
        if (side(a.x, a.y, b.x, b.y, g.p.x, g.p.y) <= 0 &&
            side(a.x, a.y, b.x, b.y, g.q.x, g.q.y) <= 0 &&
            side(a.x, a.y, b.x, b.y, g.r.x, g.r.y) <= 0)
            return true;
    }
    return false;
}

enum class InFront { nowhere, everywhere, partly };

/// Whether the plane of g is nearer, and deeper, than that of f at some corner of a triangle.
struct Sight {
    bool in_front = false, behind = false;

    Sight(const Occluder& g, const Occluder& f, const Occluder& corners) {
        for (std::size_t k = 0; k < 3; ++k) {
            const ScreenPoint& s = corners.point(k);
            const int sign = compare_depth(f.plane, g.plane, s.x, s.y).sign;
            in_front = in_front || sign > 0;
            behind = behind || sign < 0;
        }
    }
    [[nodiscard]] bool equal() const { return !in_front && !behind; }
};

/// Where face g lies in front of face f. The difference of their depths is linear, so where it has
/// one sign at all corners of either it has no other where they overlap.
InFront in_front(const Occluder& g, const Occluder& f) {
    if (g.id == f.id) return InFront::nowhere;
    const InFront at_ties = g.id < f.id ? InFront::everywhere : InFront::nowhere;
    if (g.sheet != kNone && g.sheet == f.sheet) return at_ties;
    const Sight at_f(g, f, f), at_g(g, f, g);
    if (at_f.equal() && at_g.equal()) return at_ties;
    if (!at_f.in_front || !at_g.in_front) return InFront::nowhere;
    return at_f.behind && at_g.behind ? InFront::partly : InFront::everywhere;
}

/// Side k of a triangle as a stretch of its own line.
Stretch stretch_of(const Occluder& o, const ConvexSides& sides, std::size_t k) {
    // Inside all sides are positive: the one before grows where this one begins, the next falls.
    return {{&sides.side[previous_of(k)], 1, &o.point(k)},
            {&sides.side[next_of(k)], -1, &o.point(next_of(k))}};
}

PageBounds joined(const ScreenPoint& p, const ScreenPoint& q) {
    return {std::min(p.x, q.x), std::max(p.x, q.x), std::min(p.y, q.y), std::max(p.y, q.y)};
}

/// A box around the part of a hider that lies over the face.
PageBounds bounds_over(const Occluder& hider, const Occluder& face) {
    ClippedTriangle part(hider.p, hider.q, hider.r);
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &a = face.point(k), &b = face.point(next_of(k));
        const double dx = static_cast<double>(b.x) - a.x, dy = static_cast<double>(b.y) - a.y;
        const double slack = 2 * (std::abs(dx) + std::abs(dy));  // two units, and more
        part.keep([&](const ClippedTriangle::Corner& c) {
            return dx * (c.y - a.y) - dy * (c.x - a.x) + slack;
        });
    }
    const PageBounds all = hider.extents();
    PageBounds box{all.x1, all.x0, all.y1, all.y0};
    for (const ClippedTriangle::Corner& c : part.corners()) {
        box.x0 = std::min(box.x0, static_cast<std::int32_t>(c.x) - 1);
        box.x1 = std::max(box.x1, static_cast<std::int32_t>(c.x) + 1);
        box.y0 = std::min(box.y0, static_cast<std::int32_t>(c.y) - 1);
        box.y1 = std::max(box.y1, static_cast<std::int32_t>(c.y) + 1);
    }
    return box;
}

}  // namespace

void RegionFinder::collect_hiders(const Occluder& face) {
    near_.clear();
    hiders_.clear();
    occluders_.near_box(face.extents(), face.far, marks_,
                        [&](std::uint32_t k) { near_.push_back(k); });
    // The order in which a search finds them must not matter.
    std::ranges::sort(near_);
    for (const std::uint32_t k : near_) {
        const Occluder& other = occluders_[k];
        if (separates(face, other) || separates(other, face)) continue;
        const InFront where = in_front(other, face);
        if (where == InFront::nowhere) continue;
        Hider hider{k, where == InFront::everywhere, sides_of(other.p, other.q, other.r),
                    bounds_over(other, face)};
        if (!hider.whole) {
            hider.sides.side[3] = line_where_deeper(face.plane, other.plane);
            hider.sides.count = 4;
        }
        hiders_.push_back(hider);
    }
    order_hiders(face.extents());
}

/// Sorts the hiders along the longer side of the face's box.
void RegionFinder::order_hiders(const PageBounds& face) {
    along_y_ = face.y1 - face.y0 > face.x1 - face.x0;
    order_.clear();
    longest_ = 0;
    for (std::uint32_t h = 0; h < hiders_.size(); ++h) {
        const PageBounds& b = hiders_[h].bounds;
        const HiderPlace place = along_y_ ? HiderPlace{b.y0, b.y1, h} : HiderPlace{b.x0, b.x1, h};
        longest_ = std::max(longest_, place.end - place.begin);
        order_.push_back(place);
    }
    std::ranges::sort(order_, [](const HiderPlace& a, const HiderPlace& b) {
        return std::tie(a.begin, a.hider) < std::tie(b.begin, b.hider);
    });
}

// Sides of the face itself border what is visible on their own account.
void RegionFinder::collect_candidates(const Occluder& face) {
    candidates_.clear();
    const auto is_own = [&](std::uint32_t a, std::uint32_t b) {
        return std::ranges::find(face.corners, a) != face.corners.end() &&
               std::ranges::find(face.corners, b) != face.corners.end();
    };
    for (std::uint32_t h = 0; h < hiders_.size(); ++h) {
        const Occluder& o = occluders_[hiders_[h].occluder];
        for (std::uint32_t k = 0; k < hiders_[h].sides.count; ++k) {
            if (k == 3) {
                candidates_.push_back({kNone, kNone, h, k, true});
                continue;
            }
            const std::uint32_t a = o.corners[k], b = o.corners[next_of(k)];
            if (!is_own(a, b)) candidates_.push_back({std::min(a, b), std::max(a, b), h, k, a < b});
        }
    }
}

// Two hiders that lie on both sides of a common edge, each as a whole, leave nothing to be seen
// along it.
void RegionFinder::drop_seams() {
    const auto key = [](const Candidate& c) { return std::tie(c.low, c.high); };
    std::ranges::sort(candidates_, [&](const Candidate& c, const Candidate& d) {
        return key(c) != key(d) ? key(c) < key(d)
                                : std::tie(c.hider, c.side) < std::tie(d.hider, d.side);
    });
    std::size_t kept = 0;
    for (std::size_t i = 0, end = 0; i < candidates_.size(); i = end) {
        bool forward = false, backward = false;
        for (; end < candidates_.size() && key(candidates_[end]) == key(candidates_[i]); ++end) {
            const Candidate& c = candidates_[end];
            if (c.low == kNone || !hiders_[c.hider].whole) continue;
            (c.forward ? forward : backward) = true;
        }
        if (forward && backward) continue;
        for (std::size_t c = i; c < end; ++c) candidates_[kept++] = candidates_[c];
    }
    candidates_.resize(kept);
}

/// Whether a stretch lies clearly outside of a triangle: on the far side of one of its sides.
bool RegionFinder::misses(const Chord& chord, const ConvexSides& sides) {
    // The ends are off by less than 2^-16 of a unit, the products by 2^-52 of themselves.
    constexpr double kSlack = 0x1p-15, kRounding = 0x1p-50;
    for (std::size_t k = 0; k < 3; ++k) {
        const PageLine& side = sides.side[k];
        const double slack =
            kSlack * (std::abs(side.dl) + std::abs(side.dm)) + kRounding * std::abs(side.dn);
        if (side.dl * chord.from.x + side.dm * chord.from.y + side.dn < -slack &&
            side.dl * chord.to.x + side.dm * chord.to.y + side.dn < -slack)
            return true;
    }
    return false;
}

// True when nothing of the stretch is left.
bool RegionFinder::cover(const PageLine& carrier, CarrierSide beside, const Stretch& stretch,
                         std::uint32_t h, std::uint32_t skip) {
    const ConvexSides& sides = hiders_[h].sides;
    if (const auto covered = inside(carrier, beside, stretch, sides)) {
        if (covered->from.line == stretch.from.line && covered->to.line == stretch.to.line)
            return true;
        covers_.push_back(*covered);
    }
    // Where several hiders end along one line, the first of them has the border.
    if (skip == kNoHider || h > skip) return false;
    for (const PageLine& side : sides.all()) {
        if (growth(carrier, side) != 0 || sign_of_parallel(carrier, *stretch.from.line, side) != 0)
            continue;
        if (const auto same = inside(carrier, CarrierSide::right, stretch, sides))
            covers_.push_back(*same);
        return false;
    }
    return false;
}

/// Leaves in left_ what no hider but `skip` covers.
void RegionFinder::subtract_hiders(const PageLine& carrier, CarrierSide beside,
                                   const Stretch& stretch, std::uint32_t skip) {
    covers_.clear();
    left_.clear();
    const auto end = [&](const Place& place) {
        return place.corner != nullptr ? glm::dvec2(place.corner->x, place.corner->y)
                                       : crossing_of(carrier, *place.line);
    };
    const Chord chord{end(stretch.from), end(stretch.to)};
    const double x0 = std::min(chord.from.x, chord.to.x) - 1,
                 x1 = std::max(chord.from.x, chord.to.x) + 1;
    const double y0 = std::min(chord.from.y, chord.to.y) - 1,
                 y1 = std::max(chord.from.y, chord.to.y) + 1;
    const double low = along_y_ ? y0 : x0, high = along_y_ ? y1 : x1;
    auto place = std::ranges::lower_bound(order_, low - longest_, {}, &HiderPlace::begin);
    for (; place != order_.end() && place->begin <= high; ++place) {
        const std::uint32_t h = place->hider;
        const Hider& hider = hiders_[h];
        if (h == skip || hider.bounds.x1 < x0 || hider.bounds.x0 > x1 || hider.bounds.y0 > y1 ||
            hider.bounds.y1 < y0)
            continue;
        if (!misses(chord, hider.sides) && cover(carrier, beside, stretch, h, skip)) return;
    }
    std::ranges::sort(covers_, [&](const Stretch& a, const Stretch& b) {
        return compare(carrier, a.from, b.from) < 0;
    });
    Place at = stretch.from;
    for (const Stretch& covered : covers_) {
        if (compare(carrier, at, covered.from) < 0) left_.push_back({at, covered.from});
        if (compare(carrier, at, covered.to) < 0) at = covered.to;
    }
    if (compare(carrier, at, stretch.to) < 0) left_.push_back({at, stretch.to});
}

BorderPiece RegionFinder::piece(const PageLine& carrier, const Stretch& stretch,
                                bool reversed) const {
    BorderPiece piece;
    piece.own = !reversed;
    const auto place = [&](const Place& p, glm::ivec2& rounded, glm::dvec2& exact) {
        if (p.corner != nullptr) {
            rounded = {p.corner->x, p.corner->y};
            exact = glm::dvec2(rounded);
        } else {
            rounded = rounded_crossing_of(carrier, *p.line);
            exact = crossing_of(carrier, *p.line);
        }
    };
    place(reversed ? stretch.to : stretch.from, piece.from, piece.exact_from);
    place(reversed ? stretch.from : stretch.to, piece.to, piece.exact_to);
    return piece;
}

// True when the side enters the face.
bool RegionFinder::try_candidate(const Candidate& c, std::vector<BorderPiece>& border) {
    const Hider& hider = hiders_[c.hider];
    const Occluder& o = occluders_[hider.occluder];
    const PageLine& carrier = hider.sides.side[c.side];
    std::optional<Stretch> stretch;
    if (c.side < 3) {
        if (!face_->extents().meets(joined(o.point(c.side), o.point(next_of(c.side)))))
            return false;
        stretch = stretch_of(o, hider.sides, c.side);
        if (!hider.whole) stretch = inside(carrier, CarrierSide::right, *stretch, hider.sides);
    } else {
        // The line of intersection, as far as it lies in the hider: it enters and leaves by sides.
        stretch = chord(carrier, std::span<const PageLine, 3>(hider.sides.side.data(), 3));
    }
    if (!stretch) return false;
    // Beside the hider, but not along a side of the face, which is its own border.
    for (const PageLine& side : own_.all())
        if (growth(carrier, side) == 0 && sign_of_parallel(carrier, *stretch->from.line, side) == 0)
            return false;
    stretch = inside(carrier, CarrierSide::left, *stretch, own_);
    if (!stretch) return false;
    subtract_hiders(carrier, CarrierSide::left, *stretch, c.hider);
    for (const Stretch& left : left_) border.push_back(piece(carrier, left, true));
    return true;
}

void RegionFinder::add_own_sides(const Occluder& face, std::vector<BorderPiece>& border) {
    for (std::size_t k = 0; k < 3; ++k) {
        const PageLine& carrier = own_.side[k];
        subtract_hiders(carrier, CarrierSide::right, stretch_of(face, own_, k), kNoHider);
        for (const Stretch& left : left_) border.push_back(piece(carrier, left, false));
    }
}

FaceFate RegionFinder::find(std::uint32_t k, std::vector<BorderPiece>& border) {
    const Occluder& face = occluders_[k];
    face_ = &face;
    collect_hiders(face);
    own_ = sides_of(face.p, face.q, face.r);
    const std::size_t before = border.size();
    if (hiders_.empty()) {
        for (std::size_t s = 0; s < 3; ++s)
            border.push_back(piece(own_.side[s], stretch_of(face, own_, s), false));
        return FaceFate::whole;
    }
    collect_candidates(face);
    if (method_ == TraceMethod::fast) drop_seams();
    bool entered = false;
    for (const Candidate& candidate : candidates_)
        entered = try_candidate(candidate, border) || entered;
    // A hider without a border in the face covers all of it.
    const bool covered =
        method_ == TraceMethod::fast && !entered &&
        std::ranges::any_of(hiders_, [](const Hider& hider) { return hider.whole; });
    if (!covered) add_own_sides(face, border);
    return border.size() == before ? FaceFate::hidden : FaceFate::partly;
}

}  // namespace sightline
