// Raster stage of the z-buffer, the general case: one triangle of any size into a tile.
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
//
// The box is walked in blocks of 16 by 8 samples. A block that an edge excludes, or in which
// hierarchical depth shows that all is hidden, is left out.
#include <algorithm>
#include <bit>
#include <cmath>

#include "math/predicates.hpp"
#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_large.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#ifndef SIGHTLINE_ZBUFFER_LARGE_ONCE
#define SIGHTLINE_ZBUFFER_LARGE_ONCE
namespace sightline::zbuffer {
namespace {

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

bool set_box(const GridUnits& grid, const Tile& tile, const OrientedTriangle& t, Setup& s) {
    s.column0 = std::max(grid.first_from(std::min({t.p.x, t.q.x, t.r.x})) - tile.column, 0);
    s.row0 = std::max(grid.first_from(std::min({t.p.y, t.q.y, t.r.y})) - tile.row, 0);
    s.column1 =
        std::min(grid.last_until(std::max({t.p.x, t.q.x, t.r.x})) - tile.column, tile.width - 1);
    s.row1 = std::min(grid.last_until(std::max({t.p.y, t.q.y, t.r.y})) - tile.row, tile.height - 1);
    return s.column0 <= s.column1 && s.row0 <= s.row1;
}

Outcome set_up(const ScreenScene& screen, const GridUnits& grid, const Tile& tile, std::uint32_t k,
               Setup& s) {
    const Corners c = screen.corners(k);
    const ScreenPoint p = screen.point(c.x), q = screen.point(c.y), r = screen.point(c.z);
    s.triangle = OrientedTriangle(p, q, r);
    const OrientedTriangle& t = s.triangle;
    if (t.area2 == 0 || !set_box(grid, tile, t, s)) return Outcome::empty;

    const std::int32_t x0 = grid.position(tile.column + s.column0);
    const std::int32_t y0 = grid.position(tile.row + s.row0);
    const std::int32_t columns = s.column1 - s.column0, rows = s.row1 - s.row0;
    if (!set_edge(t.p, t.q, x0, y0, grid.step_bits, columns, rows, s.edges[0]) ||
        !set_edge(t.q, t.r, x0, y0, grid.step_bits, columns, rows, s.edges[1]) ||
        !set_edge(t.r, t.p, x0, y0, grid.step_bits, columns, rows, s.edges[2]))
        return Outcome::empty;
    if (!screen.drawable(k)) return Outcome::empty;

    s.id = screen.id(k);
    s.plane = screen.plane(s.id);
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

/// Gives samples of a tile to a triangle.
struct Painter {
    const RasterInput& input;
    Tile& tile;
    TileCounts& counts;
    Setup setup{0, 0, 0, 0, 0, {}, {}, {}, OrientedTriangle({}, {}, {})};

    void own(std::size_t at, float z, std::int32_t column, std::int32_t row) {
        if (input.observer != nullptr) {
            const auto i = static_cast<std::uint32_t>(tile.column + column);
            const auto j = static_cast<std::uint32_t>(tile.row + row);
            input.observer->step(
                {StepKind::sample_decided, setup.id, tile.ids[at], i, j, i + 1, j + 1});
        }
        tile.depth[at] = z;
        tile.ids[at] = setup.id;
    }

    /// One covered sample, with the stored depth of the newcomer.
    void offer(float z, std::int32_t column, std::int32_t row) {
        const std::size_t at = Tile::index(column, row);
        const float old = tile.depth[at];
        if (z > old + kUncertain) return;
        if (z < old - kUncertain ||
            comes_before(input, setup.id, tile.ids[at], input.grid.position(tile.column + column),
                         input.grid.position(tile.row + row), counts))
            own(at, z, column, row);
    }

    /// Triangles so steep that the float evaluation has no bound: few, and taken sample by sample.
    void draw_steep() {
        for (std::int32_t row = setup.row0; row <= setup.row1; ++row)
            for (std::int32_t column = setup.column0; column <= setup.column1; ++column) {
                const std::int32_t x = input.grid.position(tile.column + column);
                const std::int32_t y = input.grid.position(tile.row + row);
                if (covers(setup.triangle, x, y))
                    offer(stored_depth(setup.plane, x, y), column, row);
            }
    }
};

}  // namespace
}  // namespace sightline::zbuffer
#endif  // SIGHTLINE_ZBUFFER_LARGE_ONCE

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
constexpr std::int32_t kBlockRows = 1 << Tile::kBlockBits, kBlockColumns = 2 * kBlockRows;

// Samples of a cell: those from `first` on, a vector of them.
struct Part {
    std::int32_t column, row;  // of the cell
    std::size_t first, at;     // in the cell, in the tile
};

// Newcomers in a part of a cell: nearer ones take their samples, doubtful ones are compared.
HWY_INLINE void offer_vector(Painter& painter, VF z, hn::Mask<Floats> covered, const Part& part) {
    Tile& tile = painter.tile;
    const std::size_t at = part.at;
    const VF old = hn::Load(kF, tile.depth + at);
    const VF margin = hn::Set(kF, kUncertain);
    const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, margin)));
    const auto doubtful = hn::AndNot(nearer, hn::And(covered, hn::Le(z, hn::Add(old, margin))));
    const bool watched = painter.input.observer != nullptr;
    if (HWY_UNLIKELY(watched || !hn::AllFalse(kF, doubtful))) {
        HWY_ALIGN float depths[hn::MaxLanes(Floats())];
        hn::Store(z, kF, depths);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(kF, watched ? hn::Or(nearer, doubtful) : doubtful, bits);
        for (unsigned rest = bits[0] | unsigned{bits[1]} << 8; rest != 0; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            const std::int32_t in_cell = static_cast<std::int32_t>(part.first) + lane;
            painter.offer(depths[lane], part.column + (in_cell & (Tile::kCellSide - 1)),
                          part.row + (in_cell >> Tile::kCellBits));
        }
        if (watched) return;
    }
    hn::BlendedStore(z, nearer, kF, tile.depth + at);
    hn::BlendedStore(hn::Set(kU, painter.setup.id), hn::RebindMask(kU, nearer), kU, tile.ids + at);
}

