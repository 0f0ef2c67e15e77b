// What docs/exactness.md says of curves of intersection, pair by pair and in rational numbers.
// Nothing but points and planes of the page is taken from the program.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "sightline/screen_scene.hpp"

namespace sightline::testing::crossing_definition {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

inline constexpr double kJoined = 4;     // steps: ends of neighbours so near become one point
inline constexpr int kEdgeOnSteps = 32;  // the width of a sheet that is seen edge-on

inline double rounded(const Rational& r) { return r.convert_to<double>(); }

struct Point {
    Rational x, y;
};
inline Point point_of(const ScreenPoint& s) { return {s.x, s.y}; }

/// (q - p) x (s - p).
inline Rational cross(const Point& p, const Point& q, const Point& s) {
    return (q.x - p.x) * (s.y - p.y) - (q.y - p.y) * (s.x - p.x);
}
inline Point between(const Point& p, const Point& q, const Rational& t) {
    return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
}

struct Face {
    std::array<ScreenPoint, 3> corner;
    std::array<std::uint32_t, 3> index{};
    std::uint32_t id = 0, sheet = kNone;
    Plane plane;
    std::uint32_t piece = 0;  ///< number on the page: a cut triangle has several

    /// c times the depth of the plane at a point of the grid.
    [[nodiscard]] Integer depth(const ScreenPoint& s) const {
        return Integer(plane.c) * plane.at.z + Integer(plane.a) * (Integer(s.x) - plane.at.x) +
               Integer(plane.b) * (Integer(s.y) - plane.at.y);
    }
    [[nodiscard]] Rational depth(const Point& s) const {
        return plane.at.z + (plane.a * (s.x - plane.at.x) + plane.b * (s.y - plane.at.y)) / plane.c;
    }
    /// The sign of the difference of depths at its own corners; see docs/exactness.md.
    [[nodiscard]] std::array<int, 3> signs_against(const Face& g) const {
        std::array<int, 3> signs{};
        const Integer zone =
            2 * (Integer(g.plane.c) + abs(Integer(g.plane.a)) + abs(Integer(g.plane.b)));
        for (std::size_t k = 0; k < 3; ++k) {
            const ScreenPoint& s = corner[k];
            const Integer behind = Integer(g.plane.c) * s.z - g.depth(s);
            if (abs(behind) <= zone) continue;
            const Integer h = depth(s) * g.plane.c - g.depth(s) * plane.c;
            if (h.sign() == behind.sign()) signs[k] = h.sign();
        }
        return signs;
    }
};

inline bool both(const std::array<int, 3>& s) {
    return std::ranges::find(s, 1) != s.end() && std::ranges::find(s, -1) != s.end();
}
inline bool is_edge(const std::array<int, 3>& s) { return std::ranges::count(s, 0) == 2; }

/// Faces with an area, each with the plane that it has where it crosses others.
inline std::vector<Face> faces_of(const ScreenScene& page) {
    std::vector<Face> faces;
    for (std::uint32_t k = 0; k < page.triangle_count(); ++k) {
        if (!page.drawable(k)) continue;
        const Corners c = page.corners(k);
        Face face{{page.point(c.x), page.point(c.y), page.point(c.z)},
                  {c.x, c.y, c.z},
                  page.id(k),
                  page.shared_plane(page.id(k)),
                  page.plane(page.id(k)),
                  k};
        const auto& [p, q, r] = face.corner;
        if (cross(point_of(p), point_of(q), point_of(r)) != 0 && face.plane.c > 0)
            faces.push_back(face);
    }
    std::map<std::uint32_t, std::pair<Integer, Integer>> extents;
    const auto along = [](const Face& f, const ScreenPoint& s) {
        return Integer(Integer(f.plane.a) * s.x + Integer(f.plane.b) * s.y);
    };
    for (const Face& face : faces) {
        if (face.sheet == kNone) continue;
        for (const ScreenPoint& s : face.corner) {
            const Integer at = along(face, s);
            auto& e = extents.try_emplace(face.sheet, at, at).first->second;
            e.first = std::min(e.first, at);
            e.second = std::max(e.second, at);
        }
    }
    for (Face& face : faces) {
        if (face.sheet == kNone) continue;
        const auto& [low, high] = extents.at(face.sheet);
        const Integer width = high - low, a = face.plane.a, b = face.plane.b;
        if (width * width >= kEdgeOnSteps * kEdgeOnSteps * (a * a + b * b)) continue;
        const auto& [p, q, r] = face.corner;  // z = a x + b y + ... by Cramer's rule
        const Integer ux = q.x - p.x, uy = q.y - p.y, vx = r.x - p.x, vy = r.y - p.y;
        const Integer uz = Integer(q.z) - p.z, vz = Integer(r.z) - p.z, area = ux * vy - uy * vx;
        const int way = area.sign();
        face.plane = {static_cast<std::int64_t>(way * (uz * vy - uy * vz)),
                      static_cast<std::int64_t>(way * (ux * vz - uz * vx)),
                      static_cast<std::int64_t>(way * area), p};
    }
    return faces;
}

/// A stretch of the page.
struct Stretch2 {
    Point p, q;
    [[nodiscard]] double length() const {
        return std::hypot(rounded(q.x - p.x), rounded(q.y - p.y));
    }
};

/// The part of a stretch inside of a face.
inline std::optional<Stretch2> clipped(const Stretch2& s, const Face& face) {
    Rational from = 0, to = 1;
    std::array<Point, 3> c = {point_of(face.corner[0]), point_of(face.corner[1]),
                              point_of(face.corner[2])};
    if (cross(c[0], c[1], c[2]) < 0) std::swap(c[1], c[2]);
    for (std::size_t k = 0; k < 3; ++k) {
        const Point &a = c[k], &b = c[(k + 1) % 3];
        const Rational at_p = cross(a, b, s.p), at_q = cross(a, b, s.q);
        if (at_p < 0 && at_q < 0) return std::nullopt;
        if ((at_p < 0) == (at_q < 0)) continue;
        const Rational t = at_p / (at_p - at_q);
        if (at_p < 0)
            from = std::max(from, t);
        else
            to = std::min(to, t);
    }
    if (from >= to) return std::nullopt;
    return Stretch2{between(s.p, s.q, from), between(s.p, s.q, to)};
}

/// Where both planes have one depth, inside of both faces.
inline std::optional<Stretch2> crossing_of(const Face& f, const Face& g) {
    std::vector<Point> ends;
    std::array<Rational, 3> h;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point s = point_of(f.corner[k]);
        h[k] = f.depth(s) - g.depth(s);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        if (h[k] == 0) ends.push_back(point_of(f.corner[k]));
        if (h[k] * h[next] < 0)
            ends.push_back(
                between(point_of(f.corner[k]), point_of(f.corner[next]), h[k] / (h[k] - h[next])));
    }
    if (ends.size() != 2) return std::nullopt;
    return clipped({ends[0], ends[1]}, g);
}

