// Subdivision of a quadrant of the first level.
//
// Source: J. Warnock, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures",
// 1969; the lists by J. Blinn, "Triage Tables", IEEE Computer Graphics and Applications 10(1),
// 1990: what is disjoint or hidden goes, what surrounds a quadrant surrounds its parts without
// another look, only the rest is classified again.
//
// Depth is judged at corner samples. The difference of two planes is linear over the page, so a
// surface that is the nearer one, by exact depth and then id, at the four corner samples of a
// rectangle is the nearer one at every sample of it. That holds for planes beyond their triangles,
// and for the smallest rectangle that holds what a triangle may cover of a quadrant.
#include "visibility/warnock_quadrants.hpp"

#include <hwy/cache_control.h>

#include <cassert>
#include <cmath>
#include <limits>

#include "visibility/scan_edges.hpp"

namespace sightline::warnock {

namespace {

constexpr std::uint32_t kSurrounds = std::uint32_t{1} << 31;
constexpr std::uint32_t kIndex = kSurrounds - 1;

constexpr Count count_of(Relation relation) {
    return static_cast<Count>(static_cast<int>(Count::disjoint) + static_cast<int>(relation));
}
static_assert(count_of(Relation::surrounding) == Count::surrounding);

}  // namespace

Subdivider::Subdivider(const ScreenScene& screen, const SampleUnits& units, Observer* observer,
                       int direct_bits, Visibility& out)
    : screen_(screen),
      units_(units),
      observer_(observer),
      direct_bits_(direct_bits),
      out_(out),
      judge_(screen, units, observer) {
    assert(direct_bits <= kBlockBits);
}

Subdivider::Counts Subdivider::counts() const {
    Counts all = counts_;
    all[Count::comparisons] += judge_.comparisons;
    all[Count::exact] += judge_.exact;
    return all;
}

void Subdivider::tell(StepKind kind, std::uint32_t triangle, std::uint32_t other,
                      const Rect& r) const {
    if (observer_ == nullptr) return;
    observer_->step({kind, triangle, other, static_cast<std::uint32_t>(r.i0),
                     static_cast<std::uint32_t>(r.j0), static_cast<std::uint32_t>(r.i1 + 1),
                     static_cast<std::uint32_t>(r.j1 + 1)});
}

void Subdivider::set_up(std::span<const std::uint32_t> numbers, const Rect& quadrant) {
    // Corners and points lie scattered over memory.
    constexpr std::size_t kCornersAhead = 12, kPointsAhead = 5;
    const std::uint32_t whole = screen_.scene().triangle_count();
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (k + kCornersAhead < numbers.size() && numbers[k + kCornersAhead] < whole)
            hwy::Prefetch(&screen_.scene().triangles[numbers[k + kCornersAhead]]);
        if (k + kPointsAhead < numbers.size()) {
            const Corners c = screen_.corners(numbers[k + kPointsAhead]);
            for (int corner = 0; corner < 3; ++corner) hwy::Prefetch(&screen_.point(c[corner]));
        }
        add(numbers[k], quadrant);
    }
}

void Subdivider::add(std::uint32_t number, const Rect& quadrant) {
    const Corners c = screen_.corners(number);
    const ScreenPoint &p = screen_.point(c.x), &q = screen_.point(c.y), &r = screen_.point(c.z);
    const OrientedTriangle triangle(p, q, r);
    if (triangle.area2 == 0) return;
    Item item;
    item.shape = Shape(triangle, box_of(p, q, r, units_), units_);
    const Rect here = intersection(item.shape.box, quadrant);
    for (EdgeFunction& edge : item.shape.edges) {
        if (edge.greatest(here) < 0) return;
        // Nobody asks beyond `here`, and there the edge has nothing to say.
        if (edge.least(here) >= 0) edge = {};
    }
    item.surface = sampled_plane_of(screen_, units_, number);
    item.number = number;
    tell(StepKind::triangle_taken, item.surface.id, kNone, here);
    items_.push_back(item);
    boxes_.push_back(here);
    ++counts_[Count::set_up];
}

void Subdivider::run(const Quadrant& quadrant, std::span<const std::uint32_t> numbers) {
    items_.clear();
    boxes_.clear();
    set_up(numbers, quadrant.samples(units_));
    lists_.resize(items_.size());
    for (std::uint32_t k = 0; k < items_.size(); ++k) lists_[k] = k;
    take(quadrant, 0, lists_.size());
}

