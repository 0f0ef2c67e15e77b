// Geometry stage of the z-buffer: which triangles can own a sample, and in which tiles.
//
// One body for every vector width (Google Highway). Corners are gathered for as many triangles as a
// vector has 32-bit lanes; everything is integer arithmetic, so every width gives the same list.
// Tiny triangles are drawn at once (zbuffer_tiny-inl.hpp), the others go to their tiles.
#include "visibility/zbuffer_stages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/zbuffer_geometry.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "visibility/compress-inl.hpp"
#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_tiny-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

HWY_INLINE M drawable_lanes(const std::uint8_t* skip) {
    const hn::Rebind<std::uint8_t, Ints> bytes;
    return hn::Eq(hn::PromoteTo(kI, hn::LoadU(bytes, skip)), set(0));
}

// Whether a triangle shows its back. A float's rounding may get it wrong; nothing but the order of
// drawing depends on it.
HWY_INLINE M shows_back(const Triangles& t) {
    const auto difference = [](VI a, VI b) { return hn::ConvertTo(kF, hn::Sub(a, b)); };
    const VF ab = hn::Mul(difference(t.x[1], t.x[0]), difference(t.y[2], t.y[0]));
    const VF ba = hn::Mul(difference(t.y[1], t.y[0]), difference(t.x[2], t.x[0]));
    return hn::RebindMask(kI, hn::Gt(ab, ba));
}

class Geometry {
public:
    Geometry(const RasterInput& input, const TriangleRange& range, Selected& selected,
             PointBins& points)
        : input_(input),
          grid_(input.grid),
          range_(range),
          selected_(selected),
          up_to_two_(input, selected, points),
          up_to_three_(input, selected, points),
          // Their planes are not those through their corners.
          is_piece_(range.first >= input.screen.scene().triangle_count()),
          are_far_(input.screen.points().size_bytes() > kNear) {}

    void run() {
        static_assert(sizeof(Corners) == 3 * sizeof(std::uint32_t));
        const std::size_t lanes = hn::Lanes(kI), n = range_.corners.size();
        const auto* corners = reinterpret_cast<const std::uint32_t*>(range_.corners.data());
        const std::span<const std::uint32_t> sheets(input_.screen.scene().sheets.of_triangle);
        if (!is_piece_ && !sheets.empty()) sheets_ = sheets.data() + range_.first;
        std::size_t k = 0;
        for (; k + lanes <= n; k += lanes) {
            prefetch_points(corners + 3 * (k + kAhead * lanes), corners + 3 * n);
            const M wanted = range_.skip.empty() ? hn::FirstN(kI, lanes)
                                                 : drawable_lanes(range_.skip.data() + k);
            take(corners + 3 * k, sheets_ == nullptr ? nullptr : sheets_ + k, wanted, k);
        }
        if (k < n) take_tail(corners, k);
        up_to_two_.finish();
        up_to_three_.finish();
    }

private:
    /// Vectors of triangles ahead of which their points are fetched.
    static constexpr std::size_t kAhead = 3;
    /// Fewer bytes of points stay in a core's own cache.
    static constexpr std::size_t kNear = std::size_t{1} << 20;

    HWY_INLINE void prefetch_points(const std::uint32_t* corners, const std::uint32_t* end) const {
        if (!are_far_ || corners + 3 * hn::Lanes(kI) > end) return;
        const ScreenPoint* points = input_.screen.points().data();
        for (std::size_t i = 0; i < 3 * hn::Lanes(kI); ++i) hwy::Prefetch(points + corners[i]);
    }

    // Padded with copies of a triangle that is there.
    void take_tail(const std::uint32_t* corners, std::size_t k) {
        const std::size_t lanes = hn::Lanes(kI), n = range_.corners.size();
        std::uint32_t tail[3 * kLanes], sheets[kLanes];
        std::uint8_t skip[kLanes] = {};
        for (std::size_t i = 0; i < lanes; ++i) {
            const std::size_t from = k + i < n ? k + i : k;
            for (std::size_t c = 0; c < 3; ++c) tail[3 * i + c] = corners[3 * from + c];
            sheets[i] = sheets_ == nullptr ? kNone : sheets_[from];
            skip[i] = k + i >= n || (!range_.skip.empty() && range_.skip[from] != 0) ? 1 : 0;
        }
        take(tail, sheets, drawable_lanes(skip), k);
    }

    // Takes Lanes(kI) triangles.
    HWY_INLINE void take(const std::uint32_t* corners, const std::uint32_t* sheets, M wanted,
                         std::size_t first) {
        hn::Vec<Uints> c0, c1, c2;
        hn::LoadInterleaved3(kU, corners, c0, c1, c2);
        Triangles t;
        t.number = hn::Add(hn::Iota(kI, 0), set(static_cast<std::int32_t>(range_.first + first)));
        t.sheet = sheets == nullptr ? set(-1) : hn::BitCast(kI, hn::LoadU(kU, sheets));
        t.corner[0] = hn::BitCast(kI, c0);
        t.corner[1] = hn::BitCast(kI, c1);
        t.corner[2] = hn::BitCast(kI, c2);
        for (std::size_t k = 0; k < 3; ++k)
            load_points(input_.screen, corners + k, 3, t.x[k], t.y[k], t.z[k]);
        M held;
        const Boxes b = boxes_in(t, grid_, {0, 0, grid_.columns, grid_.rows}, held);
        M kept = hn::And(held, wanted);
        if (hn::AllFalse(kI, kept)) return;
        // Who watches wants to see whole triangles.
        if (!is_piece_ && input_.observer == nullptr) {
            const M tiny = hn::And(kept, tiny_lanes(t, b));
            const M two = hn::Lt(hn::Max(b.columns, b.rows), set(2));
            up_to_two_.add(t, hn::And(tiny, two));
            up_to_three_.add(t, hn::AndNot(two, tiny));
            kept = hn::AndNot(tiny, kept);
            if (hn::AllFalse(kI, kept)) return;
        }
        select(t, b, kept);
    }

