// Raster stage of the z-buffer: small triangles, set up, are drawn into the cells of a tile.
// Included once for every vector width (Google Highway), within HWY_NAMESPACE.
//
// A triangle of a few pixels meets two by two or three by three cells of 4 x 4 samples. All cells
// of its box are drawn to without a branch, for whether a sample is covered, or nearer, is
// anybody's guess, and a wrong guess costs as much as a cell. So triangles wait until there are
// some dozens, and are drawn one shape after the other.
#if defined(SIGHTLINE_ZBUFFER_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_ZBUFFER_CELLS_INL
#undef SIGHTLINE_ZBUFFER_CELLS_INL
#else
#define SIGHTLINE_ZBUFFER_CELLS_INL
#endif

#include <hwy/highway.h>

#include <limits>

#include "visibility/compress-inl.hpp"
#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

// Two numbers of 16 bits in one lane.
HWY_INLINE VI pair_of(VI low, VI high) {
    return hn::Or(hn::And(low, set(0xFFFF)), hn::ShiftLeft<16>(high));
}

// low * low + high * high of such pairs.
HWY_INLINE VI dot(VI a, VI b) {
#if HWY_TARGET == HWY_SCALAR
    const auto low = [](VI v) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
    return hn::Add(hn::Mul(low(a), low(b)), hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b)));
#else
    const hn::Repartition<std::int16_t, Ints> shorts;
    VI more = hn::Zero(kI);
    const VI sum = hn::ReorderWidenMulAccumulate(kI, hn::BitCast(shorts, a), hn::BitCast(shorts, b),
                                                 hn::Zero(kI), more);
    return hn::RearrangeToOddPlusEven(sum, more);
#endif
}

/// Small triangles that are set up and wait to be drawn. A slot each; some slots stay empty.
struct Waiting {
    static constexpr std::size_t kVectors = 4, kSlots = kVectors * kLanes;
    /// Other: larger, or reaches the near or the far plane, where depths have to be clamped.
    enum Shape { two_by_two, three_by_two, two_by_three, three_by_three, other, kShapes };

    // Edge functions at the first sample of the first cell; their steps to the next column and row
    // as a pair; their steps to the next cell.
    HWY_ALIGN std::int32_t edge[3][kSlots];
    HWY_ALIGN std::int32_t steps[3][kSlots], right[3][kSlots], below[3][kSlots];
    HWY_ALIGN std::int32_t number[kSlots];
    HWY_ALIGN std::int32_t cell[kSlots];                   ///< index of the first cell in the tile
    HWY_ALIGN std::int32_t columns[kSlots], rows[kSlots];  ///< further cells
    HWY_ALIGN std::int32_t dx[kSlots], dy[kSlots];         ///< from the anchor to that first sample
    HWY_ALIGN float gx[kSlots], gy[kSlots], z0[kSlots];

    std::size_t vectors = 0;
    std::size_t count[kShapes] = {};
    HWY_ALIGN std::int32_t slot[kShapes][kSlots + kLanes];

