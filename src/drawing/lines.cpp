#include "drawing/lines.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "drawing/edges.hpp"
#include "drawing/intersections.hpp"
#include "math/arena.hpp"
#include "view/clip.hpp"
#include "view/vertex_stage.hpp"

namespace sightline {
namespace {

constexpr std::size_t kGrain = 256;  // edges that a task takes at a time

/// The ends of a line on the page; nothing when it lies outside.
using ScreenLine = std::optional<std::pair<ScreenPoint, ScreenPoint>>;

/// The lines of the scene's edges.
class EdgeProjector {
public:
    EdgeProjector(const ScreenScene& page, const std::vector<glm::dvec3>& cuts)
        : page_(page), transform_(page_transform(page)), cuts_(cuts) {}

    [[nodiscard]] ScreenLine ends(std::uint32_t a, std::uint32_t b) const {
        const std::size_t n = page_.scene().positions.size();
        if (a < n && b < n) {
            const ScreenPoint &p = page_.point(a), &q = page_.point(b);
            if (p.x != kOutside && q.x != kOutside) return std::pair(p, q);
        }
        return clip_line(transform_, position(a), position(b));
    }

private:
    [[nodiscard]] const glm::dvec3& position(std::uint32_t i) const {
        const auto& positions = page_.scene().positions;
        return i < positions.size() ? positions[i] : cuts_[i - positions.size()];
    }

    const ScreenScene& page_;
    ScreenTransform transform_;
    const std::vector<glm::dvec3>& cuts_;
};

/// Sheets of the faces of an edge, for HiddenLineFinder.
void find_sheets(const ScreenScene& page, std::span<const std::uint32_t> faces,
                 std::vector<std::uint32_t>& sheets) {
    sheets.clear();
    for (const std::uint32_t face : faces)
        if (const std::uint32_t sheet = page.shared_plane(face); sheet != kNone)
            sheets.push_back(sheet);
}

/// What a task finds: hidden parts of its edges, and how many each edge has.
struct TaskParts {
    std::vector<std::uint32_t> counts;
    std::vector<EdgeInterval> hidden;
    std::uint64_t tests = 0;
};

TaskParts find_parts_of(const ScreenScene& page, const PageEdges& edges, std::size_t begin,
                        std::size_t end, HiddenLineFinder& finder) {
    TaskParts parts;
    const std::uint64_t tests_before = finder.tests();
    std::vector<std::uint32_t> sheets;
    for (std::size_t i = begin; i < end; ++i) {
        const PageEdge& edge = edges.edges[i];
        if (edge.culled) {
            parts.hidden.push_back({EdgeParam::start(), EdgeParam::end()});
            parts.counts.push_back(1);
            continue;
        }
        const auto faces = edges.faces_of(edge);
        find_sheets(page, faces, sheets);
        const auto hidden = finder.find({edge.p, edge.q, faces, sheets});
        parts.counts.push_back(static_cast<std::uint32_t>(hidden.size()));
        parts.hidden.insert(parts.hidden.end(), hidden.begin(), hidden.end());
    }
    parts.tests = finder.tests() - tests_before;
    return parts;
}

/// The polygons of an edge, for DrawnLines.
glm::uvec2 polygons_of(const Scene& scene, std::span<const std::uint32_t> faces) {
    if (faces.empty()) return glm::uvec2(kNone);
    glm::uvec2 polygons(scene.triangle_polygon[faces[0]], kNone);
    for (const std::uint32_t face : faces.subspan(1)) {
        const std::uint32_t polygon = scene.triangle_polygon[face];
        if (polygon == polygons.x) continue;
        polygons.y = polygon;
        break;
    }
    if (polygons.y < polygons.x) std::swap(polygons.x, polygons.y);
    return polygons;
}

/// Rounds the parts of one edge after another to the grid.
class PartWriter {
public:
    PartWriter(const ScreenScene& page, const PageEdges& edges, Drawing& drawing)
        : page_(page),
          edges_(edges),
          drawing_(drawing),
          step_(std::ldexp(1.0, -page.subpixel_bits())) {}

    void begin(const PageEdge& edge) {
        edge_ = &edge;
        parts_.clear();
        at_ = edge.p;
    }
    void add_hidden(const EdgeInterval& part) {
        add(point(part.from), true);
        add(point(part.to), false);
    }
    void end(bool keep_hidden) {
        add(edge_->q, true);
        const auto faces = edges_.faces_of(*edge_);
        polygons_ = polygons_of(page_.scene(), faces);
        object_ = faces.empty() ? edge_->object : page_.scene().object_of(faces[0]);
        for (const Part& part : parts_) append(part, keep_hidden);
    }

private:
    struct Part {
        ScreenPoint from, to;
        bool visible;
    };
    /// Parts shorter than this come from rounding (where three surfaces meet, say) and go to the
    /// part before: a speck of a few steps is nothing to draw.
    static constexpr std::int32_t kSpeck = 4;

