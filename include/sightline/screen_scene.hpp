// The canonical scene: what a camera makes of a Scene, in integers. Every visibility algorithm
// reads this and nothing else, and every decision after it is exact.
//
// Units. x and y: 1/2^subpixel_bits pixel (8 bits unless the picture is too wide), origin at the
// top left corner of the picture, y down. z: 0 (near plane) .. 2^30 - 1 (far plane), growing away.
// In perspective z is linear in 1/depth, so planes of the world are planes on the screen.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "sightline/aligned_vector.hpp"
#include "sightline/camera.hpp"
#include "sightline/scene.hpp"

namespace sightline {

inline constexpr int kDepthBits = 30;  ///< Z of docs/exactness.md
inline constexpr std::int32_t kDepthMax = (std::int32_t{1} << kDepthBits) - 1;
inline constexpr int kCoordBits = 23;  ///< b: extent of x and y, guard band included

/// A snapped point. Sixteen bytes, so that none lies across two cache lines.
struct alignas(16) ScreenPoint {
    std::int32_t x, y, z;
    friend bool operator==(const ScreenPoint&, const ScreenPoint&) = default;
};

/// A plane through a snapped point: c * (z - at.z) = a * (x - at.x) + b * (y - at.y), c >= 0.
/// c = 0: the plane is seen edge-on and has no depth. |a|, |b| < 2^(b+Z+1), c < 2^(2b+1).
struct Plane {
    std::int64_t a = 0, b = 0, c = 0;
    ScreenPoint at{};
    friend bool operator==(const Plane&, const Plane&) = default;
};

/// The rays of a view in a quadric's own coordinates. The one through (x, y) on the screen is, with
/// dx = x - ScreenQuadrics::cx and dy = y - cy,
///
///     ((origin + dx origin_x) + dy origin_y) + depth * ((way + dx way_x) + dy way_y).
struct ScreenQuadric {
    glm::dvec3 origin{}, origin_x{}, origin_y{};
    glm::dvec3 way{}, way_x{}, way_y{};
    /// Where it can be seen, in units of the screen, ends included; empty when x_min > x_max.
    std::int32_t x_min = 0, x_max = -1, y_min = 0, y_max = -1;
};

/// The quadrics of a scene in a view, and what turns a metric depth into z.
struct ScreenQuadrics {
    std::vector<ScreenQuadric> rays;  ///< one a quadric of the scene
    bool perspective = true;
    double cx = 0, cy = 0;             ///< centre of the picture, in units of the screen
    double z_offset = 0, z_scale = 0;  ///< z = z_offset + z_scale * (1/depth, or depth)
    double near_plane = 1, far_plane = 2;
};

enum class Cull { automatic, none, back, front };

/// How many triangles project() dropped, and why; for `--stats`.
struct ProjectCounts {
    std::uint64_t triangles = 0;   ///< in the scene
    std::uint64_t degenerate = 0;  ///< no area in the world
    std::uint64_t culled = 0;      ///< removed because of the side they show
    std::uint64_t outside = 0;     ///< wholly outside of the view volume
    std::uint64_t clipped = 0;     ///< cut by near, far or the guard band
    std::uint64_t pieces = 0;      ///< triangles that came of the cuts
};

struct ProjectOptions {
    Cull cull = Cull::automatic;
    int threads = 0;  ///< 0 = all cores
    /// For drawings: as many steps a pixel as fit, and nothing outside of the picture. See
    /// page_of().
    bool page = false;
};

/// Read-only once made; any number of threads may use it. Refers to its Scene, which must outlive
/// it and stay unchanged.
class ScreenScene {
public:
    // -- triangles ---------------------------------------------------------------------------
    // Screen triangles 0 .. scene().triangle_count()-1 are those of the scene; further ones are
    // pieces of clipped triangles. A dropped or clipped triangle is not drawable, nor is one that
    // is seen edge-on in the world: it covers nothing, whatever snapping makes of it.

    [[nodiscard]] std::uint32_t triangle_count() const {
        return scene_->triangle_count() + static_cast<std::uint32_t>(pieces_.size());
    }
    [[nodiscard]] bool drawable(std::uint32_t k) const {
        if (k >= scene_->triangle_count()) return true;
        if (!skip_.empty() && skip_[k] != 0) return false;
        return !is_thin(k) || !is_edge_on(k);
    }
    /// Whether a triangle of the scene lies in a plane that is seen as a line: exactly, as
    /// Camera::sees_edge_on() has it.
    [[nodiscard]] bool is_edge_on(std::uint32_t id) const;
    /// The doubled area on the screen, whatever its sign, up to which a triangle with a box of this
    /// size may be one that is seen edge-on. Let its true corners lie on a line, in a box of w by
    /// h, and let each coordinate be moved by at most m. To first order the doubled area becomes at
    /// most the sum over the sides of m (|dx| + |dy|), which is 2m (w + h), and the rest is below
    /// 8m^2; the box seen is smaller than the true one by at most 2m. Snapping moves by 1/2; with
    /// m = 1, double precision may be off by as much again.
    [[nodiscard]] static constexpr std::int64_t thin_area(std::int64_t width, std::int64_t height) {
        return 2 * (width + height) + 16;
    }
    /// Whether a triangle of the scene was removed because of the side it shows.
    [[nodiscard]] bool culled(std::uint32_t id) const {
        return !skip_.empty() && skip_[id] == kCulledSide;
    }
    /// Indices of the corners of screen triangle k into the snapped points.
    [[nodiscard]] Corners corners(std::uint32_t k) const {
        const std::uint32_t n = scene_->triangle_count();
        return k < n ? scene_->triangles[k] : pieces_[k - n];
    }
    /// The triangle of the scene that screen triangle k is, or is a piece of.
    [[nodiscard]] std::uint32_t id(std::uint32_t k) const {
        const std::uint32_t n = scene_->triangle_count();
        return k < n ? k : piece_ids_[k - n];
    }
    [[nodiscard]] const ScreenPoint& point(std::uint32_t index) const { return points_[index]; }