// Lists begin .. end-1 hold what may be seen in the quadrant that this one is a part of.
void Subdivider::take(const Quadrant& quadrant, std::size_t begin, std::size_t end) {
    const Rect r = quadrant.samples(units_);
    if (r.empty()) return;
    const auto [first, hidden_behind] = triage(r, begin, end);
    const std::size_t count = lists_.size() - first;
    if (count == 0) {
        ++counts_[Count::empty];
        fill(r, nullptr);
    } else if (count == 1 && (lists_[first] & kSurrounds) != 0) {
        ++counts_[hidden_behind ? Count::in_front : Count::surrounded];
        fill(r, &items_[lists_[first] & kIndex]);
    } else if (count == 1) {
        ++counts_[Count::single];
        scan(r, items_[lists_[first]]);
    } else if (quadrant.bits <= direct_bits_) {
        ++counts_[Count::direct];
        decide_directly(r, first, lists_.size());
    } else {
        split(quadrant, first, lists_.size());
    }
    lists_.resize(first);
}

void Subdivider::split(const Quadrant& quadrant, std::size_t begin, std::size_t end) {
    ++counts_[Count::subdivisions];
    tell(StepKind::quadrant_split, kNone, kNone, quadrant.samples(units_));
    const int bits = quadrant.bits - 1;
    const std::int32_t half = std::int32_t{1} << bits;
    take({quadrant.i, quadrant.j, bits}, begin, end);
    take({quadrant.i + half, quadrant.j, bits}, begin, end);
    take({quadrant.i, quadrant.j + half, bits}, begin, end);
    take({quadrant.i + half, quadrant.j + half, bits}, begin, end);
}

// Appends what of lists begin .. end-1 still matters in r.
Subdivider::Survivors Subdivider::triage(const Rect& r, std::size_t begin, std::size_t end) {
    const std::size_t first = lists_.size();
    std::uint32_t hider = kNone;
    double hider_depth = std::numeric_limits<double>::infinity();  // no sample of it is farther
    lists_.resize(first + (end - begin));
    // Most boxes lie elsewhere, which no processor can foresee: no branch here.
    std::size_t met = first;
    for (std::size_t k = begin; k < end; ++k) {
        const Rect& box = boxes_[lists_[k] & kIndex];
        lists_[met] = lists_[k];
        const bool apart = (box.i0 > r.i1) | (box.j0 > r.j1) | (box.i1 < r.i0) | (box.j1 < r.j0);
        met += apart ? 0 : 1;
    }
    counts_[Count::disjoint] += end - begin - (met - first);
    std::size_t top = first;
    for (std::size_t k = first; k < met; ++k) {
        std::uint32_t entry = lists_[k];
        const Item& item = items_[entry & kIndex];
        if ((entry & kSurrounds) == 0) {
            const Relation relation = item.shape.relation(r);
            ++counts_[count_of(relation)];
            if (relation == Relation::disjoint) continue;
            if (relation == Relation::surrounding) entry |= kSurrounds;
        }
        lists_[top++] = entry;
        if ((entry & kSurrounds) == 0) continue;
        const double depth = farthest_depth(item.surface, r);
        if (depth < hider_depth ||
            (depth == hider_depth && item.surface.id < items_[hider].surface.id)) {
            hider_depth = depth;
            hider = entry & kIndex;
        }
    }
    lists_.resize(top);
    const std::size_t before = top - first;
    if (hider != kNone && before > 1)
        while (!sweep(r, first, hider)) {
        }
    const std::size_t dropped = before - (lists_.size() - first);
    counts_[Count::hidden] += dropped;
    return {first, dropped > 0};
}

// Drops what lies behind the hider. Returns false, with a new hider, when that one lies itself
// behind another surrounding one. It ends: each hider is nearer than the one before.
bool Subdivider::sweep(const Rect& r, std::size_t first, std::uint32_t& hider) {
    const Item& front = items_[hider];
    const double depth = farthest_depth(front.surface, r);
    std::size_t top = first;
    std::uint32_t better = kNone;
    for (std::size_t k = first; k < lists_.size(); ++k) {
        const std::uint32_t entry = lists_[k], index = entry & kIndex;
        const Item& item = items_[index];
        if (index != hider && better == kNone) {
            const Rect seen = intersection(item.shape.box, r);
            ++counts_[Count::comparisons];
            if (nearest_depth(item.surface, seen) > depth || hides(front, item, seen)) {
                tell(StepKind::block_dismissed, item.surface.id, front.surface.id, r);
                continue;
            }
            if ((entry & kSurrounds) != 0 && hides(item, front, r)) better = index;
        }
        lists_[top++] = entry;
    }
    lists_.resize(top);
    if (better == kNone) return true;
    hider = better;
    return false;
}

// Whether a is nearer than b, by depth and id, in all of r.
bool Subdivider::hides(const Item& a, const Item& b, const Rect& r) {
    return judge_.before(a.surface, b.surface, r.i0, r.j0) &&
           judge_.before(a.surface, b.surface, r.i1, r.j1) &&
           judge_.before(a.surface, b.surface, r.i1, r.j0) &&
           judge_.before(a.surface, b.surface, r.i0, r.j1);
}