    /// Precondition: vectors < kVectors.
    HWY_INLINE void add(VI numbers, const Boxes& b, const Edges& edges, const Planes& plane,
                        int step_bits, M chosen, M inside) {
        const std::size_t at = vectors++ * hn::Lanes(kI);
        const VI in = set(Tile::kCellSide - 1);
        const VI x = hn::And(b.column0, in), y = hn::And(b.row0, in);
        const VI in_cell = pair_of(x, y);
        for (int k = 0; k < 3; ++k) {
            const VI pair = pair_of(edges.per_column[k], edges.per_row[k]);
            hn::Store(hn::Sub(edges.at[k], dot(in_cell, pair)), kI, edge[k] + at);
            hn::Store(pair, kI, steps[k] + at);
            hn::Store(hn::ShiftLeft<Tile::kCellBits>(edges.per_column[k]), kI, right[k] + at);
            hn::Store(hn::ShiftLeft<Tile::kCellBits>(edges.per_row[k]), kI, below[k] + at);
        }
        hn::Store(numbers, kI, number + at);
        const VI first_row = hn::ShiftRight<Tile::kCellBits>(b.row0);
        const VI first_column = hn::ShiftRight<Tile::kCellBits>(b.column0);
        static_assert(Tile::kCell == 16);
        hn::Store(hn::Add(hn::Mul(first_row, set(static_cast<std::int32_t>(Tile::kCellRow))),
                          hn::ShiftLeft<4>(first_column)),
                  kI, cell + at);
        hn::Store(hn::Sub(plane.dx, hn::ShiftLeftSame(x, step_bits)), kI, dx + at);
        hn::Store(hn::Sub(plane.dy, hn::ShiftLeftSame(y, step_bits)), kI, dy + at);
        hn::Store(plane.gx, kF, gx + at);
        hn::Store(plane.gy, kF, gy + at);
        hn::Store(plane.z0, kF, z0 + at);
        const VI further = hn::ShiftRight<Tile::kCellBits>(hn::Add(x, b.columns));
        const VI lower = hn::ShiftRight<Tile::kCellBits>(hn::Add(y, b.rows));
        hn::Store(further, kI, columns + at);
        hn::Store(lower, kI, rows + at);
        add_shapes(further, lower, static_cast<std::int32_t>(at), chosen, inside);
    }

private:
    HWY_INLINE void add_shapes(VI further, VI lower, std::int32_t at, M chosen, M inside) {
        const VI slots = hn::Add(hn::Iota(kI, 0), set(at));
        const M wide = hn::Gt(further, set(1)), high = hn::Gt(lower, set(1));
        const M few = hn::Lt(hn::Max(further, lower), set(3));
        const M rest = hn::And(chosen, hn::And(few, inside));
        const auto add = [&](Shape shape, M mask) HWY_ATTR {
            append_lanes(slots, mask, slot[shape] + count[shape]);
            count[shape] += hn::CountTrue(kI, mask);
        };
        add(other, hn::AndNot(rest, chosen));
        add(two_by_two, hn::AndNot(hn::Or(wide, high), rest));
        add(three_by_two, hn::And(rest, hn::AndNot(high, wide)));
        add(two_by_three, hn::And(rest, hn::AndNot(wide, high)));
        add(three_by_three, hn::And(rest, hn::And(wide, high)));
    }
};

// Samples of a cell, a vector of them: column and row as a pair, and in units.
struct Spot {
    VI pair, x, y;
};

HWY_INLINE Spot spot_of(std::size_t first, int step_bits) {
    const VI in_cell = hn::Add(hn::Iota(kI, 0), set(static_cast<std::int32_t>(first)));
    const VI i = hn::And(in_cell, set(Tile::kCellSide - 1));
    const VI j = hn::ShiftRight<Tile::kCellBits>(in_cell);
    return {pair_of(i, j), hn::ShiftLeftSame(i, step_bits), hn::ShiftLeftSame(j, step_bits)};
}

// A triangle in the samples `spot` of cells, from its first cell on.
struct Walk {
    VI e[3], dx, dy;
    VF gx, gy, z0;
    hn::Vec<Uints> id;
    hn::Mask<Floats> doubtful;

    HWY_INLINE Walk(const Waiting& w, std::size_t slot, const Spot& spot) {
        for (int k = 0; k < 3; ++k)
            e[k] = hn::Add(set(w.edge[k][slot]), dot(spot.pair, set(w.steps[k][slot])));
        dx = hn::Add(set(w.dx[slot]), spot.x);
        dy = hn::Add(set(w.dy[slot]), spot.y);
        gx = hn::Set(kF, w.gx[slot]);
        gy = hn::Set(kF, w.gy[slot]);
        z0 = hn::Set(kF, w.z0[slot]);
        id = hn::Set(kU, static_cast<std::uint32_t>(w.number[slot]));
        doubtful = hn::Lt(gx, gx);
    }