    // The borders of the picture cut no tiny box: samples outside of a whole one are not covered.
    // Samples may be so many units apart, on a page, that a triangle with few is not small.
    HWY_INLINE M tiny_lanes(const Triangles& t, const Boxes& b) const {
        const M narrow = within(t, std::min((kTinySide + 1) << grid_.step_bits, kSmallExtent));
        const M few = hn::Lt(hn::Max(b.columns, b.rows), set(kTinySide));
        const M inside = hn::And(hn::Lt(b.column0, set(grid_.columns - kTinySide)),
                                 hn::Lt(b.row0, set(grid_.rows - kTinySide)));
        return hn::And(narrow, hn::And(few, inside));
    }

    HWY_INLINE void select(const Triangles& t, const Boxes& b, M kept) {
        const VI tx = hn::ShiftRight<kTileBits>(b.column0), ty = hn::ShiftRight<kTileBits>(b.row0);
        const VI right = hn::Sub(hn::ShiftRight<kTileBits>(hn::Add(b.column0, b.columns)), tx);
        const VI below = hn::Sub(hn::ShiftRight<kTileBits>(hn::Add(b.row0, b.rows)), ty);
        const VI tiles = set(static_cast<std::int32_t>(grid_.tile_count()));
        const VI tile = hn::Add(hn::Add(hn::Mul(ty, set(grid_.tiles_x)), tx),
                                hn::IfThenElseZero(shows_back(t), tiles));
        selected_.make_room(4 * kLanes);
        const VI mark = marked(t);
        append(mark, tile, kept);
        const M wide = hn::And(kept, hn::Gt(hn::Or(right, below), set(0)));
        if (hn::AllFalse(kI, wide)) return;
        // Few triangles meet more than two by two tiles.
        const M across = hn::And(wide, hn::Gt(right, set(0)));
        const M down = hn::And(wide, hn::Gt(below, set(0)));
        const VI next_row = hn::Add(tile, set(grid_.tiles_x));
        append(mark, hn::Add(tile, set(1)), across);
        append(mark, next_row, down);
        append(mark, hn::Add(next_row, set(1)), hn::And(across, down));
        const M far = hn::And(wide, hn::Gt(hn::Max(right, below), set(1)));
        if (!hn::AllFalse(kI, far)) append_far(mark, tile, right, below, far);
    }

    HWY_INLINE void append(VI mark, VI tile, M chosen) {
        const auto mask = hn::RebindMask(kU, chosen);
        append_lanes(hn::BitCast(kU, mark), mask, selected_.marked.data() + selected_.count);
        append_lanes(hn::BitCast(kU, tile), mask, selected_.tile.data() + selected_.count);
        selected_.count += hn::CountTrue(kI, chosen);
    }

    // The tiles beyond the first two by two.
    HWY_NOINLINE void append_far(VI mark, VI tile, VI right, VI below, M chosen) {
        HWY_ALIGN std::int32_t marks[kLanes], tiles[kLanes], columns[kLanes], rows[kLanes];
        hn::Store(mark, kI, marks);
        hn::Store(tile, kI, tiles);
        hn::Store(right, kI, columns);
        hn::Store(below, kI, rows);
        for (std::uint32_t rest = bits_of(chosen); rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            for (std::int32_t r = 0; r <= rows[i]; ++r)
                for (std::int32_t c = r < 2 ? 2 : 0; c <= columns[i]; ++c)
                    selected_.append(static_cast<std::uint32_t>(marks[i]),
                                     static_cast<std::uint32_t>(tiles[i] + r * grid_.tiles_x + c));
        }
    }

    const RasterInput& input_;
    const GridUnits& grid_;
    const TriangleRange& range_;
    Selected& selected_;
    TinyQueue<2> up_to_two_;
    TinyQueue<3> up_to_three_;
    bool is_piece_, are_far_;
    const std::uint32_t* sheets_ = nullptr;
};

void take(const RasterInput& input, const TriangleRange& range, Selected& selected,
          PointBins& points) {
    Geometry(input, range, selected, points).run();
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::zbuffer {

HWY_EXPORT(take);

void take_triangles(const RasterInput& input, const TriangleRange& range, Selected& selected,
                    PointBins& points) {
    selected.count = 0;
    HWY_DYNAMIC_DISPATCH(take)(input, range, selected, points);
}

}  // namespace sightline::zbuffer
#endif  // HWY_ONCE
