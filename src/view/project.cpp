// From a Scene and a Camera to the canonical scene of integers: transform and snap all positions,
// drop what can't or shall not be seen, clip what crosses the view volume, give the planes.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <functional>

#include "math/arena.hpp"
#include "math/predicates.hpp"
#include "sightline/screen_scene.hpp"
#include "view/clip.hpp"
#include "view/facing.hpp"
#include "view/quadric.hpp"
#include "view/shared_planes.hpp"
#include "view/transform.hpp"
#include "view/vertex_stage.hpp"

namespace sightline {

namespace {

constexpr std::size_t kGrain = 16384;  // positions or triangles that a task takes at a time

template <class Body>
void parallel_ranges(std::size_t n, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kGrain),
                      [&](const auto& range) { body(range.begin(), range.end()); });
}

}  // namespace

class Projector {
public:
    Projector(const Scene& scene, const Camera& camera, const ProjectOptions& options,
              ScreenScene& screen)
        : screen_(screen), cull_(options.cull) {
        screen_.counts_ = {};
        screen_.skip_.clear();
        screen_.pieces_.clear();
        screen_.piece_ids_.clear();
        screen_.clipped_planes_.clear();
        screen_.scene_ = &scene;
        screen_.camera_ = camera;
        screen_.subpixel_bits_ =
            options.page ? page_bits_for(camera.resolution) : subpixel_bits_for(camera.resolution);
        screen_.counts_.triangles = scene.triangles.size();
        transform_ = make_transform(camera, screen_.subpixel_bits_);
        if (options.page) transform_.crop();
        drops_copies_ = options.page && !scene.equal_faces.empty();
    }

    void run() {
        snap_positions_of_scene();
        find_drawn_sides();
        mark_triangles();
        clip_marked();
        make_sheet_planes();
        make_screen_quadrics(scene().quadrics, screen_.camera_, transform_, screen_.quadrics_);
    }

private:
    enum Skip : std::uint8_t {
        kDraw = 0,
        kDegenerate,
        kCulled = ScreenScene::kCulledSide,
        kOutsideVolume,
        kClipped,
        kCopy
    };

    [[nodiscard]] const Scene& scene() const { return *screen_.scene_; }

    void snap_positions_of_scene() {
        const auto& positions = scene().positions;
        screen_.points_.resize(positions.size());
        std::atomic<std::size_t> outside{0};
        parallel_ranges(positions.size(), [&](std::size_t begin, std::size_t end) {
            outside += snap_positions(transform_, std::span(positions).subspan(begin, end - begin),
                                      screen_.points_.data() + begin);
        });
        some_outside_ = outside > 0;
    }

    // -- which sides of which objects are drawn ------------------------------------------------

    [[nodiscard]] bool is_outside(std::uint32_t point) const {
        return screen_.points_[point].x == kOutside;
    }

    [[nodiscard]] bool has_outside_corner(std::uint32_t t) const {
        const Corners c = scene().triangles[t];
        return is_outside(c.x) || is_outside(c.y) || is_outside(c.z);
    }

    // Back faces of an object are never seen when it is closed, opaque and not cut open by the
    // volume (a guard band cuts off screen, but telling the planes apart here would gain little).
    [[nodiscard]] bool hides_its_back(const Object& object) const {
        if (!object.closed || object.two_sided) return false;
        if (is_translucent(scene(), object)) return false;
        if (!some_outside_) return true;
        for (std::uint32_t t = 0; t < object.triangle_count; ++t)
            if (has_outside_corner(object.first_triangle + t)) return false;
        return true;
    }

    void find_drawn_sides() {
        culled_side_.assign(scene().objects.size(), Facing::edge_on);
        for (std::size_t o = 0; o < scene().objects.size(); ++o) {
            if (cull_ == Cull::front) culled_side_[o] = Facing::front;
            if (cull_ == Cull::back) culled_side_[o] = Facing::back;
            if (cull_ == Cull::automatic && hides_its_back(scene().objects[o]))
                culled_side_[o] = Facing::back;
            any_culling_ = any_culling_ || culled_side_[o] != Facing::edge_on;
        }
    }

    // -- what happens to each triangle ----------------------------------------------------------

    [[nodiscard]] std::array<glm::dvec3, 3> corners_of(std::uint32_t t) const {
        const Corners c = scene().triangles[t];
        return {scene().positions[c.x], scene().positions[c.y], scene().positions[c.z]};
    }

    // On a page equal faces are one face. A picture keeps them all: where they are translucent each
    // is a layer of its own.
    [[nodiscard]] bool is_copy(std::uint32_t t, Facing culled_side) const {
        if (!drops_copies_) return false;
        const unsigned bits = scene().equal_faces[t];
        // Where a side is removed, one of a face and what is turned over remains.
        return (bits & kRepeated) != 0 ||
               ((bits & kTurnedOver) != 0 && culled_side == Facing::edge_on);
    }

    [[nodiscard]] Skip fate_of(std::uint32_t t, Facing culled_side, ProjectCounts& counts) const {
        if (!scene().degenerate.empty() && scene().degenerate[t] != 0) {
            ++counts.degenerate;
            return kDegenerate;
        }
        if (is_copy(t, culled_side)) return kCopy;
        if (culled_side != Facing::edge_on &&
            facing(screen_.camera_, corners_of(t)) == culled_side) {
            ++counts.culled;
            return kCulled;
        }
        return some_outside_ && has_outside_corner(t) ? kClipped : kDraw;
    }

