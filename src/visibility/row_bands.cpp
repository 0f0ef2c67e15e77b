#include "visibility/row_bands.hpp"

#include "visibility/sample_box.hpp"

namespace sightline {

namespace {

constexpr std::uint32_t kChunk = 8192;  // triangles that one task puts into bands

}  // namespace

RowBands::RowBands(const ScreenScene& screen, const SampleUnits& units,
                   const ResolveOptions& options)
    : screen_(screen),
      units_(units),
      count_(static_cast<std::uint32_t>((units.rows + kRows - 1) / kRows)) {
    const std::uint32_t triangles = screen.triangle_count();
    chunks_.resize((triangles + kChunk - 1) / kChunk);
    for_each_index(static_cast<std::uint32_t>(chunks_.size()), options, [&](std::uint32_t c) {
        take_chunk(c, c * kChunk, std::min(triangles, (c + 1) * kChunk));
    });
}

void RowBands::take_chunk(std::uint32_t chunk, std::uint32_t first, std::uint32_t end) {
    struct Reach {
        std::uint32_t number;
        std::int32_t begin, last;  // rows
    };
    thread_local std::vector<Reach> reaches;
    reaches.clear();
    for (std::uint32_t k = first; k < end; ++k) {
        if (!screen_.drawable(k)) continue;
        const SampleBox box = sample_box(screen_, units_, k);
        if (!box.empty()) reaches.push_back({k, box.top, box.bottom - 1});
    }
    chunks_[chunk].sort(count_, [&](const auto& visit) {
        for (const Reach& reach : reaches) {
            for (std::int32_t band = reach.begin / kRows; band <= reach.last / kRows; ++band) {
                const std::int32_t row = std::max(reach.begin - band * kRows, 0);
                visit(static_cast<std::uint32_t>(band),
                      Item{reach.number, static_cast<std::uint32_t>(row)});
            }
        }
    });
}

void RowBands::triangles_of(std::uint32_t band, std::vector<std::uint32_t>& numbers,
                            std::vector<std::uint32_t>& starts) const {
    Bins<std::uint32_t> rows;
    rows.sort(kRows, [&](const auto& visit) {
        for (const Bins<Item>& chunk : chunks_)
            for (const Item& item : chunk.of(band)) visit(item.row, item.number);
    });
    numbers = std::move(rows.items);
    starts = std::move(rows.first);
}

ActiveTriangle::ActiveTriangle(const ScreenScene& screen, const Corners& corners,
                               const SampleUnits& units, std::uint32_t number, std::int32_t row)
    : rows(screen.point(corners.x), screen.point(corners.y), screen.point(corners.z), units, row) {
    if (rows.empty()) return;
    surface = sampled_plane_of(screen, units, number);
    const std::int32_t a = screen.point(corners.x).x, b = screen.point(corners.y).x,
                       c = screen.point(corners.z).x;
    first_column = std::max(0, units.first_from(std::min({a, b, c})));
    end_column = std::min(units.columns, units.first_from(std::max({a, b, c})));
}

}  // namespace sightline
