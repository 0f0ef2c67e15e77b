// Raster stage of the z-buffer, the common case: triangles of a few pixels, a vector of them at a
// time.
//
// Most meshes are made of triangles that own from none to ten samples, so the work is in their
// set-up. Here it is done for as many triangles as a vector has 32-bit lanes: corners are gathered,
// edge functions taken at the corner of each box (all corners lie within 2^14 units of each other,
// so 32 bits hold them exactly), planes in double precision (whose integers are exact below 2^53,
// so these are the quotients of depth_gradient()), and what is empty or hidden is dropped. What is
// left waits and is drawn by shape, cell by cell (zbuffer_cells-inl.hpp). What does not fit (large,
// steep, pieces of clipped triangles) goes to draw_large(). Between triangles a little of the tiles
// drawn before is written to the picture.
#include <algorithm>
#include <bit>
#include <limits>

#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_batch.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#include "visibility/zbuffer_cells-inl.hpp"
#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_write-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

/// After so many triangles, and after each vector of them, a little is written to the picture.
constexpr std::size_t kWriteAfter = 4;

/// Triangles between two updates of the hierarchical depth.
constexpr std::uint32_t kRefreshAfter = 80;

// Reads bins one after the other, a vector of triangles at a time.
class ItemReader {
public:
    explicit ItemReader(std::span<const std::span<const TriangleItem>> bins) : bins_(bins) {}

    // The next triangles, in the first lanes; `wanted` gets these lanes. False at the end.
    HWY_INLINE bool next(const ScreenScene& screen, Triangles& t, M& wanted) {
        const std::size_t lanes = hn::Lanes(kI);
        while (bin_ < bins_.size() && at_ == bins_[bin_].size()) ++bin_, at_ = 0;
        if (bin_ == bins_.size()) return false;
        const TriangleItem* from = bins_[bin_].data() + at_;
        std::size_t n = lanes;
        if (bins_[bin_].size() - at_ >= lanes)
            at_ += lanes;
        else
            from = collect(n);
        const auto* words = reinterpret_cast<const std::uint32_t*>(from);
        hn::Vec<Uints> c0, c1, c2, mark;
        hn::LoadInterleaved4(kU, words, c0, c1, c2, mark);
        t.number = hn::And(hn::BitCast(kI, mark), set(INT32_MAX));
        t.sheet = sheets_of(screen, hn::BitCast(kI, mark));
        t.corner[0] = hn::BitCast(kI, c0);
        t.corner[1] = hn::BitCast(kI, c1);
        t.corner[2] = hn::BitCast(kI, c2);
        for (std::size_t k = 0; k < 3; ++k)
            load_points(screen, words + k, 4, t.x[k], t.y[k], t.z[k]);
        wanted = hn::FirstN(kI, n);
        return true;
    }

private:
    // From several bins. What is left in the lanes beyond are triangles, too, or point 0.
    HWY_NOINLINE const TriangleItem* collect(std::size_t& n) {
        const std::size_t lanes = hn::Lanes(kI);
        for (n = 0; n < lanes && bin_ < bins_.size();) {
            const std::size_t part = std::min(lanes - n, bins_[bin_].size() - at_);
            // A handful: a call would take longer.
            const hn::CappedTag<std::uint32_t, 4> d;
            const auto* from = reinterpret_cast<const std::uint32_t*>(bins_[bin_].data() + at_);
            auto* to = reinterpret_cast<std::uint32_t*>(items_ + n);
            for (std::size_t i = 0; i < 4 * part; i += hn::Lanes(d))
                hn::StoreU(hn::LoadU(d, from + i), d, to + i);
            n += part;
            at_ += part;
            if (at_ == bins_[bin_].size()) ++bin_, at_ = 0;
        }
        return items_;
    }

    std::span<const std::span<const TriangleItem>> bins_;
    std::size_t bin_ = 0, at_ = 0;
    TriangleItem items_[kLanes] = {};
};

class Batch {
public:
    Batch(const RasterInput& input, Tile& tile, TileCounts& counts, TileWriter& writer)
        : input_(input), grid_(input.grid), tile_(tile), counts_(counts), writer_(writer) {}

