// Ears. Sources: G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975;
// J. O'Rourke, "Computational Geometry in C", 1998, section 1.4: cutting an ear changes only the
// two corners beside it, so a queue of candidates suffices.
//
// How this differs: every second corner is tried first, which avoids slivers; what may block an ear
// is looked up in a grid, or in the list of reflex corners where that is shorter. And files hold
// polygons that touch or cross themselves:
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
namespace {

/// Below this many corners a list of the reflex ones is quicker than a grid.
constexpr std::size_t kGridFrom = 64;

std::uint32_t cell_index(double offset, double cell, std::uint32_t cells) {
    const double index = offset / cell;
    return index > 0 ? static_cast<std::uint32_t>(std::min(index, static_cast<double>(cells) - 1))
                     : 0;
}

}  // namespace

void CornerGrid::build(std::span<const glm::dvec2> points) {
    glm::dvec2 lo = points[0], hi = points[0];
    for (const glm::dvec2& p : points) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    // About two corners a cell, cells about square.
    const double cells = static_cast<double>(points.size()) / 2;
    const glm::dvec2 size = glm::max(hi - lo, glm::dvec2(1e-300));
    const double columns = std::clamp(std::sqrt(cells * (size.x / size.y)), 1.0, cells);
    columns_ = static_cast<std::uint32_t>(columns);
    rows_ = static_cast<std::uint32_t>(std::clamp(cells / columns, 1.0, cells));
    origin_ = lo;
    cell_ = {size.x / columns_, size.y / rows_};
    first_.assign(std::size_t{columns_} * rows_ + 1, 0);
    const auto cell_of = [&](const glm::dvec2& p) {
        return std::size_t{row(p.y)} * columns_ + column(p.x);
    };
    for (const glm::dvec2& p : points) ++first_[cell_of(p)];
    std::uint32_t end = 0;
    for (std::uint32_t& f : first_) f = end += f;
    corners_.resize(points.size());
    for (std::size_t i = points.size(); i-- > 0;) {
        corners_[--first_[cell_of(points[i])]] = static_cast<std::uint32_t>(i);
    }
}

std::uint32_t CornerGrid::column(double x) const {
    return cell_index(x - origin_.x, cell_.x, columns_);
}

std::uint32_t CornerGrid::row(double y) const { return cell_index(y - origin_.y, cell_.y, rows_); }

CornerGrid::Cells CornerGrid::cells_of(const glm::dvec2& lo, const glm::dvec2& hi) const {
    return {column(lo.x), column(hi.x), row(lo.y), row(hi.y)};
}

std::span<const std::uint32_t> CornerGrid::corners_in(std::uint32_t x, std::uint32_t y) const {
    const std::size_t cell = std::size_t{y} * columns_ + x;
    return std::span(corners_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
}

bool EarCutter::cut(std::span<const glm::dvec2> points, double same_angle, std::uint64_t most,
                    std::vector<PolygonTriangle>& triangles) {
    same_angle_ = same_angle;
    limit_ = work_ + most;
    start(points);
    while (left_ > 3 && work_ <= limit_) {
        if (const auto tip = next_of(backs_)) {
            cut_off(*tip, triangles);
        } else if (const auto corner = next_of(queue_)) {
            if (is_ear(*corner, Strictness::proper)) cut_off(*corner, triangles);
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
    has_grid_ = points.size() >= kGridFrom;
    if (has_grid_) grid_.build(points);
    corners_.assign(left_, {});
    queue_.clear();
    backs_.clear();
    flats_.clear();
    reflex_.clear();
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
    c.reflex = area < 0 || back;
    if (c.reflex && !c.listed) {
        c.listed = true;
        reflex_.push_back(corner);
    }
    (back ? backs_ : area == 0 ? flats_ : queue_).push_back({corner, ++c.stamp});
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
    corners_[c.prev].next = c.next;
    corners_[c.next].prev = c.prev;
    start_ = c.next;
    --left_;
    touch(c.prev);
    touch(c.next);
}

/// The first corner that is an ear under the strictest condition that any corner meets.
std::uint32_t EarCutter::relaxed_ear() {
    for (const Strictness strictness : {Strictness::touching, Strictness::convex}) {
        std::uint32_t corner = start_;
        for (std::uint32_t i = 0; i < left_ && work_ <= limit_; ++i) {
            if (is_ear(corner, strictness)) return corner;
            corner = corners_[corner].next;
        }
    }
    return start_;
}

bool EarCutter::is_ear(std::uint32_t corner, Strictness strictness) {
    ++work_;
    const Corner& c = corners_[corner];
    const double area = turn(points_[c.prev], points_[corner], points_[c.next]);
    switch (strictness) {
        case Strictness::proper:
        case Strictness::touching:
            return area > 0 && !blocked(corner, strictness);
        case Strictness::convex:
            return area > 0;
    }
    return true;
}

bool EarCutter::blocked(std::uint32_t corner, Strictness strictness) {
    const Corner& c = corners_[corner];
    const glm::dvec2 &a = points_[c.prev], &b = points_[corner], &d = points_[c.next];
    const glm::dvec2 lo = glm::min(glm::min(a, b), d), hi = glm::max(glm::max(a, b), d);
    const CornerGrid::Cells cells = has_grid_ ? grid_.cells_of(lo, hi) : CornerGrid::Cells{};
    if (!has_grid_ || cells.count() >= reflex_.size()) return blocked_by_list(corner, strictness);
    for (std::uint32_t y = cells.y0; y <= cells.y1; ++y) {
        for (std::uint32_t x = cells.x0; x <= cells.x1; ++x) {
            const auto others = grid_.corners_in(x, y);
            work_ += 1 + others.size();
            for (const std::uint32_t o : others) {
                if (blocks(o, corner, strictness)) return true;
            }
        }
    }
    return false;
}

bool EarCutter::blocked_by_list(std::uint32_t corner, Strictness strictness) {
    for (std::size_t i = 0; i < reflex_.size();) {
        ++work_;
        Corner& other = corners_[reflex_[i]];
        if (!other.alive || !other.reflex) {
            other.listed = false;
            reflex_[i] = reflex_.back();
            reflex_.pop_back();
            continue;
        }
        if (blocks(reflex_[i], corner, strictness)) return true;
        ++i;
    }
    return false;
}

bool EarCutter::blocks(std::uint32_t other, std::uint32_t corner, Strictness strictness) const {
    const Corner &o = corners_[other], &c = corners_[corner];
    if (!o.alive || !o.reflex) return false;
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
