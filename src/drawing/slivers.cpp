#include "drawing/slivers.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>

#include "math/arena.hpp"
#include "math/predicates.hpp"

namespace sightline {
namespace {

double cross(const glm::dvec2& u, const glm::dvec2& v) { return u.x * v.y - u.y * v.x; }

double length_of(const BorderPiece& piece) {
    const glm::dvec2 along = piece.exact_to - piece.exact_from;
    return std::sqrt(along.x * along.x + along.y * along.y);
}

double length_of(std::span<const BorderPiece> pieces) {
    double sum = 0;
    for (const BorderPiece& piece : pieces) sum += length_of(piece);
    return sum;
}

/// Without the seams between triangles of one polygon: sides of theirs that stand there in both
/// directions.
double length_without_seams(std::span<const BorderPiece> pieces) {
    struct Side {
        glm::ivec2 low, high;
        int direction;
        double length;
        [[nodiscard]] auto place() const { return std::tuple(low.x, low.y, high.x, high.y); }
    };
    std::vector<Side> sides;
    double sum = 0;
    for (const BorderPiece& piece : pieces) {
        const bool forward =
            std::tie(piece.from.x, piece.from.y) < std::tie(piece.to.x, piece.to.y);
        if (!piece.own)
            sum += length_of(piece);
        else
            sides.push_back({forward ? piece.from : piece.to, forward ? piece.to : piece.from,
                             forward ? 1 : -1, length_of(piece)});
    }
    std::ranges::sort(sides, [](const Side& a, const Side& b) {
        return std::tuple(a.place(), a.direction, a.length) <
               std::tuple(b.place(), b.direction, b.length);
    });
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
        int direction = 0;
        double longest = 0;
        for (; end < sides.size() && sides[end].place() == sides[i].place(); ++end) {
            direction += sides[end].direction;
            longest = std::max(longest, sides[end].length);
        }
        sum += std::abs(direction) * longest;
    }
    return sum;
}

/// Doubled areas and lengths: whether 2 area / length is at most kSliverWidth.
bool is_narrow(double doubled, double length) { return doubled <= kSliverWidth * length; }

// -- heirs -------------------------------------------------------------------------------------

/// A polygon that borders a sliver, and how long.
struct Neighbour {
    std::uint32_t polygon;
    double length;
};

class NeighbourFinder {
public:
    NeighbourFinder(const ScreenScene& page, const Occluders& occluders)
        : page_(page), occluders_(occluders) {}

    /// The longest first.
    std::vector<Neighbour> find(const Sliver& sliver) {
        std::vector<Neighbour> all;
        for (const BorderPiece& piece : sliver.border) {
            const std::uint32_t polygon = piece.own ? kNone : beyond(piece, sliver.polygon);
            if (polygon != kNone) all.push_back({polygon, length_of(piece)});
        }
        std::ranges::sort(all, [](const Neighbour& a, const Neighbour& b) {
            return std::tie(a.polygon, a.length) < std::tie(b.polygon, b.length);
        });
        std::vector<Neighbour> sums;
        for (const Neighbour& n : all) {
            if (sums.empty() || sums.back().polygon != n.polygon) sums.push_back({n.polygon, 0});
            sums.back().length += n.length;
        }
        std::ranges::stable_sort(sums, std::greater(), &Neighbour::length);
        return sums;
    }

private:
    /// The polygon that is seen beside the middle of a piece, on the side of what hides.
    std::uint32_t beyond(const BorderPiece& piece, std::uint32_t self) {
        const double length = length_of(piece);
        if (!(length > 0)) return kNone;
        const glm::dvec2 along = (piece.exact_to - piece.exact_from) / length;
        // Far enough to be beyond the line when rounded.
        const glm::dvec2 at =
            0.5 * (piece.exact_from + piece.exact_to) + 1.5 * glm::dvec2(along.y, -along.x);
        const auto x = static_cast<std::int32_t>(std::nearbyint(at.x));
        const auto y = static_cast<std::int32_t>(std::nearbyint(at.y));
        const Occluder* nearest = nullptr;
        occluders_.near_box({x, x, y, y}, kDepthMax, marks_, [&](std::uint32_t k) {
            const Occluder& o = occluders_[k];
            if (polygon_of(o) == self || !holds(o, x, y)) return;
            if (nearest == nullptr || is_before(o, *nearest, x, y)) nearest = &o;
        });
        return nearest == nullptr ? kNone : polygon_of(*nearest);
    }
    [[nodiscard]] std::uint32_t polygon_of(const Occluder& o) const {
        return page_.scene().triangle_polygon[o.id];
    }
    static bool holds(const Occluder& o, std::int32_t x, std::int32_t y) {
        for (std::size_t k = 0; k < 3; ++k) {
            const ScreenPoint &a = o.point(k), &b = o.point(Occluder::next(k));
            if (side(a.x, a.y, b.x, b.y, x, y) < 0) return false;
        }
        return true;
    }
    static bool is_before(const Occluder& a, const Occluder& b, std::int32_t x, std::int32_t y) {
        const int order = compare_depth(a.plane, b.plane, x, y).sign;
        return order != 0 ? order < 0 : a.id < b.id;
    }

