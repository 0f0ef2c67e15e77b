// Raster stage of the z-buffer, the common case: triangles of a few pixels, a vector of them at a
// time.
//
// Most meshes are made of triangles that own from none to ten samples, so the work is in their
// set-up. Here it is done for as many triangles as a vector has 32-bit lanes: corners are gathered,
// edge functions taken at the corner of each box (all corners lie within 2^14 units of each other,
// so 32 bits hold them exactly), planes in double precision (whose integers are exact below 2^53,
// so these are the quotients of depth_gradient()), and what is empty or hidden is dropped.
// Triangles whose box is one sample are then only compared; the others are walked row by row. What
// does not fit (large, steep, pieces of clipped triangles) goes to draw_large().
#include <algorithm>
#include <bit>
#include <limits>

#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_batch.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Ints = hn::CappedTag<std::int32_t, 16>;
using Floats = hn::Rebind<float, Ints>;
using Uints = hn::Rebind<std::uint32_t, Ints>;
#if HWY_TARGET == HWY_SCALAR
using Doubles = hn::Rebind<double, Ints>;
#else
using Doubles = hn::Repartition<double, Ints>;
#endif
using VI = hn::Vec<Ints>;
using VF = hn::Vec<Floats>;
using VD = hn::Vec<Doubles>;
using M = hn::Mask<Ints>;

constexpr Ints kI;
constexpr Floats kF;
constexpr Uints kU;
constexpr Doubles kD;
constexpr std::size_t kLanes = hn::MaxLanes(Ints());

/// Corners within this distance of each other: 32 bits hold their edge functions.
constexpr std::int32_t kSmallExtent = 1 << 14;
/// Triangles between two updates of the hierarchical depth.
constexpr std::uint32_t kRefreshAfter = 48;

HWY_INLINE VI set(std::int32_t value) { return hn::Set(kI, value); }

HWY_INLINE std::uint32_t bits_of(M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kI, mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
}

struct Points {
    VI x[3], y[3], z[3];
};

// An edge function at the first sample of a box, less one where the edge does not own its points,
// divided by the step; and its increments.
struct Edges {
    VI at[3], per_column[3], per_row[3];
};

// Triangles in a tile, in lanes.
struct Lanes {
    VI number;
    VI column0, row0, columns, rows;  // box: first sample, and how many further ones
    Edges edges;
    VF gx, gy, z0;
    VI dx0, dy0;  // from the plane's anchor to the first sample
};

HWY_INLINE Points gather_points(const ScreenScene& screen, VI number) {
    const auto* corners = reinterpret_cast<const std::int32_t*>(screen.scene().triangles.data());
    const VI first = hn::Add(number, hn::Add(number, number));
    Points p;
    for (int k = 0; k < 3; ++k) {
        const VI corner = hn::GatherIndex(kI, corners + k, first);
        p.x[k] = hn::GatherIndex(kI, screen.xs().data(), corner);
        p.y[k] = hn::GatherIndex(kI, screen.ys().data(), corner);
        p.z[k] = hn::GatherIndex(kI, screen.zs().data(), corner);
    }
    return p;
}

HWY_INLINE VI least(const VI v[3]) { return hn::Min(v[0], hn::Min(v[1], v[2])); }
HWY_INLINE VI greatest(const VI v[3]) { return hn::Max(v[0], hn::Max(v[1], v[2])); }

