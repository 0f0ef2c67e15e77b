// Tiles on their way to the picture, a little at a time. Included once for every vector width
// (Google Highway), within HWY_NAMESPACE.
//
// A core waits for memory when it writes a whole tile past the caches; a few cache lines between
// some triangles cost it nothing.
#if defined(SIGHTLINE_ZBUFFER_WRITE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_ZBUFFER_WRITE_INL
#undef SIGHTLINE_ZBUFFER_WRITE_INL
#else
#define SIGHTLINE_ZBUFFER_WRITE_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "visibility/zbuffer_lanes-inl.hpp"
#include "visibility/zbuffer_stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::zbuffer::HWY_NAMESPACE {
namespace {

// As many samples of a row as a vector has lanes.
template <class D>
HWY_INLINE hn::Vec<D> load_row(D d, const hn::TFromD<D>* from) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(d) > Tile::kCellSide) {
        const hn::Half<D> half;
        constexpr std::size_t kFurther = hn::MaxLanes(half) / Tile::kCellSide * Tile::kCell;
        return hn::Combine(d, load_row(half, from + kFurther), load_row(half, from));
    }
#endif
    return hn::Load(d, from);
}

// Copies a row. The picture is not read again soon: full lines go past the caches.
template <class D>
HWY_INLINE void write_row(D d, const hn::TFromD<D>* samples, std::int32_t row, std::int32_t n,
                          hn::TFromD<D>* to) {
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
    std::int32_t i = 0;
    if (reinterpret_cast<std::uintptr_t>(to) % (hn::Lanes(d) * sizeof(hn::TFromD<D>)) == 0)
        for (; i + lanes <= n; i += lanes)
            hn::Stream(load_row(d, samples + Tile::index(i, row)), d, to + i);
    for (; i < n; ++i) to[i] = samples[Tile::index(i, row)];
}

// The same with one value.
template <class D>
HWY_INLINE void fill_row(D d, hn::TFromD<D> value, std::size_t n, hn::TFromD<D>* to) {
    const std::size_t lanes = hn::Lanes(d);
    const auto values = hn::Set(d, value);
    std::size_t i = 0;
    if (reinterpret_cast<std::uintptr_t>(to) % (lanes * sizeof(hn::TFromD<D>)) == 0)
        for (; i + lanes <= n; i += lanes) hn::Stream(values, d, to + i);
    std::fill(to + i, to + n, value);
}

inline void write_half_row(TileWriter& writer, PendingRows& rows) {
    const std::int32_t row = rows.next >> 1;
    const std::size_t at =
        rows.at + static_cast<std::size_t>(row) * static_cast<std::size_t>(writer.columns);
    const bool is_depth = (rows.next++ & 1) != 0;
    if (rows.tile == nullptr) {
        if (is_depth)
            fill_row(kF, std::numeric_limits<float>::infinity(), rows.width, writer.depth + at);
        else
            fill_row(kU, kNone, rows.width, writer.ids + at);
        return;
    }
    const auto width = static_cast<std::int32_t>(rows.width);
    if (is_depth)
        write_row(kF, rows.tile->depth, row, width, writer.depth + at);
    else
        write_row(kU, rows.tile->ids, row, width, writer.ids + at);
}

/// Half-rows that are written at a time; as many as the rows of a cell.
inline constexpr std::int32_t kHalfRows = Tile::kCellSide;

// Whether a tile can go cell by cell: all of its rows begin and end with whole vectors.
inline bool goes_by_cells(const TileWriter& writer, const PendingRows& rows) {
    constexpr std::size_t kBytes = kLanes * sizeof(float);
    const auto is_aligned = [](const void* p) {
        return reinterpret_cast<std::uintptr_t>(p) % kBytes == 0;
    };
    return kLanes >= 2 * Tile::kCellSide && rows.tile != nullptr && rows.width % kLanes == 0 &&
           static_cast<std::size_t>(writer.columns) % kLanes == 0 &&
           rows.end % (2 * kHalfRows) == 0 && is_aligned(writer.ids + rows.at) &&
           is_aligned(writer.depth + rows.at);
}

// A row of cells as four rows of the picture, `stride` samples apart.
template <class D>
HWY_INLINE void write_cells(D d, const hn::TFromD<D>* cells, std::size_t width, std::size_t stride,
                            hn::TFromD<D>* to) {
#if HWY_TARGET != HWY_SCALAR
    const std::size_t n = hn::Lanes(d);
    for (std::size_t i = 0; i < width; i += n, cells += 4 * n, to += n) {
        const auto p = hn::Load(d, cells), q = hn::Load(d, cells + n);
        const auto r = hn::Load(d, cells + 2 * n), s = hn::Load(d, cells + 3 * n);
        if constexpr (kLanes == 16) {  // four cells, a row of each in a block: transposed
            const auto swapped = [](auto v) HWY_ATTR { return hn::SwapAdjacentBlocks(v); };
            const auto even0 = hn::OddEvenBlocks(swapped(q), p);
            const auto odd0 = hn::OddEvenBlocks(q, swapped(p));
            const auto even1 = hn::OddEvenBlocks(swapped(s), r);
            const auto odd1 = hn::OddEvenBlocks(s, swapped(r));
            hn::Stream(hn::ConcatLowerLower(d, even1, even0), d, to);
            hn::Stream(hn::ConcatLowerLower(d, odd1, odd0), d, to + stride);
            hn::Stream(hn::ConcatUpperUpper(d, even1, even0), d, to + 2 * stride);
            hn::Stream(hn::ConcatUpperUpper(d, odd1, odd0), d, to + 3 * stride);
        } else {  // two cells, of two vectors each
            hn::Stream(hn::ConcatLowerLower(d, r, p), d, to);
            hn::Stream(hn::ConcatUpperUpper(d, r, p), d, to + stride);
            hn::Stream(hn::ConcatLowerLower(d, s, q), d, to + 2 * stride);
            hn::Stream(hn::ConcatUpperUpper(d, s, q), d, to + 3 * stride);
        }
    }
#else
    (void)d, (void)cells, (void)width, (void)stride, (void)to;  // goes_by_cells() says no
#endif
}

inline void write_cell_row(TileWriter& writer, PendingRows& rows) {
    const std::int32_t step = rows.next / kHalfRows;  // ids, then depths, of a row of cells
    const auto cell_row = static_cast<std::size_t>(step >> 1);
    const auto stride = static_cast<std::size_t>(writer.columns);
    const std::size_t at = rows.at + cell_row * Tile::kCellSide * stride;
    const std::size_t from = cell_row * Tile::kCellRow;
    if ((step & 1) != 0)
        write_cells(kF, rows.tile->depth + from, rows.width, stride, writer.depth + at);
    else
        write_cells(kU, rows.tile->ids + from, rows.width, stride, writer.ids + at);
    rows.next += kHalfRows;
}

inline HWY_NOINLINE void write_rows(TileWriter& writer, PendingRows& rows) {
    if (goes_by_cells(writer, rows)) {
        write_cell_row(writer, rows);
        return;
    }
    for (std::int32_t k = 0; k < kHalfRows && rows.next != rows.end; ++k)
        write_half_row(writer, rows);
}

HWY_INLINE void write_some(TileWriter& writer) {
    if (PendingRows* rows = writer.pending()) write_rows(writer, *rows);
}

inline void write_all(TileWriter& writer) {
    while (PendingRows* rows = writer.pending()) write_rows(writer, *rows);
    hwy::FlushStream();
}

inline void write_drawn(TileWriter& writer) {
    while (writer.drawn.next != writer.drawn.end) write_rows(writer, writer.drawn);
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
