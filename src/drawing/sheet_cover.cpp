// In the world, so that it is the same in every view. Seen along the edge, in the plane of the
// sheet, a corner of another face lies to the left of the edge (where its own face is), on it or to
// the right. A face covers the right side where the edge runs along a side of it: between its
// corners at distance 0, if the third one lies to the right.
#include "drawing/sheet_cover.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <tuple>

#include "math/page_grid.hpp"
#include "scene/tolerance.hpp"

namespace sightline {
namespace {

constexpr std::size_t kFew = 32;     // faces that are looked at without a grid
constexpr std::size_t kGrain = 256;  // edges that a task takes at a time

/// A point of an edge: how far from its first end, and the vertex there, if any.
struct Mark {
    double at = 0;
    std::uint32_t vertex = kNone;
};
struct Stretch {
    Mark from, to;
};

/// The faces of one sheet and one object, and a search among them.
class SheetFaces {
public:
    SheetFaces(const Scene& scene, std::span<const std::uint32_t> faces)
        : scene_(scene), faces_(faces) {
        const Sheets& sheets = scene.sheets;
        const std::uint32_t sheet = sheets.of(faces[0]);
        const Corners f = sheets.frame[sheet];
        const glm::dvec3 &p = scene.positions[f.x], &q = scene.positions[f.y];
        normal_ = glm::normalize(glm::cross(q - p, scene.positions[f.z] - p));
        if (faces.size() > kFew) make_grid(sheets.ball[sheet], glm::normalize(q - p));
    }

    [[nodiscard]] const glm::dvec3& normal() const { return normal_; }

    /// visit(triangle) for the faces near a line.
    template <class Visit>
    void near(const glm::dvec3& from, const glm::dvec3& to, VisitMarks& marks,
              const Visit& visit) const {
        if (!grid_) {
            for (const std::uint32_t face : faces_) visit(face);
            return;
        }
        struct Visitor {
            const SheetFaces& faces;
            const Visit& visit_face;
            [[nodiscard]] static bool enter(double, double) { return true; }
            [[nodiscard]] bool visit(std::uint32_t k) const {
                visit_face(faces.faces_[k]);
                return true;
            }
            [[nodiscard]] static bool done() { return false; }
        } visitor{*this, visit};
        const ScreenPoint p = place(from), q = place(to);
        // Both ends may have been rounded, and the tolerance is less than a step.
        grid_->walk(p, q, 1, marks, visitor);
    }

private:
    // Steps of the grid across the sheet: the tolerance, 2^-20 of the scene's radius, is a small
    // part of one but for sheets that are a thousandth of the scene.
    static constexpr double kSteps = 0x1p20;

    void make_grid(const glm::dvec4& ball, const glm::dvec3& along) {
        centre_ = glm::dvec3(ball.x, ball.y, ball.z);
        scale_ = kSteps / ball.w;
        x_axis_ = along;
        y_axis_ = glm::cross(normal_, along);
        std::vector<PageTriangle> triangles;
        triangles.reserve(faces_.size());
        for (const std::uint32_t face : faces_) {
            const Corners c = scene_.triangles[face];
            PageTriangle t{place(scene_.positions[c.x]),
                           place(scene_.positions[c.y]),
                           place(scene_.positions[c.z]),
                           {}};
            std::tie(t.box.x0, t.box.x1) = std::minmax({t.p.x, t.q.x, t.r.x});
            std::tie(t.box.y0, t.box.y1) = std::minmax({t.p.y, t.q.y, t.r.y});
            triangles.push_back(t);
        }
        grid_.emplace(triangles);
    }
    [[nodiscard]] ScreenPoint place(const glm::dvec3& p) const {
        const auto step = [&](const glm::dvec3& axis) {
            const double at = scale_ * glm::dot(axis, p - centre_);
            return static_cast<std::int32_t>(std::lround(std::clamp(at, -0x1p23, 0x1p23)));
        };
        return {step(x_axis_), step(y_axis_), 0};
    }