    void mark_triangles() {
        if (scene().degenerate.empty() && !any_culling_ && !some_outside_ && !drops_copies_) return;
        screen_.skip_.assign(scene().triangles.size(), kDraw);
        for (std::size_t o = 0; o < scene().objects.size(); ++o) {
            const Object& object = scene().objects[o];
            const Facing culled_side = culled_side_[o];
            const ProjectCounts sum = tbb::parallel_reduce(
                tbb::blocked_range<std::uint32_t>(0, object.triangle_count, kGrain),
                ProjectCounts{},
                [&](const auto& range, ProjectCounts counts) {
                    for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
                        const std::uint32_t t = object.first_triangle + i;
                        screen_.skip_[t] = fate_of(t, culled_side, counts);
                    }
                    return counts;
                },
                [](ProjectCounts a, const ProjectCounts& b) {
                    a.degenerate += b.degenerate;
                    a.culled += b.culled;
                    return a;
                });
            screen_.counts_.degenerate += sum.degenerate;
            screen_.counts_.culled += sum.culled;
        }
    }

    // -- clipping -----------------------------------------------------------------------------

    [[nodiscard]] std::uint32_t add_point(const ScreenPoint& p) {
        screen_.points_.push_back(p);
        return static_cast<std::uint32_t>(screen_.points_.size() - 1);
    }

    // A fan of pieces. They share one plane, that of the polygon or of the triangle's sheet.
    void add_pieces(std::uint32_t t, const std::vector<ScreenPoint>& polygon) {
        const std::uint32_t first = add_point(polygon[0]);
        std::uint32_t previous = add_point(polygon[1]);
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            const std::uint32_t corner = add_point(polygon[k]);
            screen_.pieces_.emplace_back(first, previous, corner);
            screen_.piece_ids_.push_back(t);
            previous = corner;
        }
        screen_.clipped_planes_.emplace(t, plane_of_spread_points(polygon));
        ++screen_.counts_.clipped;
        screen_.counts_.pieces += polygon.size() - 2;
    }

    void clip_marked() {
        if (!some_outside_) return;
        std::vector<ScreenPoint> polygon;
        for (std::uint32_t t = 0; t < scene().triangle_count(); ++t) {
            if (screen_.skip_[t] != kClipped) continue;
            if (screen_.is_edge_on(t)) continue;
            polygon.clear();
            clip_triangle(transform_, corners_of(t), polygon);
            if (polygon.size() >= 3)
                add_pieces(t, polygon);
            else
                ++screen_.counts_.outside;
        }
    }

    // -- shared planes --------------------------------------------------------------------------

    // On the page the frame's corners stay far apart, as they are in the world, unless the sheet
    // reaches so deep that perspective squeezes its far part.
    [[nodiscard]] bool frame_serves(const Corners& frame, const glm::dvec4& ball) const {
        if (some_outside_ && (is_outside(frame.x) || is_outside(frame.y) || is_outside(frame.z)))
            return false;
        return !transform_.perspective ||
               3 * ball.w <= screen_.camera_.depth_of({ball.x, ball.y, ball.z});
    }

    [[nodiscard]] Plane plane_of_sheet(std::size_t s) const {
        const Sheets& sheets = scene().sheets;
        const Corners frame = sheets.frame[s];
        if (frame_serves(frame, sheets.ball[s]))
            return plane_through(screen_.point(frame.x), screen_.point(frame.y),
                                 screen_.point(frame.z));
        std::vector<ScreenPoint> points;
        for (std::uint32_t m = sheets.first[s]; m < sheets.first[s + 1]; ++m)
            collect_points(sheets.members[m], points);
        return plane_of_spread_points(points);
    }

    void collect_points(std::uint32_t t, std::vector<ScreenPoint>& points) const {
        if (some_outside_ && has_outside_corner(t)) {
            const auto [begin, end] =
                std::equal_range(screen_.piece_ids_.begin(), screen_.piece_ids_.end(), t);
            for (auto id = begin; id != end; ++id) {
                const Corners piece =
                    screen_.pieces_[static_cast<std::size_t>(id - screen_.piece_ids_.begin())];
                for (int k = 0; k < 3; ++k) points.push_back(screen_.point(piece[k]));
            }
            return;
        }
        const Corners c = scene().triangles[t];
        for (int k = 0; k < 3; ++k) points.push_back(screen_.point(c[k]));
    }

    void make_sheet_planes() {
        screen_.sheet_planes_.resize(scene().sheets.count());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scene().sheets.count(), 256),
                          [&](const auto& range) {
                              for (std::size_t s = range.begin(); s != range.end(); ++s)
                                  screen_.sheet_planes_[s] = plane_of_sheet(s);
                          });
    }

    ScreenScene& screen_;
    ScreenTransform transform_;
    Cull cull_;
    bool some_outside_ = false;
    bool any_culling_ = false;
    bool drops_copies_ = false;
    std::vector<Facing> culled_side_;  // by object; edge_on: both sides are drawn
};

Status project(const Scene& scene, const Camera& camera, const ProjectOptions& options,
               ScreenScene& out) {
    if (camera.resolution.width == 0 || camera.resolution.height == 0 ||
        std::max(camera.resolution.width, camera.resolution.height) > 65536)
        return Error{ErrorKind::bad_option, "--resolution must be 1 to 65536 pixels a side"};
    Projector projector(scene, camera, options, out);
    in_arena(options.threads, [&] { projector.run(); });
    return success();
}

Result<ScreenScene> project(const Scene& scene, const Camera& camera,
                            const ProjectOptions& options) {
    ScreenScene screen;
    if (Status s = project(scene, camera, options, screen); !s) return s.error();
    return screen;
}

}  // namespace sightline