// The box in the tile; returns the lanes where it holds a sample, and which of all are small.
HWY_INLINE M set_boxes(const Points& p, const GridUnits& grid, const Tile& tile, Lanes& t,
                       M& small) {
    const VI x_min = least(p.x), x_max = greatest(p.x), y_min = least(p.y), y_max = greatest(p.y);
    small = hn::And(hn::Lt(hn::Sub(x_max, x_min), set(kSmallExtent)),
                    hn::Lt(hn::Sub(y_max, y_min), set(kSmallExtent)));
    const VI up = set((1 << grid.step_bits) - 1 - grid.offset), down = set(-grid.offset);
    const auto sample = [&](VI v, VI shift, std::int32_t first) {
        return hn::Sub(hn::ShiftRightSame(hn::Add(v, shift), grid.step_bits), set(first));
    };
    t.column0 = hn::Max(sample(x_min, up, tile.column), set(0));
    t.row0 = hn::Max(sample(y_min, up, tile.row), set(0));
    t.columns = hn::Sub(hn::Min(sample(x_max, down, tile.column), set(tile.width - 1)), t.column0);
    t.rows = hn::Sub(hn::Min(sample(y_max, down, tile.row), set(tile.height - 1)), t.row0);
    return hn::And(hn::Gt(t.columns, set(-1)), hn::Gt(t.rows, set(-1)));
}

HWY_INLINE VI doubled_area(const Points& p) {
    return hn::Sub(hn::Mul(hn::Sub(p.x[1], p.x[0]), hn::Sub(p.y[2], p.y[0])),
                   hn::Mul(hn::Sub(p.y[1], p.y[0]), hn::Sub(p.x[2], p.x[0])));
}

// Exchanges the second and third corner where the triangle runs the other way round.
HWY_INLINE void orient(Points& p, M reversed) {
    for (VI* v : {p.x, p.y, p.z}) {
        const VI second = hn::IfThenElse(reversed, v[2], v[1]);
        v[2] = hn::IfThenElse(reversed, v[1], v[2]);
        v[1] = second;
    }
}

// Sets up the edges at sample positions (sx, sy); returns the lanes that no edge excludes.
HWY_INLINE M set_edges(const Points& p, VI sx, VI sy, int step_bits, Lanes& t) {
    const VI zero = set(0);
    M kept = hn::Eq(zero, zero);
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const VI dx = hn::Sub(p.x[next], p.x[k]), dy = hn::Sub(p.y[next], p.y[k]);
        const VI value =
            hn::Sub(hn::Mul(dx, hn::Sub(sy, p.y[k])), hn::Mul(dy, hn::Sub(sx, p.x[k])));
        const M top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
        const VI biased = hn::Sub(value, hn::IfThenElse(top_left, zero, set(1)));
        t.edges.at[k] = hn::ShiftRightSame(biased, step_bits);
        t.edges.per_column[k] = hn::Sub(zero, dy);
        t.edges.per_row[k] = dx;
        const VI most =
            hn::Add(t.edges.at[k], hn::Add(hn::Max(zero, hn::Mul(t.edges.per_column[k], t.columns)),
                                           hn::Max(zero, hn::Mul(dx, t.rows))));
        kept = hn::And(kept, hn::Gt(most, set(-1)));
    }
    return kept;
}

// Gradients of the planes with these edges u, v from the first corner, for as many lanes as a
// vector has doubles.
template <class VInts>
HWY_INLINE void own_gradient(const VInts u[3], const VInts v[3], VD& gx, VD& gy) {
    VD a[3], b[3];
    for (int k = 0; k < 3; ++k) {
        a[k] = hn::PromoteTo(kD, u[k]);
        b[k] = hn::PromoteTo(kD, v[k]);
    }
    const VD na = hn::Sub(hn::Mul(a[2], b[1]), hn::Mul(a[1], b[2]));
    const VD nb = hn::Sub(hn::Mul(a[0], b[2]), hn::Mul(a[2], b[0]));
    const VD nc = hn::Sub(hn::Mul(a[0], b[1]), hn::Mul(a[1], b[0]));
    gx = hn::Div(na, nc);
    gy = hn::Div(nb, nc);
}

