#include "support/polygons.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <utility>

namespace sightline::testing {
namespace {

/// Room for points in the middle of sides and beside them.
constexpr std::int64_t kStep = 12;

int sign(std::int64_t value) { return (value > 0) - (value < 0); }

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    std::int64_t below(std::int64_t n) {
        return static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(n));
    }
    bool chance(int percent) { return below(100) < percent; }
    std::size_t corner_of(const Loop& loop) {
        return static_cast<std::size_t>(below(static_cast<std::int64_t>(loop.size())));
    }

private:
    std::mt19937_64 engine_;
};

const Point& before(const Loop& loop, std::size_t i) {
    return loop[i == 0 ? loop.size() - 1 : i - 1];
}
const Point& after(const Loop& loop, std::size_t i) { return loop[(i + 1) % loop.size()]; }

void insert(Loop& loop, std::size_t at, const Loop& points) {
    loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(at), points.begin(), points.end());
}

bool on_segment(Point a, Point b, Point p) {
    return cross(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
           std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

bool meet(Point a, Point b, Point c, Point d) {
    const bool cut = sign(cross(a, b, c)) * sign(cross(a, b, d)) < 0 &&
                     sign(cross(c, d, a)) * sign(cross(c, d, b)) < 0;
    return cut || on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) ||
           on_segment(c, d, b);
}

// -- regions -------------------------------------------------------------------------------------

/// The sides of a set of cells, the inside on the left, by where they begin.
using Sides = std::multimap<std::pair<std::int64_t, std::int64_t>, Point>;

Sides sides_of_cells(Random& random, int columns, int rows) {
    std::set<std::pair<int, int>> cells{{0, 0}};
    const auto wanted = static_cast<std::size_t>(1 + random.below(columns * rows));
    for (int tries = 0; cells.size() < wanted && tries < 40 * columns * rows; ++tries) {
        const int x = static_cast<int>(random.below(columns));
        const int y = static_cast<int>(random.below(rows));
        for (const auto& [i, j] : {std::pair{x + 1, y}, {x - 1, y}, {x, y + 1}, {x, y - 1}}) {
            if (cells.count({i, j}) != 0) cells.insert({x, y});
        }
    }
    Sides sides;
    for (const auto& [x, y] : cells) {
        const auto add = [&](int i, int j, Point from, Point to) {
            if (cells.count({i, j}) == 0) sides.insert({{from.x, from.y}, to});
        };
        add(x, y - 1, {x, y}, {x + 1, y});
        add(x + 1, y, {x + 1, y}, {x + 1, y + 1});
        add(x, y + 1, {x + 1, y + 1}, {x, y + 1});
        add(x - 1, y, {x, y + 1}, {x, y});
    }
    return sides;
}

/// One loop; to the left where two meet at a point, so that no loop touches itself.
Loop take_loop(Sides& sides) {
    const auto [key, second] = *sides.begin();
    const Point start{key.first, key.second};
    sides.erase(sides.begin());
    Loop loop{start};
    for (Point from = start, at = second; at != start;) {
        loop.push_back(at);
        const auto [first, last] = sides.equal_range({at.x, at.y});
        const auto next = std::max_element(first, last, [&](const auto& a, const auto& b) {
            return cross(from, at, a.second) < cross(from, at, b.second);
        });
        from = std::exchange(at, next->second);
        sides.erase(next);
    }
    return loop;
}

std::vector<Loop> region_of_cells(Random& random, int columns, int rows) {
    Sides sides = sides_of_cells(random, columns, rows);
    std::vector<Loop> loops;
    while (!sides.empty()) {
        const Loop all = take_loop(sides);
        Loop& loop = loops.emplace_back();
        for (std::size_t i = 0; i < all.size(); ++i) {
            const bool bend = cross(before(all, i), all[i], after(all, i)) != 0;
            if (bend || random.chance(30)) loop.push_back(all[i]);
        }
    }
    return loops;
}

/// Two sides that meet are replaced until none do ("2-opt").
std::optional<Loop> untangled(Loop loop) {
    const std::size_t n = loop.size();
    for (int round = 0; round < 1000; ++round) {
        bool changed = false;
        for (std::size_t i = 0; i < n && !changed; ++i) {
            for (std::size_t j = i + 2; j < n && !changed; ++j) {
                if (i == 0 && j == n - 1) continue;
                if (!meet(loop[i], loop[i + 1], loop[j], after(loop, j))) continue;
                std::reverse(loop.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                             loop.begin() + static_cast<std::ptrdiff_t>(j) + 1);
                changed = true;
            }
        }
        if (!changed) return loop;
    }
    return std::nullopt;
}

bool turns_back(const Loop& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Point p = before(loop, i), q = after(loop, i), at = loop[i];
        const bool ahead = (at.x - p.x) * (q.x - at.x) + (at.y - p.y) * (q.y - at.y) > 0;
        if (cross(p, at, q) == 0 && !ahead) return true;
    }
    return false;
}

