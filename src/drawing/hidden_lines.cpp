#include "drawing/hidden_lines.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

bool contains(std::span<const std::uint32_t> list, std::uint32_t item) {
    return std::ranges::find(list, item) != list.end();
}

/// So many new intervals are gathered before they are merged with the others.
constexpr std::size_t kMergeAt = 4;

Int128 magnitude(Int128 value) { return value < 0 ? -value : value; }

/// The part of a line where linear functions are positive, cut down one function at a time.
class Range {
public:
    /// Values at both ends, not both 0. False when nothing is left.
    template <class T>
    bool cut(T at_start, T at_end) {
        if (at_start <= 0 && at_end <= 0) return false;
        if (at_start < 0) {
            const EdgeParam t = EdgeParam::of_zero(at_start, at_end);
            if (interval_.from < t) interval_.from = t;
        } else if (at_end < 0) {
            const EdgeParam t = EdgeParam::of_zero(at_start, at_end);
            if (t < interval_.to) interval_.to = t;
        }
        return true;
    }
    [[nodiscard]] bool empty() const { return !(interval_.from < interval_.to); }
    [[nodiscard]] const EdgeInterval& interval() const { return interval_; }

private:
    EdgeInterval interval_{EdgeParam::start(), EdgeParam::end()};
};

}  // namespace

int side_of_plane(const Plane& plane, Int128 depth_behind) {
    return magnitude(depth_behind) <= touching_zone(plane) ? 0 : sign_of(depth_behind);
}

int side_of_plane(const Plane& plane, const ScreenPoint& s) {
    // Differences are exact; each product is off by 2 * 2^-53 of itself and the sum by as much of
    // the magnitudes again; the bound, too, is rounded. 8 leaves room for all.
    constexpr double kBound = 8 * 0x1p-53;
    const double a = static_cast<double>(plane.a), b = static_cast<double>(plane.b),
                 c = static_cast<double>(plane.c);
    const double z = c * (static_cast<double>(s.z) - plane.at.z);
    const double x = a * (static_cast<double>(s.x) - plane.at.x);
    const double y = b * (static_cast<double>(s.y) - plane.at.y);
    const double depth = z - x - y, touching = 2 * (c + std::abs(a) + std::abs(b));
    const double error = kBound * (std::abs(z) + std::abs(x) + std::abs(y) + touching);
    if (depth > touching + error) return 1;
    if (depth < -touching - error) return -1;
    if (std::abs(depth) < touching - error) return 0;
    return side_of_plane(plane, depth_behind(plane, s));
}

void HiddenLineFinder::test(const PageSegment& s, const Occluder& o) {
    ++tests_;
    Range range;
    Sides sides = kBoth;
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint &from = o.point(k), &to = o.point(Occluder::next(k));
        const std::int64_t at_p = side(from.x, from.y, to.x, to.y, s.p.x, s.p.y);
        const std::int64_t at_q = side(from.x, from.y, to.x, to.y, s.q.x, s.q.y);
        if (at_p == 0 && at_q == 0) {
            // The occluder lies on the right of its sides.
            const std::int64_t along =
                (std::int64_t{to.x} - from.x) * (std::int64_t{s.q.x} - s.p.x) +
                (std::int64_t{to.y} - from.y) * (std::int64_t{s.q.y} - s.p.y);
            sides = along > 0 ? kRight : kLeft;
        } else if (!range.cut(at_p, at_q)) {
            return;
        }
    }
    if (range.empty() || (sides == kBoth && is_covered(range.interval()))) return;
    if (contains(s.faces, o.id) || (o.sheet != kNone && contains(s.sheets, o.sheet))) return;
    const int p_side = side_of_plane(o.plane, s.p), q_side = side_of_plane(o.plane, s.q);
    if (p_side <= 0 && q_side <= 0) return;
    if (p_side < 0 || q_side < 0)
        static_cast<void>(range.cut(depth_behind(o.plane, s.p), depth_behind(o.plane, s.q)));
    if (range.empty()) return;
    if (sides == kBoth)
        new_.push_back(range.interval());
    else
        halves_.push_back({range.interval(), sides});
}