    const ScreenScene& page_;
    const Occluders& occluders_;
    VisitMarks marks_;
};

}  // namespace

void FaceSight::clear() {
    doubled_ = own_doubled_ = 0;
    border_.clear();
    outline_.clear();
}

double FaceSight::add(const Occluder& o, std::span<const BorderPiece> border) {
    // From a corner of the face, so that little is lost in the sum.
    const glm::dvec2 origin(o.p.x, o.p.y);
    double doubled = 0;
    for (const BorderPiece& piece : border)
        doubled += cross(piece.exact_from - origin, piece.exact_to - origin);
    doubled_ += doubled;
    own_doubled_ += static_cast<double>(side(o.p.x, o.p.y, o.q.x, o.q.y, o.r.x, o.r.y));
    border_.insert(border_.end(), border.begin(), border.end());
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &a = o.point(k), &b = o.point(Occluder::next(k));
        const glm::ivec2 from(a.x, a.y), to(b.x, b.y);
        outline_.push_back({from, to, glm::dvec2(from), glm::dvec2(to), true});
    }
    return doubled;
}

bool FaceSight::is_sliver() const {
    if (border_.empty()) return false;
    // Seams only make a border longer, so most are dismissed without a look for them.
    if (!is_narrow(doubled_, length_of(border_))) return false;
    return is_narrow(doubled_, length_without_seams(border_)) &&
           !is_narrow(own_doubled_, length_without_seams(outline_));
}

void find_heirs(const ScreenScene& page, const Occluders& occluders,
                std::span<const std::uint8_t> seen, std::vector<Sliver>& slivers, int threads) {
    if (slivers.empty()) return;
    std::ranges::sort(slivers, {}, &Sliver::polygon);
    std::vector<std::vector<Neighbour>> neighbours(slivers.size());
    tbb::enumerable_thread_specific<NeighbourFinder> finders(
        [&] { return NeighbourFinder(page, occluders); });
    in_arena(threads, [&] {
        tbb::parallel_for(std::size_t{0}, slivers.size(),
                          [&](std::size_t i) { neighbours[i] = finders.local().find(slivers[i]); });
    });
    const auto heir_through = [&](std::uint32_t polygon) {
        if (seen[polygon] != 0) return polygon;
        const auto other = std::ranges::lower_bound(slivers, polygon, {}, &Sliver::polygon);
        return other != slivers.end() && other->polygon == polygon ? other->heir : kNone;
    };
    // Round by round, away from what is seen; heirs found in a round count from the next on.
    for (bool found = true; found;) {
        std::vector<std::pair<std::size_t, std::uint32_t>> heirs;
        for (std::size_t i = 0; i < slivers.size(); ++i) {
            if (slivers[i].heir != kNone) continue;
            for (const Neighbour& n : neighbours[i]) {
                const std::uint32_t heir = heir_through(n.polygon);
                if (heir == kNone) continue;
                heirs.emplace_back(i, heir);
                break;
            }
        }
        for (const auto& [i, heir] : heirs) slivers[i].heir = heir;
        found = !heirs.empty();
    }
}

}  // namespace sightline
