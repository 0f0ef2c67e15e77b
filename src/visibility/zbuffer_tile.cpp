// Raster stage of the z-buffer: draws triangles into a tile that stays in a core's cache.
//
// Coverage is exact: edge functions in 64-bit integers at the corner of the triangle's box, divided
// by the sample step (which keeps their sign at the samples, see below), then 32-bit increments.
// Depth is the stored depth, in the very operations of stored_depth.hpp, so what the tile holds at
// the end needs no further work. Two depths nearer than twice its error are compared exactly.
//
// Edge functions at samples are E + i * a * step + j * b * step with integers a, b. For a floor
// division, E + m * step >= 0 if and only if floor(E / step) + m >= 0. An edge that does not own
// its points asks for E > 0, that is E - 1 >= 0. Within the box of a tile |a|, |b| < 2^23 and at
// most 64 samples, so an edge that crosses the box stays below 2^30; one that does not is settled
// at once.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "math/predicates.hpp"
#include "visibility/stored_depth.hpp"
#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_tile.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#ifndef SIGHTLINE_ZBUFFER_TILE_ONCE
#define SIGHTLINE_ZBUFFER_TILE_ONCE
namespace sightline::zbuffer {
namespace {

/// Beyond this distance two stored depths are in the order of the true ones. The sum or difference
/// of a depth and this is a float below 2^31, so it is off by at most 64.
constexpr float kUncertain = 1024.0f;
static_assert(kUncertain - 64 > 2 * kStoredDepthError);

/// An edge at the first sample of a box, and its increments a column and a row.
struct Edge {
    std::int32_t value, per_column, per_row;
};

/// A triangle in the part of a tile that its box meets. Columns and rows are the tile's, inclusive.
struct Setup {
    std::uint32_t id;
    std::int32_t column0, column1, row0, row1;
    Edge edges[3];
    Plane plane;
    DepthGradient gradient;
    OrientedTriangle triangle;
};

enum class Outcome { empty, regular, steep };

bool set_edge(const ScreenPoint& p, const ScreenPoint& q, std::int32_t x, std::int32_t y,
              int step_bits, std::int32_t columns, std::int32_t rows, Edge& edge) {
    const std::int32_t dx = q.x - p.x, dy = q.y - p.y;
    const std::int64_t bias = is_top_left(dx, dy) ? 0 : 1;
    const std::int64_t at = (side(p.x, p.y, q.x, q.y, x, y) - bias) >> step_bits;
    const std::int64_t across = std::int64_t{-dy} * columns, down = std::int64_t{dx} * rows;
    const std::int64_t zero = 0;
    if (at + std::max(across, zero) + std::max(down, zero) < 0) return false;
    if (at + std::min(across, zero) + std::min(down, zero) >= 0)
        edge = {0, 0, 0};  // the whole box lies on its inner side
    else
        edge = {static_cast<std::int32_t>(at), -dy, dx};
    return true;
}

// First sample at or after, and last at or before, a coordinate of the screen.
std::int32_t first_sample(const GridUnits& grid, std::int32_t x) {
    return (x - grid.offset + (1 << grid.step_bits) - 1) >> grid.step_bits;
}
std::int32_t last_sample(const GridUnits& grid, std::int32_t x) {
    return (x - grid.offset) >> grid.step_bits;
}

Outcome set_up(const ScreenScene& screen, const GridUnits& grid, const Tile& tile, std::uint32_t k,
               Setup& s) {
    const Corners c = screen.corners(k);
    const ScreenPoint p = screen.point(c.x), q = screen.point(c.y), r = screen.point(c.z);
    s.triangle = OrientedTriangle(p, q, r);
    if (s.triangle.area2 == 0) return Outcome::empty;
    s.column0 = std::max(first_sample(grid, std::min({p.x, q.x, r.x})) - tile.column, 0);
    s.row0 = std::max(first_sample(grid, std::min({p.y, q.y, r.y})) - tile.row, 0);
    s.column1 =
        std::min(last_sample(grid, std::max({p.x, q.x, r.x})) - tile.column, tile.width - 1);
    s.row1 = std::min(last_sample(grid, std::max({p.y, q.y, r.y})) - tile.row, tile.height - 1);
    if (s.column0 > s.column1 || s.row0 > s.row1) return Outcome::empty;

    const std::int32_t x0 = grid.position(tile.column + s.column0);
    const std::int32_t y0 = grid.position(tile.row + s.row0);
    const std::int32_t columns = s.column1 - s.column0, rows = s.row1 - s.row0;
    const OrientedTriangle& t = s.triangle;
    if (!set_edge(t.p, t.q, x0, y0, grid.step_bits, columns, rows, s.edges[0]) ||
        !set_edge(t.q, t.r, x0, y0, grid.step_bits, columns, rows, s.edges[1]) ||
        !set_edge(t.r, t.p, x0, y0, grid.step_bits, columns, rows, s.edges[2]))
        return Outcome::empty;

    s.id = screen.id(k);
    const bool own_plane = k == s.id && screen.shared_plane(s.id) == kNone;
    s.plane = own_plane ? plane_through(p, q, r) : screen.plane(s.id);
    if (s.plane.c == 0) return Outcome::empty;
    s.gradient = depth_gradient(s.plane);
    const std::int32_t x1 = grid.position(tile.column + s.column1);
    const std::int32_t y1 = grid.position(tile.row + s.row1);
    const auto reach = [](std::int32_t lo, std::int32_t hi, std::int32_t at) {
        return static_cast<float>(std::max(std::abs(lo - at), std::abs(hi - at)));
    };
    const float rise = std::abs(s.gradient.gx) * reach(x0, x1, s.plane.at.x) +
                       std::abs(s.gradient.gy) * reach(y0, y1, s.plane.at.y);
    return rise <= kRegularRise ? Outcome::regular : Outcome::steep;
}

/// Draws one triangle after another into a tile.
struct Painter {
    const ScreenScene& screen;
    const GridUnits& grid;
    Observer* observer;
    Tile& tile;
    TileCounts& counts;

