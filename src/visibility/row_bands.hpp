// What the scan-line algorithms share: triangles bucketed by the row in which they begin, and rows
// resolved in bands that know nothing of one another, so that all cores work and a picture can be
// made band by band without ever standing in memory.
//
// Source of the buckets: C. Wylie, G. Romney, D. Evans, A. Erdahl, "Half-tone perspective drawings
// by computer", 1967. How this version differs: the buckets are made in two steps, first by bands
// of 32 rows and in parallel, then by rows inside of a band when its turn comes.
#pragma once

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/bins.hpp"
#include "visibility/parallel.hpp"
#include "visibility/sampled_plane.hpp"
#include "visibility/scan_edges.hpp"

namespace sightline {

/// Triangles that may cover samples, by band. A triangle stands in every band that it reaches.
class RowBands {
public:
    static constexpr std::int32_t kRows = 32;  ///< of a band

    RowBands(const ScreenScene& screen, const SampleUnits& units, const ResolveOptions& options);

    [[nodiscard]] std::uint32_t count() const { return count_; }

    /// Numbers of the triangles of a band, in the order of the row of the band in which they begin;
    /// starts[r] is the first of row r (kRows + 1 entries).
    void triangles_of(std::uint32_t band, std::vector<std::uint32_t>& numbers,
                      std::vector<std::uint32_t>& starts) const;

private:
    struct Item {
        std::uint32_t number;
        std::uint32_t row;  ///< in the band
    };

    void take_chunk(std::uint32_t chunk, std::uint32_t first, std::uint32_t end);

    const ScreenScene& screen_;
    SampleUnits units_;
    std::uint32_t count_ = 0;
    std::vector<Bins<Item>> chunks_;
};

/// A triangle while rows pass over it.
struct ActiveTriangle {
    RowTriangle rows;
    SampledPlane surface;
    std::int32_t first_column, end_column;  ///< of its box, inside of the picture

    ActiveTriangle(const ScreenScene& screen, const SampleUnits& units, std::uint32_t number,
                   std::int32_t row)
        : ActiveTriangle(screen, screen.corners(number), units, number, row) {}

private:
    ActiveTriangle(const ScreenScene& screen, const Corners& corners, const SampleUnits& units,
                   std::uint32_t number, std::int32_t row);
};

/// Makes a RowSource of a Machine, a ScanMachine that resolves the rows of one band from the top.
/// It is opened for every row of the band, and has
///
///     add(number)      a triangle begins in the open row
///     resolve_row()    called once that row's triangles are added
///     Counts counts    default-constructible, with += and report(options)
template <class Machine>
class RowScanner final : public RowSource {
public:
    RowScanner(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options)
        : screen_(screen),
          units_(grid, screen.subpixel_bits()),
          options_(options),
          bands_(screen, units_, options) {}

    [[nodiscard]] std::uint32_t band_rows() const override { return RowBands::kRows; }

    void resolve_band(std::uint32_t band, std::uint32_t* ids, float* depth) override {
        thread_local std::vector<std::uint32_t> numbers, starts;
        bands_.triangles_of(band, numbers, starts);
        Machine machine(screen_, units_, options_.observer);
        const auto first = static_cast<std::int32_t>(band) * RowBands::kRows;
        const std::int32_t rows = std::min(RowBands::kRows, units_.rows - first);
        const auto width = static_cast<std::size_t>(units_.columns);
        for (std::int32_t r = 0; r < rows; ++r) {
            const auto at = static_cast<std::size_t>(r);
            machine.open_row(first + r, ids + at * width, depth + at * width);
            for (std::uint32_t i = starts[at]; i < starts[at + 1]; ++i) machine.add(numbers[i]);
            machine.resolve_row();
        }
        const std::lock_guard lock(mutex_);
        counts_ += machine.counts;
    }

    void report() override { counts_.report(options_); }

private:
    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    RowBands bands_;
    std::mutex mutex_;
    typename Machine::Counts counts_;
};

}  // namespace sightline