HWY_INLINE void set_own_planes(const Points& p, Lanes& t) {
    const VI* axes[3] = {p.x, p.y, p.z};
    VI u[3], v[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = hn::Sub(axes[k][1], axes[k][0]);
        v[k] = hn::Sub(axes[k][2], axes[k][0]);
    }
    t.z0 = hn::ConvertTo(kF, p.z[0]);
#if HWY_TARGET == HWY_SCALAR
    VD gx, gy;
    own_gradient(u, v, gx, gy);
    t.gx = hn::DemoteTo(kF, gx);
    t.gy = hn::DemoteTo(kF, gy);
#else
    // A vector holds half as many doubles.
    using HalfInts = hn::Half<Ints>;
    constexpr hn::Half<Floats> kHalf;
    hn::Vec<HalfInts> u_lo[3], v_lo[3], u_hi[3], v_hi[3];
    for (int k = 0; k < 3; ++k) {
        u_lo[k] = hn::LowerHalf(HalfInts(), u[k]);
        v_lo[k] = hn::LowerHalf(HalfInts(), v[k]);
        u_hi[k] = hn::UpperHalf(HalfInts(), u[k]);
        v_hi[k] = hn::UpperHalf(HalfInts(), v[k]);
    }
    VD gx_lo, gy_lo, gx_hi, gy_hi;
    own_gradient(u_lo, v_lo, gx_lo, gy_lo);
    own_gradient(u_hi, v_hi, gx_hi, gy_hi);
    t.gx = hn::Combine(kF, hn::DemoteTo(kHalf, gx_hi), hn::DemoteTo(kHalf, gx_lo));
    t.gy = hn::Combine(kF, hn::DemoteTo(kHalf, gy_hi), hn::DemoteTo(kHalf, gy_lo));
#endif
}

// Puts the shared plane in place of the own one where a triangle belongs to a sheet.
HWY_INLINE void set_shared_planes(const RasterInput& input, VI sx, VI sy, Lanes& t) {
    if (input.shared.empty()) return;
    static_assert(sizeof(SharedGradient) == 5 * sizeof(float));
    const auto* of_triangle =
        reinterpret_cast<const std::int32_t*>(input.screen.scene().sheets.of_triangle.data());
    const VI sheet = hn::GatherIndex(kI, of_triangle, t.number);
    const M in_sheet = hn::Ne(sheet, set(-1));
    if (hn::AllFalse(kI, in_sheet)) return;
    const VI slot = hn::Mul(hn::IfThenElseZero(in_sheet, sheet), set(5));
    const auto* floats = reinterpret_cast<const float*>(input.shared.data());
    const auto* ints = reinterpret_cast<const std::int32_t*>(input.shared.data());
    const VF gx = hn::GatherIndex(kF, floats, slot);
    const auto shared = hn::And(hn::RebindMask(kF, in_sheet), hn::Eq(gx, gx));  // not NaN
    t.gx = hn::IfThenElse(shared, gx, t.gx);
    t.gy = hn::IfThenElse(shared, hn::GatherIndex(kF, floats + 1, slot), t.gy);
    t.z0 = hn::IfThenElse(shared, hn::GatherIndex(kF, floats + 2, slot), t.z0);
    const M shared_ints = hn::RebindMask(kI, shared);
    t.dx0 = hn::IfThenElse(shared_ints, hn::Sub(sx, hn::GatherIndex(kI, ints + 3, slot)), t.dx0);
    t.dy0 = hn::IfThenElse(shared_ints, hn::Sub(sy, hn::GatherIndex(kI, ints + 4, slot)), t.dy0);
}

// The greatest depth that the tile holds under each box.
HWY_INLINE VF depth_behind(const Tile& tile, const Lanes& t) {
    constexpr int kBits = Tile::kBlockBits;
    const VI c0 = hn::ShiftRight<kBits>(t.column0), r0 = hn::ShiftRight<kBits>(t.row0);
    const VI c1 = hn::ShiftRight<kBits>(hn::Add(t.column0, t.columns));
    const VI r1 = hn::ShiftRight<kBits>(hn::Add(t.row0, t.rows));
    const M near_by = hn::And(hn::Lt(hn::Sub(c1, c0), set(2)), hn::Lt(hn::Sub(r1, r0), set(2)));
    const auto at = [&](VI c, VI r) {
        const VI block = hn::Add(hn::Mul(r, set(Tile::kBlocks)), c);
        return hn::GatherIndex(kF, tile.block_max, hn::IfThenElseZero(near_by, block));
    };
    const VF most = hn::Max(hn::Max(at(c0, r0), at(c1, r0)), hn::Max(at(c0, r1), at(c1, r1)));
    return hn::IfThenElse(hn::RebindMask(kF, near_by), most, hn::Set(kF, tile.tile_max));
}