    void own(std::size_t at, const Setup& s, float z, std::int32_t column, std::int32_t row) {
        if (observer != nullptr) {
            const auto i = static_cast<std::uint32_t>(tile.column + column);
            const auto j = static_cast<std::uint32_t>(tile.row + row);
            observer->step({StepKind::sample_decided, s.id, tile.ids[at], i, j, i + 1, j + 1});
        }
        tile.depth[at] = z;
        tile.ids[at] = s.id;
    }

    /// The canonical order at a sample that two triangles cover: depth, then id.
    bool comes_before(const Setup& s, std::uint32_t owner, std::int32_t x, std::int32_t y) {
        if (owner == s.id) return false;
        const std::uint32_t sheet = screen.shared_plane(s.id);
        if (sheet != kNone && sheet == screen.shared_plane(owner)) return s.id < owner;
        ++counts.exact;
        if (observer != nullptr)
            observer->step({StepKind::exact_comparison, s.id, owner, 0, 0, 0, 0});
        const int order = compare_depth(s.plane, screen.plane(owner), x, y).sign;
        return order != 0 ? order < 0 : s.id < owner;
    }

    /// One covered sample, with the stored depth of the newcomer.
    void offer(const Setup& s, float z, std::int32_t column, std::int32_t row) {
        const std::size_t at =
            static_cast<std::size_t>(row) * Tile::kStride + static_cast<std::size_t>(column);
        const float old = tile.depth[at];
        if (z > old + kUncertain) return;
        if (z < old - kUncertain ||
            comes_before(s, tile.ids[at], grid.position(tile.column + column),
                         grid.position(tile.row + row)))
            own(at, s, z, column, row);
    }

    /// Triangles so steep that the float evaluation has no bound: few, and taken sample by sample.
    void draw_steep(const Setup& s) {
        for (std::int32_t row = s.row0; row <= s.row1; ++row)
            for (std::int32_t column = s.column0; column <= s.column1; ++column) {
                const std::int32_t x = grid.position(tile.column + column);
                const std::int32_t y = grid.position(tile.row + row);
                if (covers(s.triangle, x, y)) offer(s, stored_depth(s.plane, x, y), column, row);
            }
    }
};

}  // namespace
}  // namespace sightline::zbuffer
#endif  // SIGHTLINE_ZBUFFER_TILE_ONCE

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Ints = hn::CappedTag<std::int32_t, 16>;
using Floats = hn::Rebind<float, Ints>;
using Uints = hn::Rebind<std::uint32_t, Ints>;
using VI = hn::Vec<Ints>;
using VF = hn::Vec<Floats>;

constexpr Ints kI;
constexpr Floats kF;
constexpr Uints kU;

// Bit i set: lane i.
HWY_INLINE std::uint32_t bits_of(hn::Mask<Floats> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kF, mask, bytes);
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