bool HiddenLineFinder::is_covered(const EdgeInterval& interval) const {
    return std::ranges::any_of(hidden_, [&](const EdgeInterval& h) {
        return compare(h.from, interval.from) <= 0 && compare(interval.to, h.to) <= 0;
    });
}

/// Unites the new intervals with the others.
void HiddenLineFinder::merge_new() {
    if (new_.empty()) return;
    const auto before = [](const EdgeInterval& a, const EdgeInterval& b) {
        return a.from < b.from;
    };
    std::ranges::sort(new_, before);
    merged_.clear();
    auto old = hidden_.begin();
    auto fresh = new_.begin();
    while (old != hidden_.end() || fresh != new_.end()) {
        const bool take_old =
            fresh == new_.end() || (old != hidden_.end() && old->from < fresh->from);
        const EdgeInterval& next = take_old ? *old++ : *fresh++;
        if (merged_.empty() || merged_.back().to < next.from)
            merged_.push_back(next);
        else if (merged_.back().to < next.to)
            merged_.back().to = next.to;
    }
    std::swap(hidden_, merged_);
    new_.clear();
}

/// Adds what is hidden on the left by one occluder and on the right by another.
void HiddenLineFinder::join_halves() {
    events_.clear();
    const auto add = [&](const EdgeInterval& interval, std::uint8_t sides) {
        events_.push_back({interval.from, sides, 1});
        events_.push_back({interval.to, sides, -1});
    };
    for (const EdgeInterval& both : hidden_) add(both, kBoth);
    for (const HalfCover& half : halves_) add(half.interval, half.side);
    std::ranges::sort(events_, [](const Event& e, const Event& f) { return e.at < f.at; });
    hidden_.clear();
    int left = 0, right = 0;
    for (std::size_t i = 0; i < events_.size();) {
        const bool was_hidden = left > 0 && right > 0;
        const EdgeParam at = events_[i].at;
        for (; i < events_.size() && events_[i].at == at; ++i) {
            if ((events_[i].sides & kLeft) != 0) left += events_[i].change;
            if ((events_[i].sides & kRight) != 0) right += events_[i].change;
        }
        const bool is_hidden = left > 0 && right > 0;
        if (is_hidden && !was_hidden) hidden_.push_back({at, at});
        if (!is_hidden && was_hidden) hidden_.back().to = at;
    }
}

bool HiddenLineFinder::all_hidden() const {
    return hidden_.size() == 1 && hidden_[0].from.num == 0 &&
           hidden_[0].to.num == hidden_[0].to.den;
}

bool HiddenLineFinder::is_hidden_between(double t0, double t1) const {
    // Values are rounded, and so are the ends of cells: by far less than this.
    constexpr double kSlack = 0x1p-44;
    return std::ranges::any_of(hidden_, [&](const EdgeInterval& h) {
        return (h.from.num == 0 || h.from.value < t0 - kSlack) &&
               (h.to.num == h.to.den || h.to.value > t1 + kSlack);
    });
}

// Where the line is hidden already no further occluder matters.
bool HiddenLineFinder::enter(double t0, double t1) {
    merge_new();
    cell_from_ = t0;
    cell_to_ = t1;
    return !is_hidden_between(t0, t1);
}

bool HiddenLineFinder::visit(std::uint32_t k) {
    test(*segment_, occluders_[k]);
    if (new_.size() < (hidden_.empty() ? 1 : kMergeAt)) return true;
    merge_new();
    return !is_hidden_between(cell_from_, cell_to_);
}

std::span<const EdgeInterval> HiddenLineFinder::find(const PageSegment& s) {
    hidden_.clear();
    new_.clear();
    halves_.clear();
    segment_ = &s;
    cell_from_ = 0;
    cell_to_ = 1;
    occluders_.walk(s.p, s.q, std::max(s.p.z, s.q.z), marks_, *this);
    merge_new();
    if (!halves_.empty()) join_halves();
    return hidden_;
}

}  // namespace sightline