// A part of the box within kBlockColumns by kBlockRows samples.
struct Block {
    std::int32_t column0, column1, row0, row1;
};

// Whether an edge excludes the block.
bool is_excluded(const Setup& s, const Block& b) {
    for (const Edge& e : s.edges) {
        const std::int32_t columns = e.per_column > 0 ? b.column1 : b.column0;
        const std::int32_t rows = e.per_row > 0 ? b.row1 : b.row0;
        if (e.value + e.per_column * (columns - s.column0) + e.per_row * (rows - s.row0) < 0)
            return true;
    }
    return false;
}

// Whether all of the triangle in the block lies behind what the block holds. The stored depth is
// monotone in x and y, so its least value is that of a corner.
bool is_hidden(const Painter& painter, const Block& b) {
    const Setup& s = painter.setup;
    const Tile& tile = painter.tile;
    const GridUnits& grid = painter.input.grid;
    const auto least = [](float g, std::int32_t d0, std::int32_t d1) {
        return std::min(g * static_cast<float>(d0), g * static_cast<float>(d1));
    };
    const float tx = least(s.gradient.gx, grid.position(tile.column + b.column0) - s.plane.at.x,
                           grid.position(tile.column + b.column1) - s.plane.at.x);
    const float ty = least(s.gradient.gy, grid.position(tile.row + b.row0) - s.plane.at.y,
                           grid.position(tile.row + b.row1) - s.plane.at.y);
    const float nearest = s.gradient.z0 + (tx + ty) - kUncertain;
    if (nearest > tile.tile_max) return true;
    for (std::int32_t r = b.row0 >> Tile::kBlockBits; r <= b.row1 >> Tile::kBlockBits; ++r)
        for (std::int32_t c = b.column0 >> Tile::kBlockBits; c <= b.column1 >> Tile::kBlockBits;
             ++c)
            if (!(nearest > tile.block_max[r * static_cast<std::int32_t>(Tile::kBlocks) + c]))
                return false;
    return true;
}

// Where columns, or rows, of samples stand in each cell of a block.
template <int kCells>
struct Positions {
    VI outside[kCells];  // negative outside of the block
    VF term[kCells];     // of the depth

    // at: of the samples; gradient: of the depth; from: what it begins at, for sample 0.
    HWY_INLINE void set(VI at, std::int32_t first, std::int32_t last, float gradient,
                        std::int32_t from, int step_bits) {
        for (int n = 0; n < kCells; ++n) {
            outside[n] = hn::Or(hn::Sub(at, hn::Set(kI, first)), hn::Sub(hn::Set(kI, last), at));
            const VI d = hn::Add(hn::Set(kI, from), hn::ShiftLeftSame(at, step_bits));
            term[n] = hn::Mul(hn::Set(kF, gradient), hn::ConvertTo(kF, d));
            at = hn::Add(at, hn::Set(kI, Tile::kCellSide));
        }
    }
};

