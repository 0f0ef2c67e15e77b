// Ears. Sources: G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975;
// J. O'Rourke, "Computational Geometry in C", 1998, section 1.4: cutting an ear changes only the
// two corners beside it, so a queue of candidates suffices.
//
// How this differs: every second corner is tried first, which avoids slivers; what may block an ear
// is looked up in a tree of the reflex corners. And files hold polygons that touch or cross
// themselves:
//
// - Where the outline turns back on itself, the triangle at the tip has no area. It is cut off at
//   once, so spikes are eaten from their tips, and bridges as soon as what they lead to is gone: a
//   triangle without area takes nothing from the polygon, while the corners at the foot of a spike
//   look like ears that they are not.
// - Where two corners coincide, an ear is doubtful whose sides both run along those of the other
//   corner: what lies between them is inside for a bridge to a hole, and outside for a bridge
//   between two parts. It waits until such a bridge has become a spike.
// - When no proper ear is left, corners on a straight line are cut off, and then the conditions are
//   relaxed step by step (see Strictness) until an ear is found. The number of triangles never
//   changes.
#include "scene/load/ear_cutter.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sightline::load {

bool EarCutter::cut(std::span<const glm::dvec2> points, double same_angle, std::uint64_t most,
                    std::vector<PolygonTriangle>& triangles) {
    same_angle_ = same_angle;
    limit_ = work_ + most;
    start(points);
    while (left_ > 3 && work_ <= limit_) {
        if (const auto tip = next_of(backs_)) {
            cut_off(*tip, triangles);
        } else if (const auto ear = next_ear(Strictness::proper)) {
            cut_off(*ear, triangles);
        } else if (const auto flat = next_of(flats_)) {
            cut_off(*flat, triangles);
        } else {
            cut_off(relaxed_ear(), triangles);
        }
    }
    if (work_ > limit_) return false;
    const Corner& last = corners_[start_];
    triangles.push_back({start_, last.next, last.prev});
    return true;
}

void EarCutter::start(std::span<const glm::dvec2> points) {
    points_ = points;
    left_ = static_cast<std::uint32_t>(points.size());
    start_ = 0;
    reflex_.build(points);
    corners_.assign(left_, {});
    for (std::deque<Candidate>& queue : queues_) queue.clear();
    backs_.clear();
    flats_.clear();
    for (std::uint32_t i = 0; i < left_; ++i) {
        corners_[i].prev = i == 0 ? left_ - 1 : i - 1;
        corners_[i].next = i + 1 == left_ ? 0 : i + 1;
    }
    for (std::uint32_t i = 0; i < left_; ++i) touch(i);
}

/// A corner has new neighbours: puts it at the end of the queue to which it belongs.
void EarCutter::touch(std::uint32_t corner) {
    Corner& c = corners_[corner];
    const glm::dvec2 &before = points_[c.prev], &here = points_[corner], &after = points_[c.next];
    const double area = turn(before, here, after);
    const bool back = same_way(here, before, after);
    // A corner in the middle of a straight line never blocks alone: the ends of the line do. One
    // that coincides with a neighbour, or where the outline turns back, does.
    reflex_.mark(corner, area < 0 || back);
    ++c.stamp;
    if (back || area == 0) (back ? backs_ : flats_).push_back({corner, c.stamp});
    if (area > 0) queues_[0].push_back({corner, c.stamp});
}

/// Whether two points lie in one direction from a third one, or one of them coincides with it.
bool EarCutter::same_way(const glm::dvec2& from, const glm::dvec2& p, const glm::dvec2& q) const {
    return std::abs(turn(from, p, q)) <= same_angle_ * glm::dot(p - from, q - from);
}

/// Takes a corner from a queue, the first one that is left with the neighbours it had.
std::optional<std::uint32_t> EarCutter::next_of(std::deque<Candidate>& queue) {
    while (!queue.empty()) {
        const Candidate candidate = queue.front();
        queue.pop_front();
        const Corner& corner = corners_[candidate.corner];
        if (corner.alive && corner.stamp == candidate.stamp) return candidate.corner;
    }
    return std::nullopt;
}

void EarCutter::cut_off(std::uint32_t corner, std::vector<PolygonTriangle>& triangles) {
    Corner& c = corners_[corner];
    triangles.push_back({c.prev, corner, c.next});
    c.alive = false;
    reflex_.mark(corner, false);
    corners_[c.prev].next = c.next;
    corners_[c.next].prev = c.prev;
    start_ = c.next;
    --left_;
    touch(c.prev);
    touch(c.next);
}

/// A corner that is an ear under the strictest condition that any corner meets.
std::uint32_t EarCutter::relaxed_ear() {
    for (const Strictness strictness : {Strictness::touching, Strictness::convex})
        if (const auto ear = next_ear(strictness)) return *ear;
    return start_;
}

/// Each corner is asked once with the neighbours that it has, and if it is no ear, waits until less
/// is asked for. It does not matter where no two sides cross that what blocked it may be gone by
/// then: an ear is blocked there until its neighbours change.
std::optional<std::uint32_t> EarCutter::next_ear(Strictness strictness) {
    const auto level = static_cast<std::size_t>(strictness);
    while (const auto corner = next_of(queues_[level])) {
        if (work_ > limit_ || is_ear(*corner, strictness)) return corner;
        queues_[level + 1].push_back({*corner, corners_[*corner].stamp});
    }
    return std::nullopt;
}

bool EarCutter::is_ear(std::uint32_t corner, Strictness strictness) {
    ++work_;
    if (strictness == Strictness::convex) return true;  // what does not turn left is in no queue
    const Corner& c = corners_[corner];
    return !reflex_.any_in({points_[c.prev], points_[corner], points_[c.next]}, work_,
                           [&](std::uint32_t other) { return blocks(other, corner, strictness); });
}

bool EarCutter::blocks(std::uint32_t other, std::uint32_t corner, Strictness strictness) const {
    const Corner &o = corners_[other], &c = corners_[corner];
    if (other == corner || other == c.prev || other == c.next) return false;
    const std::array<glm::dvec2, 3> ear{points_[c.prev], points_[corner], points_[c.next]};
    std::array<double, 3>
        side{};  // of the point: positive inside of prev-corner, corner-next, diagonal
    for (std::size_t k = 0; k < 3; ++k) side[k] = turn(ear[k], ear[(k + 1) % 3], points_[other]);
    if (side[0] < 0 || side[1] < 0 || side[2] < 0) return false;
    const int touched = (side[0] == 0) + (side[1] == 0) + (side[2] == 0);
    if (touched == 0) return true;
    if (strictness != Strictness::proper) return false;
    if (touched == 1 && side[2] == 0) return true;  // on the diagonal
    // On a side or at a corner of the ear: it blocks when one of its own sides leads inside.
    const auto leads_inside = [&](const glm::dvec2& to) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (side[k] == 0 && !(turn(ear[k], ear[(k + 1) % 3], to) > 0)) return false;
        }
        return true;
    };
    if (leads_inside(points_[o.prev]) || leads_inside(points_[o.next])) return true;
    // Both of its sides along those of the ear, the other way round.
    return side[0] == 0 && side[1] == 0 && same_way(ear[1], points_[o.prev], ear[2]) &&
           same_way(ear[1], points_[o.next], ear[0]);
}

}  // namespace sightline::load