    // What is known of the depth is brought up to date before the back sides, for closed surfaces
    // hide theirs.
    void draw(const TileBins& bins) {
        dirty_columns_ = dirty_rows_ = set(-1);
        if (tile_.drawn >= kRefreshAfter) refresh_depth();
        draw_bins(bins.front);
        if (bins.back.empty()) return;
        if (tile_.drawn > 0) refresh_depth();
        draw_bins(bins.back);
    }

private:
    // While a vector is worked on, the corners of the next are fetched, for they are scattered over
    // memory.
    void draw_bins(std::span<const std::span<const TriangleItem>> bins) {
        ItemReader reader(bins);
        Triangles vectors[2];  // in turn: a copy would go through memory
        M next_wanted;
        int next = 0;
        bool more = reader.next(input_.screen, vectors[next], next_wanted);
        while (more) {
            const Triangles& now = vectors[next];
            const M wanted = next_wanted;
            next = 1 - next;
            more = reader.next(input_.screen, vectors[next], next_wanted);
            draw_vector(now, wanted);
            write_some(writer_);
            if (waiting_.vectors == Waiting::kVectors) draw_waiting();
        }
        draw_waiting();
    }

    HWY_INLINE void draw_vector(const Triangles& t, M wanted) {
        const int step_bits = grid_.step_bits;
        const auto whole_count = static_cast<std::int32_t>(input_.screen.scene().triangle_count());
        const M whole = hn::And(wanted, hn::Lt(t.number, set(whole_count)));
        M held;
        const Boxes b = boxes_in(t, grid_, tile_.area(), held);
        const M small = within(t, kSmallExtent);
        draw_each(t.number, hn::AndNot(hn::And(whole, small), hn::And(wanted, held)));
        M kept = hn::And(hn::And(whole, held), small);
        if (hn::AllFalse(kI, kept)) return;
        const M in_sheet = hn::Gt(t.sheet, set(-1));
        kept = dismiss_hidden(t, b, kept, hn::AndNot(in_sheet, kept));
        const VI doubled = doubled_area(t);
        kept = hn::And(kept, hn::Ne(doubled, set(0)));
        if (hn::AllFalse(kI, kept)) return;
        const VI sx =
            hn::Add(hn::ShiftLeftSame(b.column0, step_bits), set(grid_.position(tile_.column)));
        const VI sy = hn::Add(hn::ShiftLeftSame(b.row0, step_bits), set(grid_.position(tile_.row)));
        const Edges edges = edges_at(t, doubled, sx, sy, step_bits);
        kept = hn::AndNot(excluded(edges, b), kept);
        kept = hn::AndNot(edge_on_lanes(input_.screen, t, doubled, kept), kept);
        if (hn::AllFalse(kI, kept)) return;
        Planes plane = own_planes(t, sx, sy), shared;
        const M served = shared_planes(input_, t.sheet, sx, sy, shared);
        if (!hn::AllFalse(kI, served)) plane = choose(served, shared, plane);
        const DepthRange range = depth_over(plane, b.columns, b.rows, step_bits);
        draw_each(t.number, hn::AndNot(range.regular, kept));
        kept = hn::And(kept, range.regular);
        if (!hn::AllFalse(kI, hn::And(in_sheet, kept)))
            kept = dismiss(b, range.least, kept, hn::And(in_sheet, kept));
        if (hn::AllFalse(kI, kept)) return;
        note_drawn(b, kept);
        waiting_.add(t.number, b, edges, plane, step_bits, kept, range.inside);
    }

    // Lanes where an edge has all of the box on its outer side.
    static HWY_INLINE M excluded(const Edges& edges, const Boxes& b) {
        const VI zero = set(0);
        VI worst = zero;  // negative where one has
        for (int k = 0; k < 3; ++k) {
            const VI across = hn::Max(zero, hn::Mul(edges.per_column[k], b.columns));
            const VI down = hn::Max(zero, hn::Mul(edges.per_row[k], b.rows));
            worst = hn::Or(worst, hn::Add(edges.at[k], hn::Add(across, down)));
        }
        return hn::Lt(worst, zero);
    }