struct Outcome {
    M regular, large, hidden;
};

// Depth over the box: how far it rises from the anchor decides whether floats will do; its least
// value, at a corner because every operation is monotone, whether anything of it can be seen.
HWY_INLINE Outcome judge_depth(const Tile& tile, const Lanes& t, int step_bits, M kept) {
    const VI dx1 = hn::Add(t.dx0, hn::Mul(t.columns, set(1 << step_bits)));
    const VI dy1 = hn::Add(t.dy0, hn::Mul(t.rows, set(1 << step_bits)));
    const VF tx0 = hn::Mul(t.gx, hn::ConvertTo(kF, t.dx0)),
             tx1 = hn::Mul(t.gx, hn::ConvertTo(kF, dx1));
    const VF ty0 = hn::Mul(t.gy, hn::ConvertTo(kF, t.dy0)),
             ty1 = hn::Mul(t.gy, hn::ConvertTo(kF, dy1));
    const VF rise =
        hn::Add(hn::Max(hn::Abs(tx0), hn::Abs(tx1)), hn::Max(hn::Abs(ty0), hn::Abs(ty1)));
    const M regular = hn::RebindMask(kI, hn::Le(rise, hn::Set(kF, kRegularRise)));
    M hidden = hn::Ne(t.number, t.number);
    if (tile.knows_depth) {
        const VF nearest = hn::Add(t.z0, hn::Add(hn::Min(tx0, tx1), hn::Min(ty0, ty1)));
        hidden = hn::RebindMask(
            kI, hn::Gt(hn::Sub(nearest, hn::Set(kF, kUncertain)), depth_behind(tile, t)));
    }
    const M usable = hn::And(kept, regular);
    return {hn::AndNot(hidden, usable), hn::AndNot(regular, kept), hn::And(hidden, usable)};
}

// What the walk over a box needs, a triangle a lane.
struct Stored {
    HWY_ALIGN std::int32_t edges[9][kLanes];
    HWY_ALIGN std::int32_t number[kLanes], column0[kLanes], row0[kLanes], columns[kLanes],
        rows[kLanes], dx0[kLanes], dy0[kLanes];
    HWY_ALIGN float gx[kLanes], gy[kLanes], z0[kLanes];
};

HWY_INLINE void store(const Lanes& t, Stored& s) {
    for (int k = 0; k < 3; ++k) {
        hn::Store(t.edges.at[k], kI, s.edges[3 * k]);
        hn::Store(t.edges.per_column[k], kI, s.edges[3 * k + 1]);
        hn::Store(t.edges.per_row[k], kI, s.edges[3 * k + 2]);
    }
    hn::Store(t.number, kI, s.number);
    hn::Store(t.column0, kI, s.column0);
    hn::Store(t.row0, kI, s.row0);
    hn::Store(t.columns, kI, s.columns);
    hn::Store(t.rows, kI, s.rows);
    hn::Store(t.dx0, kI, s.dx0);
    hn::Store(t.dy0, kI, s.dy0);
    hn::Store(t.gx, kF, s.gx);
    hn::Store(t.gy, kF, s.gy);
    hn::Store(t.z0, kF, s.z0);
}

class Batch {
public:
    Batch(const RasterInput& input, Tile& tile, TileCounts& counts)
        : input_(input), grid_(input.grid), tile_(tile), counts_(counts) {}