void Subdivider::fill(const Rect& r, const Item* owner) {
    tell(StepKind::quadrant_decided, owner == nullptr ? kNone : owner->surface.id, kNone, r);
    for (std::int32_t j = r.j0; j <= r.j1; ++j) {
        if (owner == nullptr)
            fill_background(r.i0, r.i1 + 1, id_row(j), depth_row(j));
        else
            fill_run(screen_, units_, owner->surface, j, r.i0, r.i1 + 1, id_row(j), depth_row(j));
    }
}

// The background, then the only triangle: each sample is written once.
void Subdivider::scan(const Rect& r, const Item& item) {
    tell(StepKind::quadrant_scanned, item.surface.id, kNone, r);
    const Corners c = screen_.corners(item.number);
    RowTriangle rows(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z), units_, r.j0);
    for (std::int32_t j = r.j0; j <= r.j1; ++j) {
        std::int32_t left = r.i1 + 1, right = left;
        if (!rows.empty() && rows.row() == j) {
            left = std::clamp(rows.left(), r.i0, r.i1 + 1);
            right = std::clamp(rows.right(), left, r.i1 + 1);
            rows.advance(units_);
        }
        fill_background(r.i0, left, id_row(j), depth_row(j));
        fill_run(screen_, units_, item.surface, j, left, right, id_row(j), depth_row(j));
        fill_background(right, r.i1 + 1, id_row(j), depth_row(j));
    }
}

// -- quadrants that are not divided: the nearest of a short list at each sample -----------------

void Subdivider::decide_directly(const Rect& r, std::size_t begin, std::size_t end) {
    Block block;
    block.clear();
    double slack = 0;
    for (std::size_t k = begin; k < end; ++k)
        slack = std::max(slack, 2 * items_[lists_[k] & kIndex].surface.slack);
    for (std::size_t k = begin; k < end; ++k) offer(lists_[k] & kIndex, r, slack, block);
    write(block, r);
}

// The depth is summed up in another order than SampledPlane::depth() does: its bound becomes
// 4 u X + 5 u Y + 5 u R + 3 u at.z, which is still below the one kept.
void Subdivider::offer(std::uint32_t index, const Rect& r, double slack, Block& block) {
    const Item& item = items_[index];
    const SampledPlane& s = item.surface;
    const Rect seen = intersection(item.shape.box, r);
    Newcomer newcomer;
    newcomer.owner = index;
    newcomer.column0 = seen.i0 - r.i0, newcomer.column1 = seen.i1 - r.i0;
    newcomer.row0 = seen.j0 - r.j0, newcomer.row1 = seen.j1 - r.j0;
    for (std::size_t k = 0; k < 3; ++k) {
        const EdgeFunction& edge = item.shape.edges[k];
        if (edge.least(seen) >= 0) continue;  // settled: 0 everywhere
        // It changes its sign on the block, so it is below 2^24 * (15 + 15) there.
        newcomer.edge[k] = static_cast<std::int32_t>(edge.value(seen.i0, seen.j0));
        newcomer.per_column[k] = edge.per_column;
        newcomer.per_row[k] = edge.per_row;
    }
    newcomer.z0 = s.z0, newcomer.gx = s.gx, newcomer.gy = s.gy;
    newcomer.i = r.i0, newcomer.j = r.j0;
    newcomer.slack = slack;
    Doubts doubts;
    counts_[Count::comparisons] += warnock::offer(newcomer, block, doubts);
    for (std::size_t k = 0; k < doubts.count; ++k) {
        const std::size_t at = doubts.at[k];
        const std::int32_t i = r.i0 + static_cast<std::int32_t>(at) % kBlockSide;
        const std::int32_t j = r.j0 + static_cast<std::int32_t>(at) / kBlockSide;
        const Item& owner = items_[static_cast<std::size_t>(block.owner[at])];
        if (!judge_.before(s, owner.surface, i, j)) continue;
        block.depth[at] = (s.z0 + s.gy * j) + s.gx * i;
        block.owner[at] = index;
    }
}

void Subdivider::write(const Block& block, const Rect& r) {
    for (std::int32_t j = r.j0; j <= r.j1; ++j) {
        const std::int64_t* owners = block.owner + (j - r.j0) * kBlockSide;
        for (std::int32_t i = r.i0; i <= r.i1;) {
            const std::int64_t owner = owners[i - r.i0];
            std::int32_t end = i + 1;
            while (end <= r.i1 && owners[end - r.i0] == owner) ++end;
            const Item* item =
                owner == Block::kNobody ? nullptr : &items_[static_cast<std::size_t>(owner)];
            fill({i, j, end - 1, j}, item);
            i = end;
        }
    }
}

}  // namespace sightline::warnock