// The samples from `first` on in each cell of a block. Beyond the box an edge that was settled for
// the box says nothing, so the block's own borders are asked, too.
void draw_part(Painter& painter, const Block& b, std::size_t first) {
    constexpr std::int32_t kSide = Tile::kCellSide;
    const Setup& s = painter.setup;
    const GridUnits& grid = painter.input.grid;
    const std::int32_t column0 = b.column0 & -kSide, row0 = b.row0 & -kSide;
    const VI in_cell = hn::Iota(kI, static_cast<std::int32_t>(first));
    const VI i = hn::Add(hn::And(in_cell, hn::Set(kI, kSide - 1)), hn::Set(kI, column0));
    const VI j = hn::Add(hn::ShiftRight<Tile::kCellBits>(in_cell), hn::Set(kI, row0));
    Positions<kBlockColumns / kSide> x;
    x.set(i, b.column0, b.column1, s.gradient.gx, grid.position(painter.tile.column) - s.plane.at.x,
          grid.step_bits);
    Positions<kBlockRows / kSide> y;
    y.set(j, b.row0, b.row1, s.gradient.gy, grid.position(painter.tile.row) - s.plane.at.y,
          grid.step_bits);
    VI edge[3];  // at the cell
    for (int k = 0; k < 3; ++k) {
        const Edge& e = s.edges[k];
        edge[k] =
            hn::Add(hn::Set(kI, e.value),
                    hn::Add(hn::Mul(hn::Sub(i, hn::Set(kI, s.column0)), hn::Set(kI, e.per_column)),
                            hn::Mul(hn::Sub(j, hn::Set(kI, s.row0)), hn::Set(kI, e.per_row))));
    }
    const VF z0 = hn::Set(kF, s.gradient.z0);
    VI right[3], below[3];
    for (int k = 0; k < 3; ++k) {
        right[k] = hn::Set(kI, kSide * s.edges[k].per_column);
        below[k] = hn::Set(kI, kSide * s.edges[k].per_row);
    }
    std::size_t row_at = Tile::index(column0, row0) + first;
    for (std::int32_t row = row0, r = 0; row <= b.row1; row += kSide, ++r) {
        VI e[3] = {edge[0], edge[1], edge[2]};
        std::size_t at = row_at;
        for (std::int32_t column = column0, c = 0; column <= b.column1; column += kSide, ++c) {
            const VI any =
                hn::Or(hn::Or(e[0], hn::Or(e[1], e[2])), hn::Or(x.outside[c], y.outside[r]));
            const auto covered = hn::RebindMask(kF, hn::Gt(any, hn::Set(kI, -1)));
            if (!hn::AllFalse(kF, covered)) {
                const VF z = hn::Add(z0, hn::Add(x.term[c], y.term[r]));
                offer_vector(painter,
                             hn::Min(hn::Max(z, hn::Zero(kF)), hn::Set(kF, kStoredDepthMax)),
                             covered, {column, row, first, at});
            }
            for (int k = 0; k < 3; ++k) e[k] = hn::Add(e[k], right[k]);
            at += Tile::kCell;
        }
        for (int k = 0; k < 3; ++k) edge[k] = hn::Add(edge[k], below[k]);
        row_at += Tile::kCellRow;
    }
}

void draw_block(Painter& painter, const Block& b) {
    for (std::size_t first = 0; first < Tile::kCell; first += hn::Lanes(kI))
        draw_part(painter, b, first);
}

void draw_regular(Painter& painter) {
    const Setup& s = painter.setup;
    bool all_hidden = true;
    for (std::int32_t row = s.row0; row <= s.row1; row = (row | (kBlockRows - 1)) + 1)
        for (std::int32_t column = s.column0; column <= s.column1;
             column = (column | (kBlockColumns - 1)) + 1) {
            const Block block{column, std::min(column | (kBlockColumns - 1), s.column1), row,
                              std::min(row | (kBlockRows - 1), s.row1)};
            if (is_excluded(s, block)) continue;
            if (is_hidden(painter, block)) continue;
            all_hidden = false;
            draw_block(painter, block);
        }
    painter.counts.hidden += all_hidden ? 1 : 0;
}

void draw(const RasterInput& input, std::uint32_t k, Tile& tile, TileCounts& counts) {
    Painter painter{input, tile, counts};
    const Outcome outcome = set_up(input.screen, input.grid, tile, k, painter.setup);
    if (outcome == Outcome::empty) return;
    ++counts.triangles;
    ++tile.drawn;
    if (input.observer != nullptr)
        input.observer->step({StepKind::triangle_taken, painter.setup.id, kNone, 0, 0, 0, 0});
    if (outcome == Outcome::regular)
        draw_regular(painter);
    else
        painter.draw_steep();
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw);

bool comes_before(const RasterInput& input, std::uint32_t id, std::uint32_t owner, std::int32_t x,
                  std::int32_t y, TileCounts& counts) {
    if (owner == id) return false;
    const std::uint32_t sheet = input.screen.shared_plane(id);
    if (sheet != kNone && sheet == input.screen.shared_plane(owner)) return id < owner;
    ++counts.exact;
    if (input.observer != nullptr)
        input.observer->step({StepKind::exact_comparison, id, owner, 0, 0, 0, 0});
    const int order = compare_depth(input.screen.plane(id), input.screen.plane(owner), x, y).sign;
    return order != 0 ? order < 0 : id < owner;
}

void draw_large(const RasterInput& input, std::uint32_t triangle, Tile& tile, TileCounts& counts) {
    HWY_DYNAMIC_DISPATCH(draw)(input, triangle, tile, counts);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