using Key = std::array<std::int32_t, 6>;
/// An edge by its ends, whatever face has it.
struct Edge {
    ScreenPoint p{}, q{};
    [[nodiscard]] Key key() const { return {p.x, p.y, p.z, q.x, q.y, q.z}; }
};

/// The edge whose ends touch, and the sign at the corner beside it.
inline std::pair<Edge, int> zero_edge(const Face& f, const std::array<int, 3>& signs) {
    std::size_t off = 0;
    while (signs[off] == 0) ++off;
    Edge e{f.corner[(off + 1) % 3], f.corner[(off + 2) % 3]};
    const Edge back{e.q, e.p};
    if (back.key() < e.key()) e = back;
    return {e, signs[off]};
}

/// The common part of two edges on one line.
inline std::optional<Stretch2> common(const Edge& e, const Edge& f) {
    const auto squared = [](const Edge& a) {
        const Integer x = Integer(a.q.x) - a.p.x, y = Integer(a.q.y) - a.p.y;
        return Integer(x * x + y * y);
    };
    const bool longer = squared(e) >= squared(f);
    const Edge &line = longer ? e : f, &other = longer ? f : e;
    for (const ScreenPoint& s : {other.p, other.q}) {
        const Rational beside = cross(point_of(line.p), point_of(line.q), point_of(s));
        if (beside * beside > 16 * squared(line)) return std::nullopt;
    }
    if (squared(e) == 0) return std::nullopt;
    const Point p = point_of(e.p), q = point_of(e.q);
    const auto along = [&](const ScreenPoint& s) {
        const Rational t = ((q.x - p.x) * (s.x - p.x) + (q.y - p.y) * (s.y - p.y)) / squared(e);
        return std::clamp<Rational>(t, 0, 1);
    };
    const Rational a = along(f.p), b = along(f.q);
    if (a == b) return std::nullopt;
    return Stretch2{between(p, q, std::min(a, b)), between(p, q, std::max(a, b))};
}

struct Expected {
    std::array<std::uint32_t, 2> faces{};
    Stretch2 stretch;
    std::optional<std::array<Rational, 2>> depths;
    bool drawn = false;
};

/// Collects what the definition says of all pairs.
class Definition {
public:
    explicit Definition(const ScreenScene& page) : faces_(faces_of(page)) {
        for (std::size_t i = 0; i < faces_.size(); ++i)
            for (std::size_t j = 0; j < faces_.size(); ++j)
                if (faces_[i].id < faces_[j].id) add(faces_[i], faces_[j]);
        for (const auto& [key, half] : halves_)
            if (half.sides == 3) expected_.push_back({half.faces, half.stretch, {}});
        for (const auto& [key, m] : meetings_)
            if (m.interleaved()) expected_.push_back({m.faces, m.stretch, {}});
    }
    [[nodiscard]] std::vector<Expected>& expected() { return expected_; }

private:
    struct Half {
        std::array<std::uint32_t, 2> faces{};
        Stretch2 stretch;
        int sides = 0;
    };
    /// Around a line, faces that have edges on it lie like rays: those on the right from near to
    /// deep, then those on the left from deep to near.
    struct Meeting {
        std::array<std::uint32_t, 2> faces{};
        Stretch2 stretch;
        Edge line;
        std::map<std::uint32_t, const Face*> rays[2];  ///< at either edge, by number

