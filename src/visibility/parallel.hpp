// Work on all cores, or on one when somebody watches.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>

#include "math/arena.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// body(i) for i in 0 .. n-1, in any order; in ascending order on this thread under an observer.
template <class Body>
void for_each_index(std::uint32_t n, const ResolveOptions& options, const Body& body) {
    if (options.observer != nullptr || options.threads == 1) {
        for (std::uint32_t i = 0; i < n; ++i) body(i);
        return;
    }
    in_arena(options.threads, [&] {
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, n), [&](const auto& range) {
            for (std::uint32_t i = range.begin(); i != range.end(); ++i) body(i);
        });
    });
}

/// Resolves the rows that `out` holds, band by band. Precondition: they begin with a band.
inline void resolve_bands(RowSource& source, const ResolveOptions& options, Visibility& out) {
    const std::uint32_t height = source.band_rows();
    const std::size_t samples = std::size_t{height} * out.grid.columns();
    for_each_index((out.rows() + height - 1) / height, options, [&](std::uint32_t b) {
        source.resolve_band(out.first_row / height + b, out.ids.data() + b * samples,
                            out.depth.data() + b * samples);
    });
}

}  // namespace sightline