// Newcomers at `column`.. of a row: nearer ones take their samples, doubtful ones are compared.
HWY_INLINE void offer_vector(Painter& painter, const Setup& s, VF z, hn::Mask<Floats> covered,
                             std::int32_t column, std::int32_t row) {
    Tile& tile = painter.tile;
    const std::size_t at =
        static_cast<std::size_t>(row) * Tile::kStride + static_cast<std::size_t>(column);
    const VF old = hn::LoadU(kF, tile.depth + at);
    const VF margin = hn::Set(kF, kUncertain);
    const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, margin)));
    const auto doubtful = hn::AndNot(nearer, hn::And(covered, hn::Le(z, hn::Add(old, margin))));
    if (HWY_UNLIKELY(painter.observer != nullptr || !hn::AllFalse(kF, doubtful))) {
        HWY_ALIGN float depths[hn::MaxLanes(Floats())];
        hn::Store(z, kF, depths);
        const auto offered = painter.observer != nullptr ? hn::Or(nearer, doubtful) : doubtful;
        for (std::uint32_t rest = bits_of(offered); rest != 0; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            painter.offer(s, depths[lane], column + lane, row);
        }
        if (painter.observer != nullptr) return;
    }
    hn::BlendedStore(z, nearer, kF, tile.depth + at);
    hn::BlendedStore(hn::Set(kU, s.id), hn::RebindMask(kU, nearer), kU, tile.ids + at);
}

void draw_regular(Painter& painter, const Setup& s) {
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(kI));
    const GridUnits& grid = painter.grid;
    const std::int32_t step = 1 << grid.step_bits;
    const VI iota = hn::Iota(kI, 0);
    const std::int32_t x0 = grid.position(painter.tile.column + s.column0) - s.plane.at.x;
    std::int32_t dy = grid.position(painter.tile.row + s.row0) - s.plane.at.y;
    const VI first_dx = hn::Add(hn::Set(kI, x0), hn::Mul(iota, hn::Set(kI, step)));
    VI left[3], across[3];
    for (int k = 0; k < 3; ++k) {
        left[k] = hn::Add(hn::Set(kI, s.edges[k].value),
                          hn::Mul(iota, hn::Set(kI, s.edges[k].per_column)));
        across[k] = hn::Set(kI, s.edges[k].per_column * lanes);
    }
    const VF gx = hn::Set(kF, s.gradient.gx), z0 = hn::Set(kF, s.gradient.z0);
    for (std::int32_t row = s.row0; row <= s.row1; ++row, dy += step) {
        const VF ty = hn::Set(kF, s.gradient.gy * static_cast<float>(dy));
        VI e0 = left[0], e1 = left[1], e2 = left[2], dx = first_dx;
        for (std::int32_t column = s.column0; column <= s.column1; column += lanes) {
            // Beyond the box an edge that was settled for the box says nothing.
            const auto in_box = hn::Lt(iota, hn::Set(kI, s.column1 - column + 1));
            const auto inside = hn::Gt(hn::Or(e0, hn::Or(e1, e2)), hn::Set(kI, -1));
            const auto covered = hn::RebindMask(kF, hn::And(in_box, inside));
            if (!hn::AllFalse(kF, covered)) {
                const VF tx = hn::Mul(gx, hn::ConvertTo(kF, dx));
                const VF z = hn::Min(hn::Max(hn::Add(z0, hn::Add(tx, ty)), hn::Zero(kF)),
                                     hn::Set(kF, kStoredDepthMax));
                offer_vector(painter, s, z, covered, column, row);
            }
            e0 = hn::Add(e0, across[0]);
            e1 = hn::Add(e1, across[1]);
            e2 = hn::Add(e2, across[2]);
            dx = hn::Add(dx, hn::Set(kI, step * lanes));
        }
        for (int k = 0; k < 3; ++k) left[k] = hn::Add(left[k], hn::Set(kI, s.edges[k].per_row));
    }
}

void draw(const ScreenScene& screen, const GridUnits& grid,
          std::span<const std::uint32_t> triangles, Observer* observer, Tile& tile,
          TileCounts& counts) {
    Painter painter{screen, grid, observer, tile, counts};
    Setup setup{0, 0, 0, 0, 0, {}, {}, {}, OrientedTriangle({}, {}, {})};
    for (const std::uint32_t k : triangles) {
        const Outcome outcome = set_up(screen, grid, tile, k, setup);
        if (outcome == Outcome::empty) continue;
        ++counts.triangles;
        if (observer != nullptr)
            observer->step({StepKind::triangle_taken, setup.id, kNone, 0, 0, 0, 0});
        if (outcome == Outcome::regular)
            draw_regular(painter, setup);
        else
            painter.draw_steep(setup);
    }
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw);

void clear_tile(Tile& tile) {
    std::fill(std::begin(tile.depth), std::end(tile.depth), std::numeric_limits<float>::infinity());
    std::fill(std::begin(tile.ids), std::end(tile.ids), kNone);
}

void draw_triangles(const ScreenScene& screen, const GridUnits& grid,
                    std::span<const std::uint32_t> triangles, Observer* observer, Tile& tile,
                    TileCounts& counts) {
    HWY_DYNAMIC_DISPATCH(draw)(screen, grid, triangles, observer, tile, counts);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