    const Scene& scene_;
    std::span<const std::uint32_t> faces_;
    glm::dvec3 normal_{}, centre_{}, x_axis_{}, y_axis_{};
    double scale_ = 0;
    std::optional<PageGrid> grid_;
};

/// Finds the covered stretches of one edge.
class Coverage {
public:
    Coverage(const Scene& scene, const SheetFaces& faces, const SceneEdge& edge, std::uint32_t face,
             double tolerance)
        : scene_(scene),
          tolerance_(tolerance),
          from_(scene.positions[edge.a]),
          to_(scene.positions[edge.b]),
          length_(glm::distance(from_, to_)),
          along_((to_ - from_) / length_),
          right_(glm::cross(along_, faces.normal())) {
        const Corners c = scene.triangles[face];
        double side = 0;
        for (int k = 0; k < 3; ++k) {
            const double own = glm::dot(right_, scene.positions[c[k]] - from_);
            if (std::abs(own) > std::abs(side)) side = own;
        }
        if (side > 0) right_ = -right_;
    }

    [[nodiscard]] const std::vector<Stretch>& find(const SheetFaces& faces, VisitMarks& marks) {
        faces.near(from_, to_, marks, [&](std::uint32_t face) { add_chord(face); });
        std::ranges::sort(covered_, [](const Stretch& s, const Stretch& t) {
            return std::tie(s.from.at, s.to.at, s.from.vertex, s.to.vertex) <
                   std::tie(t.from.at, t.to.at, t.from.vertex, t.to.vertex);
        });
        unite();
        return covered_;
    }
    [[nodiscard]] double length() const { return length_; }
    [[nodiscard]] glm::dvec3 point(double at) const { return from_ + at * along_; }

private:
    void add_chord(std::uint32_t face) {
        const Corners c = scene_.triangles[face];
        std::array<double, 3> at{}, side{};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 way = scene_.positions[c[static_cast<int>(k)]] - from_;
            at[k] = glm::dot(along_, way);
            side[k] = glm::dot(right_, way);
            if (std::abs(side[k]) <= tolerance_) side[k] = 0;
        }
        // A face on both sides lies over the edge's own face: the edge is a decal's, or a wall's
        // behind one, and stays.
        if (!(std::max({side[0], side[1], side[2]}) > 0)) return;
        if (std::min({side[0], side[1], side[2]}) < 0) return;
        Stretch chord{{std::numeric_limits<double>::infinity()},
                      {-std::numeric_limits<double>::infinity()}};
        const auto include = [&](const Mark& mark) {
            if (mark.at < chord.from.at) chord.from = mark;
            if (mark.at > chord.to.at) chord.to = mark;
        };
        for (std::size_t k = 0; k < 3; ++k) {
            if (side[k] == 0) include({at[k], c[static_cast<int>(k)]});
        }
        if (chord.from.at <= tolerance_) chord.from = {0};
        if (chord.to.at >= length_ - tolerance_) chord.to = {length_};
        if (chord.to.at - chord.from.at > tolerance_) covered_.push_back(chord);
    }

    void unite() {
        std::size_t kept = 0;
        for (const Stretch& next : covered_) {
            if (kept > 0 && next.from.at <= covered_[kept - 1].to.at + tolerance_) {
                if (next.to.at > covered_[kept - 1].to.at) covered_[kept - 1].to = next.to;
            } else {
                covered_[kept++] = next;
            }
        }
        covered_.resize(kept);
    }

    const Scene& scene_;
    double tolerance_;
    glm::dvec3 from_, to_;
    double length_;
    glm::dvec3 along_, right_;
    std::vector<Stretch> covered_;
};

class CoverFinder {
public:
    CoverFinder(const Scene& scene, std::span<const std::uint32_t> open, SceneEdges& edges)
        : scene_(scene),
          wanted_(open),
          edges_(edges),
          tolerance_(rounding_of(scene.bounds, scene.rounding)),
          covered_(open.size()) {
        for (std::uint32_t i = 0; i < open.size(); ++i) {
            const std::uint32_t face = edges.faces[edges.edges[open[i]].first_face];
            open_.push_back({scene.sheets.of(face), scene.object_of(face), i, 0});
        }
        std::ranges::sort(open_, [](const Open& a, const Open& b) {
            return std::tie(a.sheet, a.object, a.item) < std::tie(b.sheet, b.object, b.item);
        });
    }

    void run() {
        make_groups();
        tbb::enumerable_thread_specific<VisitMarks> marks;
        tbb::parallel_for(std::size_t{0}, (open_.size() + kGrain - 1) / kGrain,
                          [&](std::size_t task) {
                              const std::size_t end = std::min(open_.size(), (task + 1) * kGrain);
                              for (std::size_t i = task * kGrain; i < end; ++i)
                                  covered_[open_[i].item] = covered_of(open_[i], marks.local());
                          });
        if (std::ranges::any_of(covered_, [](const auto& own) { return !own.empty(); })) cut();
    }

private:
    struct Open {
        std::uint32_t sheet, object, item, group;
    };