        [[nodiscard]] bool is_right(const Face& f) const {
            Rational most = 0;  // corners on the line count for nothing
            for (const ScreenPoint& s : f.corner) {
                const Rational at = cross(point_of(line.p), point_of(line.q), point_of(s));
                if (abs(at) > abs(most)) most = at;
            }
            return most > 0;
        }
        [[nodiscard]] bool comes_before(const Face& f, const Face& g) const {
            const bool right = is_right(f);
            if (right != is_right(g)) return right;
            int sign = 0;
            for (const int s : f.signs_against(g)) sign += s;
            return right ? sign < 0 : sign > 0;
        }
        /// Whether rays of one edge lie between rays of the other one on both ways around.
        [[nodiscard]] bool interleaved() const {
            if (rays[0].size() < 2 || rays[1].size() < 2) return false;
            for (const auto& [a, face] : rays[0]) {
                for (const auto& [b, other] : rays[0]) {
                    int between[2] = {0, 0};
                    if (a == b || !comes_before(*face, *other)) continue;
                    for (const auto& [c, ray] : rays[1])
                        ++between[comes_before(*face, *ray) && comes_before(*ray, *other)];
                    if (between[0] > 0 && between[1] > 0) return true;
                }
            }
            return false;
        }
    };

    /// Whether two faces have no point of the page in common, for their boxes.
    static bool apart(const Face& f, const Face& g) {
        const auto beyond = [](const Face& a, const Face& b, std::int32_t ScreenPoint::*x) {
            const auto less = [&](const ScreenPoint& s, const ScreenPoint& t) {
                return s.*x < t.*x;
            };
            return (*std::ranges::max_element(a.corner, less)).*x <
                   (*std::ranges::min_element(b.corner, less)).*x;
        };
        return beyond(f, g, &ScreenPoint::x) || beyond(g, f, &ScreenPoint::x) ||
               beyond(f, g, &ScreenPoint::y) || beyond(g, f, &ScreenPoint::y);
    }
    static int side_bit(int sign) { return sign < 0 ? 1 : 2; }

    void add(const Face& f, const Face& g) {
        if (apart(f, g) || (f.sheet != kNone && f.sheet == g.sheet)) return;
        int shared = 0;
        for (const std::uint32_t i : f.index)
            shared += static_cast<int>(std::ranges::count(g.index, i));
        if (shared > 1) return;
        const auto of_f = f.signs_against(g), of_g = g.signs_against(f);
        if (both(of_f) && both(of_g)) {
            if (const auto s = crossing_of(f, g))
                expected_.push_back({{f.id, g.id}, *s, {{f.depth(s->p), f.depth(s->q)}}});
        }
        if (is_edge(of_f) && both(of_g)) add_half(f, of_f, g);
        if (is_edge(of_g) && both(of_f)) add_half(g, of_g, f);
        if (is_edge(of_f) && is_edge(of_g)) add_meeting(f, of_f, g, of_g);
    }
    void add_half(const Face& f, const std::array<int, 3>& signs, const Face& g) {
        const auto [edge, sign] = zero_edge(f, signs);
        const auto s = clipped({point_of(edge.p), point_of(edge.q)}, g);
        if (!s) return;
        const std::array<std::uint32_t, 2> pair = {std::min(f.id, g.id), std::max(f.id, g.id)};
        Half& half = halves_.try_emplace({edge.key(), g.piece}, Half{pair, *s}).first->second;
        half.faces = std::min(half.faces, pair);
        half.sides |= side_bit(sign);
    }
    void add_meeting(const Face& f, const std::array<int, 3>& of_f, const Face& g,
                     const std::array<int, 3>& of_g) {
        auto a = zero_edge(f, of_f), b = zero_edge(g, of_g);
        const bool swapped = b.first.key() < a.first.key();
        if (swapped) std::swap(a, b);
        const auto s = common(a.first, b.first);
        if (!s) return;
        const std::array<std::uint32_t, 2> pair = {f.id, g.id};
        Meeting& m =
            meetings_.try_emplace({a.first.key(), b.first.key()}, Meeting{pair, *s, a.first, {}})
                .first->second;
        m.faces = std::min(m.faces, pair);
        m.rays[0].emplace((swapped ? g : f).piece, swapped ? &g : &f);
        m.rays[1].emplace((swapped ? f : g).piece, swapped ? &f : &g);
    }

    std::vector<Face> faces_;
    std::vector<Expected> expected_;
    std::map<std::pair<Key, std::uint32_t>, Half> halves_;
    std::map<std::pair<Key, Key>, Meeting> meetings_;
};

}  // namespace sightline::testing::crossing_definition