Loop simple_polygon(Random& random, std::size_t corners, int size) {
    for (;;) {
        std::set<std::pair<std::int64_t, std::int64_t>> seen;
        Loop points;
        while (points.size() < corners) {
            const Point p{random.below(size), random.below(size)};
            if (seen.insert({p.x, p.y}).second) points.push_back(p);
        }
        std::optional<Loop> loop = untangled(std::move(points));
        if (!loop || turns_back(*loop)) continue;
        if (doubled_area(*loop) < 0) std::reverse(loop->begin(), loop->end());
        return *loop;
    }
}

/// Parts that lie side by side, in steps.
std::vector<Loop> random_region(Random& random, int parts) {
    std::vector<Loop> region;
    const bool cells = random.chance(50);
    const int size = cells ? static_cast<int>(2 + random.below(5)) : 16;
    for (int part = 0; part < parts; ++part) {
        const Point shift{part * (size + 1), random.below(size / 2)};
        std::vector<Loop> loops;
        if (cells) {
            loops = region_of_cells(random, size, static_cast<int>(2 + random.below(5)));
        } else {
            loops = {simple_polygon(random, static_cast<std::size_t>(4 + random.below(12)), size)};
        }
        for (Loop& loop : loops) {
            for (Point& p : loop) p = kStep * (p + shift);
            region.push_back(std::move(loop));
        }
    }
    // Outlines before holes.
    std::stable_partition(region.begin(), region.end(),
                          [](const Loop& l) { return doubled_area(l) > 0; });
    return region;
}

// -- bridges -------------------------------------------------------------------------------------

/// Whether `to` lies in the inside of a corner, the left of its two sides.
bool in_corner(const Loop& loop, std::size_t i, Point to) {
    const Point p = before(loop, i), at = loop[i], q = after(loop, i);
    const bool left_of_next = cross(at, q, to) > 0, left_of_prev = cross(p, at, to) > 0;
    return cross(p, at, q) >= 0 ? left_of_next && left_of_prev : left_of_next || left_of_prev;
}

/// Whether a bridge meets no side but where it begins and ends, at corners.
bool is_free(const Loop& bridge, const Loop& loop) {
    const Point begin = bridge.front(), end = bridge.back();
    for (std::size_t k = 0; k + 1 < bridge.size(); ++k) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Point p = bridge[k], q = bridge[k + 1], a = loop[i], b = after(loop, i);
            if (!meet(p, q, a, b)) continue;
            const auto leaves = [&](Point at) {
                return (a == at || b == at) && cross(p, q, a == at ? b : a) != 0;
            };
            const bool at_begin = k == 0 && leaves(begin);
            if (!at_begin && !(k + 2 == bridge.size() && leaves(end))) return false;
        }
    }
    return true;
}

bool crosses_itself(const Loop& bridge) {
    for (std::size_t k = 0; k + 2 < bridge.size(); ++k) {
        if (cross(bridge[k], bridge[k + 1], bridge[k + 2]) == 0) return true;
        for (std::size_t j = k + 2; j + 1 < bridge.size(); ++j) {
            if (meet(bridge[k], bridge[k + 1], bridge[j], bridge[j + 1])) return true;
        }
    }
    return false;
}

/// Whether a bridge from corner i crosses nothing, leads through the inside to a hole and through
/// the outside to a part.
bool is_clean(const Loop& bridge, const Loop& outline, std::size_t i, std::span<const Loop> rest) {
    if (crosses_itself(bridge) || !is_free(bridge, outline)) return false;
    for (const Loop& loop : rest) {
        if (!is_free(bridge, loop)) return false;
    }
    const Loop& loop = rest.front();
    if (std::ranges::count(loop, bridge.back()) > 1) return false;
    if (doubled_area(loop) < 0) return in_corner(outline, i, bridge[1]);
    return std::ranges::count(outline, outline[i]) == 1 && !in_corner(outline, i, bridge[1]);
}