    void draw(std::span<const std::uint32_t> triangles) {
        const std::size_t lanes = hn::Lanes(kI);
        for (std::size_t i = 0; i < triangles.size(); i += lanes) {
            const std::size_t n = std::min(lanes, triangles.size() - i);
            HWY_ALIGN std::uint32_t numbers[kLanes] = {};
            std::copy_n(triangles.data() + i, n, numbers);
            draw_vector(hn::BitCast(kI, hn::Load(kU, numbers)), hn::FirstN(kI, n));
            if (tile_.drawn >= kRefreshAfter) refresh_depth();
        }
    }

private:
    void draw_vector(VI number, M wanted) {
        // Pieces have their corners elsewhere.
        const M whole = hn::And(
            wanted,
            hn::Lt(number, set(static_cast<std::int32_t>(input_.screen.scene().triangle_count()))));
        draw_each(number, hn::AndNot(whole, wanted));
        Lanes t;
        t.number = hn::IfThenElseZero(whole, number);
        Points p = gather_points(input_.screen, t.number);
        M small;
        const M in_tile = hn::And(whole, set_boxes(p, grid_, tile_, t, small));
        draw_each(number, hn::AndNot(small, in_tile));
        M kept = hn::And(in_tile, small);
        if (hn::AllFalse(kI, kept)) return;
        const VI area = doubled_area(p);
        kept = hn::And(kept, hn::Ne(area, set(0)));
        orient(p, hn::Lt(area, set(0)));
        const VI step = set(1 << grid_.step_bits);
        const VI sx = hn::Add(hn::Mul(t.column0, step), set(grid_.position(tile_.column)));
        const VI sy = hn::Add(hn::Mul(t.row0, step), set(grid_.position(tile_.row)));
        kept = hn::And(kept, set_edges(p, sx, sy, grid_.step_bits, t));
        if (hn::AllFalse(kI, kept)) return;
        t.dx0 = hn::Sub(sx, p.x[0]);
        t.dy0 = hn::Sub(sy, p.y[0]);
        set_own_planes(p, t);
        set_shared_planes(input_, sx, sy, t);
        finish_vector(t, judge_depth(tile_, t, grid_.step_bits, kept));
    }

    void finish_vector(const Lanes& t, const Outcome& outcome) {
        const std::uint32_t regular = bits_of(outcome.regular);
        const auto drawn = static_cast<std::uint32_t>(std::popcount(regular));
        const auto hidden = static_cast<std::uint64_t>(std::popcount(bits_of(outcome.hidden)));
        counts_.triangles += drawn + hidden;
        counts_.hidden += hidden;
        tile_.drawn += drawn;
        draw_each(t.number, outcome.large);
        if (regular == 0) return;
        store(t, stored_);
        const M point = hn::Eq(hn::Or(t.columns, t.rows), set(0));
        const std::uint32_t points = bits_of(hn::And(outcome.regular, point));
        for (std::uint32_t rest = points; rest != 0; rest &= rest - 1)
            draw_point(static_cast<std::size_t>(std::countr_zero(rest)));
        for (std::uint32_t rest = regular & ~points; rest != 0; rest &= rest - 1)
            draw_box(static_cast<std::size_t>(std::countr_zero(rest)));
    }