    [[nodiscard]] ScreenPoint point(const EdgeParam& t) const {
        return t.num == 0 ? edge_->p : t.num == t.den ? edge_->q : point_at(edge_->p, edge_->q, t);
    }
    /// The next part reaches to this point.
    void add(const ScreenPoint& to, bool visible) {
        const ScreenPoint from = at_;
        if (from.x == to.x && from.y == to.y) return;
        at_ = to;
        const Part part{from, to, visible};
        if (!parts_.empty() && (is_speck(part) || parts_.back().visible == visible))
            parts_.back().to = to;
        else if (parts_.size() == 1 && is_speck(parts_[0]))
            parts_[0] = {parts_[0].from, to, visible};
        else
            parts_.push_back(part);
    }
    [[nodiscard]] static bool is_speck(const Part& part) {
        return std::abs(part.to.x - part.from.x) < kSpeck &&
               std::abs(part.to.y - part.from.y) < kSpeck;
    }
    void append(const Part& part, bool keep_hidden) {
        const glm::dvec2 from(step_ * part.from.x, step_ * part.from.y);
        const glm::dvec2 to(step_ * part.to.x, step_ * part.to.y);
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        DrawingCounts& counts = drawing_.counts;
        ++(part.visible ? counts.visible_segments : counts.hidden_segments);
        (part.visible ? counts.visible_length : counts.hidden_length) += length;
        if (!part.visible && !keep_hidden) return;
        DrawnLines& lines = drawing_.lines;
        lines.from.push_back(from);
        lines.to.push_back(to);
        lines.kind.push_back(edge_->kind);
        lines.visible.push_back(part.visible ? 1 : 0);
        lines.polygons.push_back(polygons_);
        lines.object.push_back(object_);
    }

    const ScreenScene& page_;
    const PageEdges& edges_;
    Drawing& drawing_;
    double step_;
    const PageEdge* edge_ = nullptr;
    ScreenPoint at_{};  // where the next part begins
    std::vector<Part> parts_;
    glm::uvec2 polygons_{};
    std::uint32_t object_ = 0;
};

}  // namespace

PageEdges collect_edges(const ScreenScene& page, const TraceOptions& options) {
    PageEdges all;
    const auto add = [&](const ScreenLine& ends, EdgeKind kind) {
        if (!ends || (ends->first.x == ends->second.x && ends->first.y == ends->second.y))
            return false;
        all.edges.push_back({.p = ends->first, .q = ends->second, .kind = kind});
        return true;
    };
    if (!options.edges.empty()) {
        SceneEdges found = find_edges(page, options.edges, options.crease_angle, options.threads);
        const EdgeProjector projector(page, found.cuts);
        all.edges.reserve(found.edges.size() + options.free_lines.size());
        for (const SceneEdge& edge : found.edges) {
            if (!add(projector.ends(edge.a, edge.b), edge.kind)) continue;
            all.edges.back().culled = edge.culled;
            all.edges.back().first_face = edge.first_face;
            all.edges.back().face_count = edge.face_count;
        }
        all.faces = std::move(found.faces);
    }
    const ScreenTransform transform = page_transform(page);
    for (const FreeLine& line : options.free_lines)
        if (add(clip_line(transform, line.from, line.to), line.kind))
            all.edges.back().object = line.object;
    return all;
}

void append_crossings(const Occluders& occluders, int threads, WorkMeter& meter, PageEdges& all) {
    for (const Crossing& crossing : find_crossings(occluders, threads, meter)) {
        all.edges.push_back({crossing.p, crossing.q, EdgeKind::intersection, false,
                             static_cast<std::uint32_t>(all.faces.size()), 2});
        all.faces.insert(all.faces.end(), crossing.faces.begin(), crossing.faces.end());
        ++all.crossings;
    }
}

HiddenParts find_hidden_parts(const ScreenScene& page, const Occluders& occluders,
                              const PageEdges& edges, int threads, WorkMeter& meter) {
    const std::size_t n = edges.edges.size();
    std::vector<TaskParts> tasks((n + kGrain - 1) / kGrain);
    tbb::enumerable_thread_specific<HiddenLineFinder> finders(
        [&] { return HiddenLineFinder(occluders); });
    in_arena(threads, [&] {
        tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t task) {
            if (meter.stopped()) return;
            const std::size_t begin = task * kGrain, end = std::min(n, begin + kGrain);
            tasks[task] = find_parts_of(page, edges, begin, end, finders.local());
            meter.add(end - begin);
        });
    });
    HiddenParts parts;
    parts.first.reserve(n + 1);
    parts.first.push_back(0);
    for (const TaskParts& task : tasks) {
        for (const std::uint32_t count : task.counts)
            parts.first.push_back(parts.first.back() + count);
        parts.hidden.insert(parts.hidden.end(), task.hidden.begin(), task.hidden.end());
        parts.tests += task.tests;
    }
    return parts;
}

void append_lines(const ScreenScene& page, const PageEdges& edges, const HiddenParts& parts,
                  bool hidden, Drawing& drawing) {
    PartWriter writer(page, edges, drawing);
    for (std::size_t i = 0; i < edges.edges.size(); ++i) {
        writer.begin(edges.edges[i]);
        for (std::uint64_t h = parts.first[i]; h < parts.first[i + 1]; ++h)
            writer.add_hidden(parts.hidden[h]);
        writer.end(hidden);
    }
}

}  // namespace sightline