    void make_groups() {
        std::vector<std::span<const std::uint32_t>> faces;
        for (std::size_t i = 0; i < open_.size(); ++i) {
            Open& own = open_[i];
            if (i == 0 || own.sheet != open_[i - 1].sheet || own.object != open_[i - 1].object)
                faces.push_back(faces_of(own.sheet, scene_.objects[own.object]));
            own.group = static_cast<std::uint32_t>(faces.size() - 1);
        }
        groups_.resize(faces.size());
        tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t g) {
            if (faces[g].size() > 1) groups_[g].emplace(scene_, faces[g]);
        });
    }
    [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t sheet,
                                                          const Object& object) const {
        const Sheets& sheets = scene_.sheets;
        const auto all =
            std::span(sheets.members)
                .subspan(sheets.first[sheet], sheets.first[sheet + 1] - sheets.first[sheet]);
        const auto begin = std::ranges::lower_bound(all, object.first_triangle);
        const auto end =
            std::ranges::lower_bound(all, object.first_triangle + object.triangle_count);
        return {begin, end};
    }
    [[nodiscard]] std::vector<Stretch> covered_of(const Open& open, VisitMarks& marks) const {
        if (!groups_[open.group]) return {};
        const SceneEdge& edge = edges_.edges[wanted_[open.item]];
        const std::uint32_t face = edges_.faces[edge.first_face];
        const SheetFaces& faces = *groups_[open.group];
        return Coverage(scene_, faces, edge, face, tolerance_).find(faces, marks);
    }

    void cut() {
        std::vector<SceneEdge> all;
        all.reserve(edges_.edges.size());
        std::size_t item = 0;
        for (std::size_t e = 0; e < edges_.edges.size(); ++e) {
            const bool is_open = item < wanted_.size() && wanted_[item] == e;
            const std::size_t own = is_open ? item++ : item;
            if (is_open && !covered_[own].empty())
                append_stretches(edges_.edges[e], covered_[own], all);
            else
                all.push_back(edges_.edges[e]);
        }
        edges_.edges = std::move(all);
    }
    void append_stretches(const SceneEdge& edge, const std::vector<Stretch>& covered,
                          std::vector<SceneEdge>& all) {
        Mark at{0, edge.a};
        const auto add = [&](const Mark& to, EdgeKind kind) {
            if (to.at - at.at <= tolerance_) return;
            SceneEdge part = edge;
            part.a = vertex(edge, at);
            part.b = vertex(edge, to);
            part.kind = kind;
            all.push_back(part);
            at = to;
        };
        for (const Stretch& stretch : covered) {
            add(stretch.from, edge.kind);
            add(stretch.to, EdgeKind::mesh);
        }
        add({length_of(edge), edge.b}, edge.kind);
    }
    [[nodiscard]] double length_of(const SceneEdge& edge) const {
        return glm::distance(scene_.positions[edge.a], scene_.positions[edge.b]);
    }
    /// The number of the vertex at a mark; a new one if there is none.
    [[nodiscard]] std::uint32_t vertex(const SceneEdge& edge, const Mark& mark) {
        if (mark.vertex != kNone) return mark.vertex;
        if (mark.at == 0) return edge.a;
        const double length = length_of(edge);
        if (mark.at == length) return edge.b;
        const glm::dvec3 &from = scene_.positions[edge.a], &to = scene_.positions[edge.b];
        edges_.cuts.push_back(from + mark.at / length * (to - from));
        return static_cast<std::uint32_t>(scene_.positions.size() + edges_.cuts.size() - 1);
    }

    const Scene& scene_;
    std::span<const std::uint32_t> wanted_;  // ascending
    SceneEdges& edges_;
    double tolerance_;
    std::vector<std::vector<Stretch>> covered_;  // of wanted_
    std::vector<Open> open_;                     // sorted by sheet and object
    std::vector<std::optional<SheetFaces>> groups_;
};

}  // namespace

void cut_covered_edges(const Scene& scene, std::span<const std::uint32_t> open, SceneEdges& edges) {
    if (!open.empty()) CoverFinder(scene, open, edges).run();
}

}  // namespace sightline