    void draw_each(VI number, M chosen) {
        if (hn::AllFalse(kI, chosen)) return;
        HWY_ALIGN std::int32_t numbers[kLanes];
        hn::Store(number, kI, numbers);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1)
            draw_large(input_, static_cast<std::uint32_t>(numbers[std::countr_zero(rest)]), tile_,
                       counts_);
    }

    // A doubtful sample: integers decide.
    HWY_NOINLINE void settle(std::uint32_t id, float z, std::int32_t column, std::int32_t row) {
        const std::size_t at = Tile::index(column, row);
        if (!comes_before(input_, id, tile_.ids[at], grid_.position(tile_.column + column),
                          grid_.position(tile_.row + row), counts_))
            return;
        tile_.depth[at] = z;
        tile_.ids[at] = id;
    }

    // The box is one sample, and no edge has excluded it: the triangle covers it.
    HWY_INLINE void draw_point(std::size_t lane) {
        const float tx = stored_.gx[lane] * static_cast<float>(stored_.dx0[lane]);
        const float ty = stored_.gy[lane] * static_cast<float>(stored_.dy0[lane]);
        const float z = std::clamp(stored_.z0[lane] + (tx + ty), 0.0f, kStoredDepthMax);
        const std::size_t at = Tile::index(stored_.column0[lane], stored_.row0[lane]);
        const float old = tile_.depth[at];
        const auto id = static_cast<std::uint32_t>(stored_.number[lane]);
        if (z > old + kUncertain) return;
        if (z < old - kUncertain) {
            tile_.depth[at] = z;
            tile_.ids[at] = id;
            return;
        }
        settle(id, z, stored_.column0[lane], stored_.row0[lane]);
    }

    // A vector of columns at a time, all rows.
    HWY_INLINE void draw_box(std::size_t lane) {
        const auto lanes = static_cast<std::int32_t>(hn::Lanes(kI));
        for (std::int32_t from = 0; from <= stored_.columns[lane]; from += lanes)
            draw_columns(lane, from);
    }

    HWY_INLINE void draw_columns(std::size_t lane, std::int32_t from) {
        const std::int32_t step = 1 << grid_.step_bits;
        const VI index = hn::Add(hn::Iota(kI, 0), set(from));
        const auto along = [&](int k) {
            return hn::Add(set(stored_.edges[3 * k][lane]),
                           hn::Mul(index, set(stored_.edges[3 * k + 1][lane])));
        };
        VI e0 = along(0), e1 = along(1), e2 = along(2);
        const VI down0 = set(stored_.edges[2][lane]), down1 = set(stored_.edges[5][lane]),
                 down2 = set(stored_.edges[8][lane]);
        const M in_box = hn::Lt(index, set(stored_.columns[lane] + 1));
        const VI dx = hn::Add(set(stored_.dx0[lane]), hn::Mul(index, set(step)));
        const VF tx = hn::Mul(hn::Set(kF, stored_.gx[lane]), hn::ConvertTo(kF, dx));
        const VF z0 = hn::Set(kF, stored_.z0[lane]), margin = hn::Set(kF, kUncertain);
        const auto id = hn::Set(kU, static_cast<std::uint32_t>(stored_.number[lane]));
        const float gy = stored_.gy[lane];
        std::int32_t dy = stored_.dy0[lane];
        std::int32_t row = stored_.row0[lane];
        const std::int32_t column = stored_.column0[lane] + from;
        std::size_t at = Tile::index(column, row);
        for (const std::int32_t last = row + stored_.rows[lane]; row <= last;
             ++row, at += Tile::kStride, dy += step) {
            const M inside = hn::And(in_box, hn::Gt(hn::Or(e0, hn::Or(e1, e2)), set(-1)));
            const auto covered = hn::RebindMask(kF, inside);
            const VF ty = hn::Set(kF, gy * static_cast<float>(dy));
            const VF z = hn::Min(hn::Max(hn::Add(z0, hn::Add(tx, ty)), hn::Zero(kF)),
                                 hn::Set(kF, kStoredDepthMax));
            const VF old = hn::LoadU(kF, tile_.depth + at);
            const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, margin)));
            const auto doubtful =
                hn::AndNot(nearer, hn::And(covered, hn::Le(z, hn::Add(old, margin))));
            hn::BlendedStore(z, nearer, kF, tile_.depth + at);
            hn::BlendedStore(id, hn::RebindMask(kU, nearer), kU, tile_.ids + at);
            if (HWY_UNLIKELY(!hn::AllFalse(kF, doubtful)))
                settle_vector(lane, z, hn::RebindMask(kI, doubtful), column, row);
            e0 = hn::Add(e0, down0);
            e1 = hn::Add(e1, down1);
            e2 = hn::Add(e2, down2);
        }
    }

    HWY_NOINLINE void settle_vector(std::size_t lane, VF z, M doubtful, std::int32_t column,
                                    std::int32_t row) {
        HWY_ALIGN float depths[kLanes];
        hn::Store(z, kF, depths);
        for (std::uint32_t rest = bits_of(doubtful); rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            settle(static_cast<std::uint32_t>(stored_.number[lane]), depths[i], column + i, row);
        }
    }

    // Brings block_max and tile_max up to date.
    void refresh_depth() {
        const auto lanes = static_cast<std::uint32_t>(hn::Lanes(kI));
        tile_.drawn = 0;
        tile_.knows_depth = true;
        VF all = hn::Zero(kF);
        HWY_ALIGN float columns[kTileSize];
        constexpr std::uint32_t kSide = 1u << Tile::kBlockBits;
        for (std::uint32_t r = 0; r < Tile::kBlocks; ++r) {
            for (std::uint32_t c = 0; c < kTileSize; c += lanes) {
                const float* at = tile_.depth + std::size_t{r} * kSide * Tile::kStride + c;
                VF most = hn::LoadU(kF, at);
                for (std::uint32_t k = 1; k < kSide; ++k)
                    most = hn::Max(most, hn::LoadU(kF, at + std::size_t{k} * Tile::kStride));
                hn::Store(most, kF, columns + c);
                all = hn::Max(all, most);
            }
            for (std::uint32_t b = 0; b < Tile::kBlocks; ++b)
                tile_.block_max[r * Tile::kBlocks + b] =
                    *std::max_element(columns + b * kSide, columns + (b + 1) * kSide);
        }
        tile_.tile_max = hn::GetLane(hn::MaxOfLanes(kF, all));
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    Tile& tile_;
    TileCounts& counts_;
    Stored stored_;
};