/// Joins the first loop of `rest` to the outline; false when no way is found.
bool join(Random& random, Loop& outline, std::span<const Loop> rest, bool wild) {
    const Loop& loop = rest.front();
    for (int tries = 0; tries < 200; ++tries) {
        const std::size_t i = random.corner_of(outline), j = random.corner_of(loop);
        Loop bridge{outline[i]};
        for (auto bends = random.below(3); bends-- > 0;) {
            bridge.push_back(kStep * Point{random.below(40), random.below(20)});
        }
        bridge.push_back(loop[j]);
        const bool any_will_do = wild && doubled_area(rest.back()) > 0;
        if (!any_will_do && !is_clean(bridge, outline, i, rest)) continue;
        Loop detour(bridge.begin() + 1, bridge.end() - 1);
        for (std::size_t k = 0; k <= loop.size(); ++k) {
            detour.push_back(loop[(j + k) % loop.size()]);
        }
        detour.insert(detour.end(), bridge.rbegin() + 1, bridge.rend());
        insert(outline, i + 1, detour);
        return true;
    }
    return false;
}

// -- ornaments -----------------------------------------------------------------------------------

/// Inwards, outwards, across or along others; with bends, repeated corners and branches.
void add_spike(Random& random, Loop& outline) {
    const std::size_t i = random.corner_of(outline);
    const Point at = outline[i], beyond = at + at - before(outline, i);
    switch (random.below(4)) {
        case 0:  // a side is longer than it should be, and comes back
            insert(outline, i, {beyond});
            return;
        case 1:
            insert(outline, i + 1, {beyond, at});
            return;
        default:
            break;
    }
    Loop way;
    for (auto points = 1 + random.below(3); points-- > 0;) {
        const bool known = random.chance(25);
        way.push_back(known ? outline[random.corner_of(outline)]
                            : Point{random.below(40 * kStep), random.below(20 * kStep)});
    }
    way.insert(way.end(), way.rbegin() + 1, way.rend());
    way.push_back(at);
    insert(outline, i + 1, way);
}

void split_side(Random& random, Loop& outline) {
    const std::size_t i = random.corner_of(outline);
    const Point a = outline[i], d = after(outline, i) - a;
    const std::int64_t parts = std::gcd(d.x, d.y);
    if (parts > 1) insert(outline, i + 1, {a + (1 + random.below(parts - 1)) * (d / parts)});
}

void repeat_corner(Random& random, Loop& outline) {
    const std::size_t i = random.corner_of(outline);
    insert(outline, i, {outline[i]});
}

}  // namespace

std::int64_t doubled_area(const Loop& loop) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) sum += cross({0, 0}, loop[i], after(loop, i));
    return sum;
}

bool on_a_side(const std::vector<Loop>& loops, Point at) {
    return std::ranges::any_of(loops, [&](const Loop& loop) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (on_segment(loop[i], after(loop, i), at)) return true;
        }
        return false;
    });
}

int winding(const std::vector<Loop>& loops, Point at) {
    int turns = 0;
    for (const Loop& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Point a = loop[i], b = after(loop, i);
            if ((a.y > at.y) == (b.y > at.y)) continue;
            const bool left = cross(a, b, at) > 0;
            if (left == (b.y > a.y)) turns += b.y > a.y ? 1 : -1;
        }
    }
    return turns;
}

DecoratedPolygon random_polygon(std::uint64_t seed, const Ornament& ornament) {
    Random random(seed);
    for (;;) {
        DecoratedPolygon polygon;
        polygon.region = random_region(random, static_cast<int>(1 + random.below(ornament.parts)));
        Loop& outline = polygon.outline;
        outline = polygon.region[0];
        std::span<const Loop> rest(polygon.region);
        bool joined = true;
        while (joined && rest.size() > 1) {
            rest = rest.subspan(1);
            joined = join(random, outline, rest, ornament.wild_bridges);
        }
        if (!joined) continue;
        for (auto n = random.below(ornament.spikes + 1); n-- > 0;) add_spike(random, outline);
        for (auto n = random.below(4); n-- > 0;) split_side(random, outline);
        for (auto n = random.below(3); n-- > 0;) repeat_corner(random, outline);
        std::rotate(outline.begin(), outline.begin() + random.below(4) % 4, outline.end());
        if (outline.size() < 4) continue;
        // Out of the grid's directions.
        const Point x{1 + random.below(7), random.below(11) - 5};
        const Point y{random.below(11) - 5, 1 + random.below(7)};
        if (cross({0, 0}, x, y) <= 0) return polygon;
        const auto turn = [&](Loop& loop) {
            for (Point& p : loop) p = p.x * x + p.y * y;
        };
        turn(outline);
        std::ranges::for_each(polygon.region, turn);
        return polygon;
    }
}

}  // namespace sightline::testing