    // Samples of a cell outside of the box are outside of the triangle, but for some beyond the
    // picture's or the tile's border, which nobody reads. Whole vectors are stored, not masked
    // ones: the next triangle most likely wants the same samples, and a load that a masked or
    // shifted store overlaps has to wait for it.
    HWY_INLINE void offer(const VI edges[3], VF depth, Tile& tile, std::size_t at) {
        const VF infinity = hn::Set(kF, std::numeric_limits<float>::infinity());
        const M outside = hn::Lt(hn::Or3(edges[0], edges[1], edges[2]), set(0));
        const VF z = hn::IfThenElse(hn::RebindMask(kF, outside), infinity, depth);
        const VF old = hn::Load(kF, tile.depth + at);
        // Infinity less infinity is no number, which compares to nothing.
        const VF behind = hn::Sub(z, old);
        const auto nearer = hn::Lt(behind, hn::Set(kF, -kUncertain));
        doubtful = hn::Or(doubtful, hn::Le(hn::Abs(behind), hn::Set(kF, kUncertain)));
        hn::Store(hn::IfThenElse(nearer, z, old), kF, tile.depth + at);
        const auto owner = hn::Load(kU, tile.ids + at);
        hn::Store(hn::IfThenElse(hn::RebindMask(kU, nearer), id, owner), kU, tile.ids + at);
    }
};

// So many cells, without a branch, of a triangle whose depths need no clamp. Returns whether a
// sample was too close to call.
template <int kColumns, int kRows>
HWY_INLINE bool draw_shape(const Waiting& w, std::size_t slot, const Spot& spot, int step_bits,
                           std::size_t part, Tile& tile) {
    Walk walk(w, slot, spot);
    const std::size_t first = static_cast<std::size_t>(w.cell[slot]) + part;
    VI right[3];
    for (int k = 0; k < 3; ++k) right[k] = set(w.right[k][slot]);
    VF tx[kColumns];
    for (int c = 0; c < kColumns; ++c) {
        const VI dx = hn::Add(walk.dx, set(c * Tile::kCellSide << step_bits));
        tx[c] = hn::Mul(walk.gx, hn::ConvertTo(kF, dx));
    }
    for (int r = 0; r < kRows; ++r) {
        const VI dy = hn::Add(walk.dy, set(r * Tile::kCellSide << step_bits));
        const VF ty = hn::Mul(walk.gy, hn::ConvertTo(kF, dy));
        VI e[3] = {walk.e[0], walk.e[1], walk.e[2]};
        for (int c = 0; c < kColumns; ++c) {
            const std::size_t at = first + static_cast<std::size_t>(r) * Tile::kCellRow +
                                   static_cast<std::size_t>(c) * Tile::kCell;
            walk.offer(e, hn::Add(walk.z0, hn::Add(tx[c], ty)), tile, at);
            if (c + 1 < kColumns)
                for (int k = 0; k < 3; ++k) e[k] = hn::Add(e[k], right[k]);
        }
        if (r + 1 < kRows)
            for (int k = 0; k < 3; ++k) walk.e[k] = hn::Add(walk.e[k], set(w.below[k][slot]));
    }
    return !hn::AllFalse(kF, walk.doubtful);
}

// Any number of cells, of any triangle.
HWY_INLINE bool draw_other(const Waiting& w, std::size_t slot, const Spot& spot, int step_bits,
                           std::size_t part, Tile& tile) {
    Walk walk(w, slot, spot);
    const VI step = set(Tile::kCellSide << step_bits);
    std::size_t at = static_cast<std::size_t>(w.cell[slot]) + part;
    for (std::int32_t r = 0; r <= w.rows[slot]; ++r, at += Tile::kCellRow) {
        VI e[3] = {walk.e[0], walk.e[1], walk.e[2]};
        VI dx = walk.dx;
        const VF ty = hn::Mul(walk.gy, hn::ConvertTo(kF, walk.dy));
        for (std::int32_t c = 0; c <= w.columns[slot]; ++c) {
            const VF tx = hn::Mul(walk.gx, hn::ConvertTo(kF, dx));
            walk.offer(e, stored_depth_of(walk.z0, tx, ty), tile,
                       at + static_cast<std::size_t>(c) * Tile::kCell);
            for (int k = 0; k < 3; ++k) e[k] = hn::Add(e[k], set(w.right[k][slot]));
            dx = hn::Add(dx, step);
        }
        for (int k = 0; k < 3; ++k) walk.e[k] = hn::Add(walk.e[k], set(w.below[k][slot]));
        walk.dy = hn::Add(walk.dy, step);
    }
    return !hn::AllFalse(kF, walk.doubtful);
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