    // The greatest depth that the tile holds under each box.
    HWY_INLINE VF depth_behind(const Boxes& b, M kept) const {
        constexpr int kBits = Tile::kBlockBits;
        const VI c0 = hn::ShiftRight<kBits>(b.column0), r0 = hn::ShiftRight<kBits>(b.row0);
        const VI c1 = hn::ShiftRight<kBits>(hn::Add(b.column0, b.columns));
        const VI r1 = hn::ShiftRight<kBits>(hn::Add(b.row0, b.rows));
        // The boxes of other lanes may lie anywhere.
        const M adjacent = hn::Lt(hn::Max(hn::Sub(c1, c0), hn::Sub(r1, r0)), set(2));
        const M near_by = hn::And(kept, adjacent);
        const auto at = [&](VI c, VI r) HWY_ATTR {
            const VI block = hn::Add(hn::Mul(r, set(Tile::kBlocks)), c);
            return hn::GatherIndex(kF, tile_.block_max, hn::IfThenElseZero(near_by, block));
        };
        const VF most = hn::Max(hn::Max(at(c0, r0), at(c1, r0)), hn::Max(at(c0, r1), at(c1, r1)));
        return hn::IfThenElse(hn::RebindMask(kF, near_by), most, hn::Set(kF, tile_.tile_max));
    }

    // Takes from `kept` the lanes of `asked` whose nearest depth is behind what the tile holds.
    HWY_INLINE M dismiss(const Boxes& b, VF nearest, M kept, M asked) {
        if (!tile_.knows_depth) return kept;
        const VF depth = hn::Sub(nearest, hn::Set(kF, kUncertain));
        const M hidden = hn::And(asked, hn::RebindMask(kI, hn::Gt(depth, depth_behind(b, kept))));
        const auto count = static_cast<std::uint64_t>(hn::CountTrue(kI, hidden));
        counts_.triangles += count;
        counts_.hidden += count;
        return hn::AndNot(hidden, kept);
    }

    // Hidden triangles, told by their nearest corner before planes are set up: no sample's true
    // depth is less. The conversion of z is off by at most 32, a stored depth by
    // kStoredDepthError, the difference by 64. Sheets' planes do not pass through the corners.
    static_assert(kUncertain - 64 - 32 > kStoredDepthError);
    HWY_INLINE M dismiss_hidden(const Triangles& t, const Boxes& b, M kept, M asked) {
        return dismiss(b, hn::ConvertTo(kF, least(t.z)), kept, asked);
    }

    // Which blocks will have to be looked at again, as columns and rows of blocks: bits.
    HWY_INLINE void note_drawn(const Boxes& b, M kept) {
        // The boxes of other lanes may lie anywhere.
        const auto block = [&](VI at) HWY_ATTR {
            return hn::ShiftRight<Tile::kBlockBits>(hn::IfThenElseZero(kept, at));
        };
        const auto bits = [&](VI first, VI further) HWY_ATTR {
            const VI begin = hn::Shl(set(1), block(first));
            const VI end = hn::Shl(set(2), block(hn::Add(first, further)));
            return hn::IfThenElseZero(kept, hn::Sub(end, begin));
        };
        dirty_columns_ = hn::Or(dirty_columns_, bits(b.column0, b.columns));
        dirty_rows_ = hn::Or(dirty_rows_, bits(b.row0, b.rows));
        const auto n = static_cast<std::uint32_t>(hn::CountTrue(kI, kept));
        counts_.triangles += n;
        tile_.drawn += n;
    }