    // -- planes ------------------------------------------------------------------------------

    /// The plane that decides the depth of a triangle of the scene (by id). Triangles of one sheet
    /// have equal planes. Defined for triangles that are drawable or have pieces.
    [[nodiscard]] Plane plane(std::uint32_t id) const;
    /// Sheet of a triangle when its shared plane is in force in this view, else kNone. Two
    /// triangles with the same shared plane tie everywhere.
    [[nodiscard]] std::uint32_t shared_plane(std::uint32_t id) const {
        const std::uint32_t sheet = scene_->sheets.of(id);
        return sheet != kNone && sheet_planes_[sheet].c != 0 ? sheet : kNone;
    }

    /// The plane of a sheet in this view; c = 0 when it is not in force.
    [[nodiscard]] const Plane& sheet_plane(std::uint32_t sheet) const {
        return sheet_planes_[sheet];
    }

    /// Replaces that plane by one that was found elsewhere, with triangles that are not in this
    /// scene; see StreamPlan.
    void set_sheet_plane(std::uint32_t sheet, const Plane& plane) { sheet_planes_[sheet] = plane; }

    // -- quadrics ----------------------------------------------------------------------------
    // Screen triangles do not include them, and they have no plane: see hit_quadric().

    [[nodiscard]] const ScreenQuadrics& quadrics() const { return quadrics_; }
    /// Whether an id is that of a quadric: number id - scene().triangle_count().
    [[nodiscard]] bool is_quadric(std::uint32_t id) const { return scene_->is_quadric(id); }

    // -- the view ----------------------------------------------------------------------------

    [[nodiscard]] const Scene& scene() const { return *scene_; }
    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] Resolution resolution() const { return camera_.resolution; }
    [[nodiscard]] int subpixel_bits() const { return subpixel_bits_; }
    [[nodiscard]] const ProjectCounts& counts() const { return counts_; }

    /// Metric depth (distance along the gaze) of a value of z. Uses only + - * /, so it gives the
    /// same bits everywhere.
    [[nodiscard]] double metric_depth(double z) const;

    // -- arrays, for algorithms that take many triangles at a time ----------------

    [[nodiscard]] std::span<const ScreenPoint> points() const { return points_; }
    /// One byte a triangle of the scene, not 0 = not drawable; empty when none is marked. Of the
    /// others those of at most thin_area() may still be not drawable().
    [[nodiscard]] std::span<const std::uint8_t> skip() const { return skip_; }
    /// Corners of the pieces: screen triangle scene().triangle_count() + i is pieces()[i].
    [[nodiscard]] std::span<const Corners> pieces() const { return pieces_; }

private:
    friend class Projector;
    static constexpr std::uint8_t kCulledSide = 2;  // in skip_

    [[nodiscard]] bool is_thin(std::uint32_t id) const {
        const Corners c = scene_->triangles[id];
        const ScreenPoint &p = points_[c.x], &q = points_[c.y], &r = points_[c.z];
        const std::int64_t ux = q.x - p.x, uy = q.y - p.y, vx = r.x - p.x, vy = r.y - p.y;
        const std::int64_t doubled = ux * vy - uy * vx;
        // Two sides are as long as the box at least.
        return std::abs(doubled) <=
               thin_area(std::abs(ux) + std::abs(vx), std::abs(uy) + std::abs(vy));
    }

    const Scene* scene_ = nullptr;
    Camera camera_;
    int subpixel_bits_ = 8;
    ProjectCounts counts_;
    AlignedVector<ScreenPoint> points_;  // snapped positions of the scene, then clip points
    std::vector<std::uint8_t> skip_;
    std::vector<Corners> pieces_;           // of clipped triangles
    std::vector<std::uint32_t> piece_ids_;  // the triangle of each piece, ascending
    std::vector<Plane> sheet_planes_;
    std::unordered_map<std::uint32_t, Plane> clipped_planes_;  // of clipped triangles, by id
    ScreenQuadrics quadrics_;
};

/// Where the ray through a point of the screen (x, y in its units) meets quadric k for the first
/// time, between the near and the far plane and inside of the quadric's box: one fixed sequence of
/// operations in double precision. This and nothing else says where a quadric is seen.
struct QuadricHit {
    std::int32_t z = 0;  ///< on the depth grid: what is compared
    double depth = 0;    ///< metric
    glm::dvec3 own{};    ///< in the quadric's own coordinates
};
[[nodiscard]] std::optional<QuadricHit> hit_quadric(const ScreenScene& screen, std::uint32_t k,
                                                    std::int32_t x, std::int32_t y);

/// Transforms, clips and snaps a finished scene. O(positions + triangles), on all cores; the result
/// does not depend on the number of threads or the vector width.
/// Error (bad_option): a picture too wide for the coordinates (over 65,536 a side).
[[nodiscard]] Result<ScreenScene> project(const Scene& scene, const Camera& camera,
                                          const ProjectOptions& options = {});

/// The same into `out`, whose memory is reused: for one frame after another.
[[nodiscard]] Status project(const Scene& scene, const Camera& camera,
                             const ProjectOptions& options, ScreenScene& out);

/// How many triangles of a scene turn their back to the camera: of all, in the view or not, drawn
/// or culled. Those seen edge-on and those without area have no back. O(triangles), on all cores.
[[nodiscard]] std::uint64_t count_back_facing(const Scene& scene, const Camera& camera,
                                              int threads = 0);

}  // namespace sightline