void draw_batches(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                  TileCounts& counts) {
    Batch(input, tile, counts).draw(triangles);
}

void clear(Tile& tile) {
    const VF empty = hn::Set(kF, std::numeric_limits<float>::infinity());
    const auto none = hn::Set(kU, kNone);
    for (std::size_t i = 0; i < std::size(tile.depth); i += hn::Lanes(kF)) {
        hn::Store(empty, kF, tile.depth + i);
        hn::Store(none, kU, tile.ids + i);
    }
    std::fill(std::begin(tile.block_max), std::end(tile.block_max),
              std::numeric_limits<float>::infinity());
    tile.tile_max = std::numeric_limits<float>::infinity();
    tile.knows_depth = false;
    tile.drawn = 0;
}

// Copies a row. The picture is not read again soon: full lines go past the caches.
template <class D>
HWY_INLINE void write_row(D d, const hn::TFromD<D>* from, std::size_t n, hn::TFromD<D>* to) {
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    if (reinterpret_cast<std::uintptr_t>(to) % (lanes * sizeof(hn::TFromD<D>)) == 0)
        for (; i + lanes <= n; i += lanes) hn::Stream(hn::Load(d, from + i), d, to + i);
    std::copy(from + i, from + n, to + i);
}

void write(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    const auto width = static_cast<std::size_t>(tile.width);
    for (std::int32_t row = 0; row < tile.height; ++row) {
        const std::size_t from = Tile::index(0, row);
        const std::size_t to =
            static_cast<std::size_t>(tile.row + row) * static_cast<std::size_t>(grid.columns) +
            static_cast<std::size_t>(tile.column);
        write_row(kU, tile.ids + from, width, ids + to);
        write_row(kF, tile.depth + from, width, depth + to);
    }
    hwy::FlushStream();
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw_batches);
HWY_EXPORT(clear);
HWY_EXPORT(write);

void clear_tile(Tile& tile) { HWY_DYNAMIC_DISPATCH(clear)(tile); }

void draw_triangles(const RasterInput& input, std::span<const std::uint32_t> triangles, Tile& tile,
                    TileCounts& counts) {
    if (input.observer == nullptr) {
        HWY_DYNAMIC_DISPATCH(draw_batches)(input, triangles, tile, counts);
        return;
    }
    // A watcher wants to see the steps one by one.
    for (const std::uint32_t k : triangles) draw_large(input, k, tile, counts);
}

void write_tile(const Tile& tile, const GridUnits& grid, std::uint32_t* ids, float* depth) {
    HWY_DYNAMIC_DISPATCH(write)(tile, grid, ids, depth);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
