// Tiles on their way to the picture, half a row at a time. Included once for every vector width
// (Google Highway), within HWY_NAMESPACE.
//
// A core waits for memory when it writes a whole tile past the caches; a few cache lines between
// two triangles cost it nothing.
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

inline HWY_NOINLINE void write_half_row(TileWriter& writer, PendingRows& rows) {
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

HWY_INLINE void write_some(TileWriter& writer, int half_rows) {
    for (int k = 0; k < half_rows; ++k)
        if (PendingRows* rows = writer.pending()) write_half_row(writer, *rows);
}

inline void write_all(TileWriter& writer) {
    while (PendingRows* rows = writer.pending()) write_half_row(writer, *rows);
    hwy::FlushStream();
}

inline void write_drawn(TileWriter& writer) {
    while (writer.drawn.next != writer.drawn.end) write_half_row(writer, writer.drawn);
}

}  // namespace
}  // namespace sightline::zbuffer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
