// The triangles that a row of samples meets, and the order of x.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "visibility/row_bands.hpp"

namespace sightline {

/// Entries by column: a bucket sort of what a row meets, in O(entries + columns / 64) whatever the
/// order was on the row before. Entries are small numbers, each in one bucket at a time.
class ColumnBuckets {
public:
    /// For columns 0 .. columns, the last of which lies behind the picture.
    explicit ColumnBuckets(std::int32_t columns)
        : first_(static_cast<std::size_t>(columns) + 1),
          filled_(static_cast<std::size_t>(columns) / 64 + 1) {}

    void put(std::int32_t column, std::uint32_t entry) {
        const auto c = static_cast<std::size_t>(column);
        if (entry >= next_.size()) next_.resize(entry + 1);
        std::uint64_t& word = filled_[c / 64];
        const std::uint64_t bit = std::uint64_t{1} << (c % 64);
        next_[entry] = (word & bit) != 0 ? first_[c] : kNone;
        word |= bit;
        first_[c] = entry;
    }

    [[nodiscard]] std::uint32_t next(std::uint32_t entry) const { return next_[entry]; }

    /// visit(column, entry) for each column that is not empty, from the left: entry is the first of
    /// its chain, which next() follows to kNone. Leaves all columns empty.
    template <class Visit>
    void take_all(const Visit& visit) {
        for (std::size_t w = 0; w < filled_.size(); ++w) {
            for (std::uint64_t rest = std::exchange(filled_[w], 0); rest != 0; rest &= rest - 1) {
                const std::size_t c = 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
                visit(static_cast<std::int32_t>(c), first_[c]);
            }
        }
    }

private:
    std::vector<std::uint32_t> first_;  // of each column that is filled
    std::vector<std::uint64_t> filled_;
    std::vector<std::uint32_t> next_;
};

/// Active triangles in slots that stay theirs until they are released. What every row touches
/// stands apart from what a decision needs, each in whole cache lines.
class ActivePool {
public:
    /// The triangle's slot, or kNone when it covers no row from this one on.
    [[nodiscard]] std::uint32_t add(const ScreenScene& screen, const SampleUnits& units,
                                    std::uint32_t number, std::int32_t row) {
        const ActiveTriangle triangle(screen, units, number, row);
        if (triangle.rows.empty()) return kNone;
        const auto fresh = static_cast<std::uint32_t>(rows_.size());
        active_.push_back(free_.empty() ? fresh : free_.back());
        const std::uint32_t slot = active_.back();
        if (slot == fresh) {
            rows_.push_back({triangle.rows});
            planes_.push_back({triangle.surface});
            columns_.push_back({triangle.first_column, triangle.end_column});
            return slot;
        }
        free_.pop_back();
        rows_[slot].rows = triangle.rows;
        planes_[slot].plane = triangle.surface;
        columns_[slot] = {triangle.first_column, triangle.end_column};
        return slot;
    }

    /// All that are active, in no particular order.
    [[nodiscard]] const std::vector<std::uint32_t>& active() const { return active_; }

    /// To the next row; triangles that end here leave.
    void advance(const SampleUnits& units) {
        std::size_t kept = 0;
        for (const std::uint32_t slot : active_) {
            RowTriangle& rows = rows_[slot].rows;
            rows.advance(units);
            if (rows.empty())
                free_.push_back(slot);
            else
                active_[kept++] = slot;
        }
        active_.resize(kept);
    }

    /// Columns of a triangle's box.
    struct Columns {
        std::int32_t first, end;
    };

    [[nodiscard]] const RowTriangle& rows(std::uint32_t slot) const { return rows_[slot].rows; }
    [[nodiscard]] const SampledPlane& plane(std::uint32_t slot) const {
        return planes_[slot].plane;
    }
    [[nodiscard]] Columns columns(std::uint32_t slot) const { return columns_[slot]; }

private:
    struct alignas(64) AlignedRows {
        RowTriangle rows;
    };
    struct alignas(64) AlignedPlane {
        SampledPlane plane;
    };

    std::vector<AlignedRows> rows_;
    std::vector<AlignedPlane> planes_;
    std::vector<Columns> columns_;
    std::vector<std::uint32_t> active_, free_;
};

}  // namespace sightline