    void draw_each(VI number, M chosen) {
        if (HWY_LIKELY(hn::AllFalse(kI, chosen))) return;
        HWY_ALIGN std::int32_t numbers[kLanes];
        hn::Store(number, kI, numbers);
        dirty_columns_ = dirty_rows_ = set(-1);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1)
            draw_large(input_, static_cast<std::uint32_t>(numbers[std::countr_zero(rest)]), tile_,
                       counts_);
    }

    void draw_waiting() {
        draw_slots<2, 2>(Waiting::two_by_two);
        draw_slots<3, 2>(Waiting::three_by_two);
        draw_slots<2, 3>(Waiting::two_by_three);
        draw_slots<3, 3>(Waiting::three_by_three);
        draw_slots<0, 0>(Waiting::other);
        waiting_.vectors = 0;
        if (tile_.drawn >= kRefreshAfter) refresh_depth();
    }

    // Zero columns and rows of cells: any number.
    template <int kColumns, int kRows>
    HWY_INLINE void draw_slots(Waiting::Shape shape) {
        const int step_bits = grid_.step_bits;
        const Spot first = spot_of(0, step_bits);
        for (std::size_t i = 0; i < waiting_.count[shape]; ++i) {
            const auto slot = static_cast<std::size_t>(waiting_.slot[shape][i]);
            bool doubtful = false;
            for (std::size_t part = 0; part < Tile::kCell; part += hn::Lanes(kI)) {
                const Spot spot = part == 0 ? first : spot_of(part, step_bits);
                if constexpr (kColumns == 0)
                    doubtful |= draw_other(waiting_, slot, spot, step_bits, part, tile_);
                else
                    doubtful |=
                        draw_shape<kColumns, kRows>(waiting_, slot, spot, step_bits, part, tile_);
            }
            if (HWY_UNLIKELY(doubtful)) settle(slot);
            if (i % kWriteAfter == 0) write_some(writer_);
        }
        waiting_.count[shape] = 0;
    }

    // Some of the triangle's samples are too close to call for floats: integers decide. What it
    // owns already stays as it is, for taking a minimum twice changes nothing.
    HWY_NOINLINE void settle(std::size_t slot) {
        draw_large(input_, static_cast<std::uint32_t>(waiting_.number[slot]), tile_, counts_);
    }

    static std::uint32_t all_bits(VI v) {
        HWY_ALIGN std::int32_t lanes[kLanes];
        hn::Store(v, kI, lanes);
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < hn::Lanes(kI); ++i)
            bits |= static_cast<std::uint32_t>(lanes[i]);
        return bits;
    }

    // Brings block_max, where something was drawn, and tile_max up to date.
    HWY_NOINLINE void refresh_depth() {
        constexpr std::uint32_t kAll = (1u << Tile::kBlocks) - 1;
        const std::uint32_t columns = all_bits(dirty_columns_) & kAll;
        for (std::uint32_t rows = all_bits(dirty_rows_) & kAll; rows != 0; rows &= rows - 1)
            for (std::uint32_t rest = columns; rest != 0; rest &= rest - 1)
                refresh_block(static_cast<std::uint32_t>(std::countr_zero(rows)),
                              static_cast<std::uint32_t>(std::countr_zero(rest)));
        tile_.tile_max = *std::max_element(std::begin(tile_.block_max), std::end(tile_.block_max));
        dirty_columns_ = dirty_rows_ = set(0);
        tile_.drawn = 0;
        tile_.knows_depth = true;
    }

    HWY_INLINE void refresh_block(std::uint32_t block_row, std::uint32_t block_column) {
        const float* at =
            tile_.depth + Tile::index(static_cast<std::int32_t>(block_column << Tile::kBlockBits),
                                      static_cast<std::int32_t>(block_row << Tile::kBlockBits));
        VF most = hn::Zero(kF);
        for (std::size_t k = 0; k < 2 * Tile::kCell; k += hn::Lanes(kF))
            most =
                hn::Max(most, hn::Max(hn::Load(kF, at + k), hn::Load(kF, at + Tile::kCellRow + k)));
        tile_.block_max[block_row * Tile::kBlocks + block_column] =
            hn::GetLane(hn::MaxOfLanes(kF, most));
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    Tile& tile_;
    TileCounts& counts_;
    TileWriter& writer_;
    VI dirty_columns_ = set(0), dirty_rows_ = set(0);
    Waiting waiting_;
};

void draw_batches(const RasterInput& input, const TileBins& bins, Tile& tile, TileCounts& counts,
                  TileWriter& writer) {
    Batch(input, tile, counts, writer).draw(bins);
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

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(draw_batches);
HWY_EXPORT(clear);
HWY_EXPORT(write_all);
HWY_EXPORT(write_drawn);

void clear_tile(Tile& tile) { HWY_DYNAMIC_DISPATCH(clear)(tile); }

void draw_triangles(const RasterInput& input, const TileBins& bins, Tile& tile, TileCounts& counts,
                    TileWriter& writer) {
    if (input.observer == nullptr) {
        HWY_DYNAMIC_DISPATCH(draw_batches)(input, bins, tile, counts, writer);
        return;
    }
    // A watcher wants to see the steps one by one.
    for (const auto* side : {&bins.front, &bins.back})
        for (const std::span<const TriangleItem> bin : *side)
            for (const TriangleItem& item : bin) draw_large(input, item.number(), tile, counts);
}

void write_rest(TileWriter& writer) { HWY_DYNAMIC_DISPATCH(write_all)(writer); }

void write_drawn_tile(TileWriter& writer) { HWY_DYNAMIC_DISPATCH(write_drawn)(writer); }

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
