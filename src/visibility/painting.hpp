// Painting: pieces of triangles put over one another in a given order, from back to front, in bands
// of rows that know nothing of one another.
//
// Source: the scan conversion of M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface
// Problem", 1972. A piece is its source triangle with the cuts that bound it: it covers the samples
// that the triangle covers and that lie on its side of each cut. Both sides of a cut are decided by
// the same numbers, so the pieces of a triangle cover each of its samples exactly once.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/bins.hpp"
#include "visibility/over.hpp"
#include "visibility/parallel.hpp"
#include "visibility/sample_box.hpp"
#include "visibility/sample_units.hpp"
#include "visibility/scan_edges.hpp"

namespace sightline {

/// A part of a screen triangle: all of it, or what the cuts `first_cut` .. `end_cut`-1 leave.
struct Piece {
    std::uint32_t triangle = kNone;
    std::uint32_t first_cut = 0, end_cut = 0;
};

/// Hands over pieces in their order. `Cuts` says what a cut is and has
///
///     Stretch narrow(piece, row, stretch) const     what the cuts of the piece leave of it
///     void report(options)                          appends its counters
///
/// for any number of threads. O(pieces) memory for the bins, and O(rows of pieces) time in all.
template <class Cuts>
class PieceLayers final : public LayerSource {
public:
    PieceLayers(const ScreenScene& screen, const SampleGrid& grid, const ResolveOptions& options,
                std::vector<Piece> pieces, Cuts cuts)
        : screen_(screen),
          units_(grid, screen.subpixel_bits()),
          options_(options),
          pieces_(std::move(pieces)),
          cuts_(std::move(cuts)) {
        const auto count = static_cast<std::uint32_t>(pieces_.size());
        chunks_.resize((count + kChunk - 1) / kChunk);
        for_each_index(static_cast<std::uint32_t>(chunks_.size()), options, [&](std::uint32_t c) {
            bin(chunks_[c], c * kChunk, std::min(count, (c + 1) * kChunk));
        });
    }

    [[nodiscard]] std::uint32_t band_rows() const override { return kRows; }

    void visit_band(std::uint32_t band, RunSink& sink) override {
        const std::int32_t first = static_cast<std::int32_t>(band) * kRows;
        const std::int32_t end = std::min(units_.rows, first + kRows);
        for (const Bins<std::uint32_t>& chunk : chunks_)
            for (const std::uint32_t index : chunk.of(band))
                paint(pieces_[index], first, end, sink);
    }

    void report() override { cuts_.report(options_); }

private:
    static constexpr std::int32_t kRows = 32;       // of a band
    static constexpr std::uint32_t kChunk = 16384;  // pieces that one task puts into bands

    void bin(Bins<std::uint32_t>& bins, std::uint32_t first, std::uint32_t end) const {
        const auto bands = static_cast<std::uint32_t>((units_.rows + kRows - 1) / kRows);
        bins.sort(bands, [&](const auto& visit) {
            for (std::uint32_t k = first; k < end; ++k) {
                const SampleBox box = sample_box(screen_, units_, pieces_[k].triangle);
                if (box.empty()) continue;
                for (std::int32_t b = box.top / kRows; b <= (box.bottom - 1) / kRows; ++b)
                    visit(static_cast<std::uint32_t>(b), k);
            }
        });
    }

    void paint(const Piece& piece, std::int32_t first, std::int32_t end, RunSink& sink) const {
        const Corners c = screen_.corners(piece.triangle);
        RowTriangle rows(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z), units_, first);
        const std::uint32_t id = screen_.id(piece.triangle);
        for (; !rows.empty() && rows.row() < end; rows.advance(units_)) {
            Stretch stretch{rows.left(), rows.right()};
            if (stretch.first < stretch.end && piece.first_cut < piece.end_cut)
                stretch = cuts_.narrow(piece, rows.row(), stretch);
            if (stretch.first < stretch.end)
                sink.take({id, rows.row(), stretch.first, stretch.end});
        }
    }

    const ScreenScene& screen_;
    SampleUnits units_;
    ResolveOptions options_;
    std::vector<Piece> pieces_;
    Cuts cuts_;
    std::vector<Bins<std::uint32_t>> chunks_;
};

/// For pieces that are whole triangles.
struct NoCuts {
    [[nodiscard]] Stretch narrow(const Piece& /*piece*/, std::int32_t /*row*/,
                                 Stretch stretch) const {
        return stretch;
    }
    void report(const ResolveOptions& /*options*/) {}
};

/// The ids and depths that painting leaves.
[[nodiscard]] std::unique_ptr<RowSource> open_painted_rows(const ScreenScene& screen,
                                                           const SampleGrid& grid,
                                                           const ResolveOptions& options,
                                                           std::unique_ptr<LayerSource> layers,
                                                           Ties ties);

}  // namespace sightline
