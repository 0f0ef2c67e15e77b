// What the algorithms' files offer to the registry, one function a file, and what they share.
#pragma once

#include <memory>
#include <string_view>

#include "sightline/visibility.hpp"

namespace sightline {

// Each fills out.ids and out.depth, which resolve() has given the size of out.grid.
void resolve_brute(const ScreenScene& screen, const ResolveOptions& options, Visibility& out);
void resolve_zbuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out);
void resolve_abuffer(const ScreenScene& screen, const ResolveOptions& options, Visibility& out);
void resolve_warnock(const ScreenScene& screen, const ResolveOptions& options, Visibility& out);

// The scan-line algorithms make their pictures in bands of rows.
using OpenRows = std::unique_ptr<RowSource>(const ScreenScene& screen, const SampleGrid& grid,
                                            const ResolveOptions& options);
OpenRows open_scanline_zbuffer, open_scanline, open_spans;
// The list-priority algorithms paint layers, in bands as well.
OpenRows open_painter, open_depth_sort, open_bsp;

using OpenLayers = std::unique_ptr<LayerSource>(const ScreenScene& screen, const SampleGrid& grid,
                                                const ResolveOptions& options);
OpenLayers open_depth_sort_layers, open_bsp_layers, open_abuffer_layers;

using OrderPieces = PieceOrder(const ScreenScene& screen, const ResolveOptions& options);
OrderPieces order_by_depth_sort, order_by_bsp, order_by_painter;

/// Adds a counter, when somebody wants them.
inline void count(const ResolveOptions& options, std::string_view name, std::uint64_t value) {
    if (options.counters != nullptr) options.counters->push_back({std::string(name), value});
}

}  // namespace sightline
