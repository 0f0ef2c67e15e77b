#include "drawing/region_loops.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace sightline {
namespace {

/// A piece, rounded.
struct Arrow {
    glm::ivec2 from, to;
    bool used = false;
};

auto key(const glm::ivec2& p) { return std::tuple(p.x, p.y); }

std::int64_t cross(const glm::ivec2& u, const glm::ivec2& v) {
    return std::int64_t{u.x} * v.y - std::int64_t{u.y} * v.x;
}

/// Pieces without those of no length and without those that stand there in both directions.
std::vector<Arrow> without_seams(const std::vector<BorderPiece>& pieces) {
    struct Undirected {
        glm::ivec2 low, high;
        int direction;
    };
    std::vector<Undirected> all;
    all.reserve(pieces.size());
    for (const BorderPiece& piece : pieces) {
        if (piece.from == piece.to) continue;
        const bool forward = key(piece.from) < key(piece.to);
        all.push_back(
            {forward ? piece.from : piece.to, forward ? piece.to : piece.from, forward ? 1 : -1});
    }
    const auto place = [](const Undirected& u) {
        return std::tuple(u.low.x, u.low.y, u.high.x, u.high.y);
    };
    std::ranges::sort(all, {}, place);
    std::vector<Arrow> arrows;
    for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
        int sum = 0;
        for (; end < all.size() && place(all[end]) == place(all[i]); ++end)
            sum += all[end].direction;
        for (; sum > 0; --sum) arrows.push_back({all[i].low, all[i].high});
        for (; sum < 0; ++sum) arrows.push_back({all[i].high, all[i].low});
    }
    std::ranges::sort(
        arrows, {}, [](const Arrow& a) { return std::tuple(a.from.x, a.from.y, a.to.x, a.to.y); });
    return arrows;
}

/// Whether direction u turns farther to the right than v, coming from `before`. The rightmost way
/// out keeps loops apart that only touch, for the region lies on the right. y grows down.
bool turns_farther(const glm::ivec2& before, const glm::ivec2& u, const glm::ivec2& v) {
    // 0: to the right, 1: straight on, 2: to the left.
    const auto half = [&](const glm::ivec2& w) {
        const std::int64_t c = cross(before, w);
        return c > 0 ? 0 : c == 0 ? 1 : 2;
    };
    if (half(u) != half(v)) return half(u) < half(v);
    return cross(u, v) < 0;
}

Arrow* next_arrow(std::vector<Arrow>& arrows, const Arrow& before) {
    const auto from = [](const Arrow& a) { return key(a.from); };
    Arrow* best = nullptr;
    for (auto at = std::ranges::lower_bound(arrows, key(before.to), {}, from);
         at != arrows.end() && at->from == before.to; ++at) {
        if (at->used) continue;
        if (best == nullptr ||
            turns_farther(before.to - before.from, at->to - at->from, best->to - best->from))
            best = &*at;
    }
    return best;
}

/// Whether b lies on the straight way from a to c.
bool is_on_the_way(const glm::ivec2& a, const glm::ivec2& b, const glm::ivec2& c) {
    const glm::ivec2 u = b - a, v = c - b;
    return cross(u, v) == 0 && std::int64_t{u.x} * v.x + std::int64_t{u.y} * v.y >= 0;
}

/// Adds a point, and takes away the one before when it lies on the way to the new one.
void add_point(std::vector<glm::ivec2>& points, std::size_t first, const glm::ivec2& p) {
    while (points.size() >= first + 2 && is_on_the_way(points[points.size() - 2], points.back(), p))
        points.pop_back();
    points.push_back(p);
}

/// Takes points away in the same way where the end of a loop meets its beginning.
void close_loop(std::vector<glm::ivec2>& points, std::size_t first) {
    while (points.size() >= first + 3 &&
           is_on_the_way(points[points.size() - 2], points.back(), points[first]))
        points.pop_back();
    if (points.size() >= first + 3 &&
        is_on_the_way(points.back(), points[first], points[first + 1]))
        points.erase(points.begin() + static_cast<std::ptrdiff_t>(first));
}

}  // namespace

void join_loops(std::vector<BorderPiece>& pieces, RegionLoops& loops) {
    std::vector<Arrow> arrows = without_seams(pieces);
    pieces.clear();
    if (loops.first.empty()) loops.first.push_back(0);
    for (Arrow& start : arrows) {
        if (start.used) continue;
        const std::size_t first = loops.points.size();
        for (Arrow* at = &start; at != nullptr; at = next_arrow(arrows, *at)) {
            at->used = true;
            add_point(loops.points, first, at->from);
            if (at->to == start.from) break;
        }
        close_loop(loops.points, first);
        if (loops.points.size() - first < 3)
            loops.points.resize(first);
        else
            loops.first.push_back(static_cast<std::uint32_t>(loops.points.size()));
    }
}

}  // namespace sightline
