// `sightline bench --table`: how the time of every algorithm grows with the number of polygons,
// after the table of Sutherland, Sproull and Schumacker.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench_scene.hpp"
#include "outputs.hpp"

namespace sightline::cli {

struct TableOptions {
    CommonOptions common;
    Resolution resolution;
    std::vector<std::uint32_t> sizes;     ///< numbers of triangles, ascending
    std::vector<const Algorithm*> named;  ///< empty: all that the work allows
    unsigned frames = 5;
    double complexity = 4;
    std::optional<Output> svg;
};

/// One generated scene.
struct TableScene {
    std::uint32_t triangles = 0;
    double project_ms = 0;
    double complexity = 0;  ///< measured: see depth_complexity()
    double covered = 0;     ///< share of the samples where something is seen
};

/// One algorithm, or one line of the historical table.
struct TableRow {
    std::string name;
    std::vector<std::optional<double>> ratios;  ///< to the unit, one a scene; empty: not run
    std::vector<std::optional<double>> ms;      ///< medians; empty for historical rows
    std::optional<double> growth;               ///< exponent of the time, see Table::growth_from
    bool historical = false;
};

struct Table {
    std::string title, caption;
    std::string unit;  ///< the algorithm whose time on the first scene is 1
    double unit_ms = 0;
    std::uint32_t growth_from = 0;  ///< triangles from which growth counts, up to the largest run
    std::vector<TableScene> scenes;
    std::vector<TableRow> rows;
    std::vector<std::string> notes;
};

/// Three digits, such as 0.0185, 9.39 and 1234; "-" for nothing.
[[nodiscard]] std::string three_digits(std::optional<double> number);
/// 60,000.
[[nodiscard]] std::string grouped(std::uint64_t number);

/// What stands under the table: the meaning of growth, the source of the historical rows, and what
/// was not run.
[[nodiscard]] std::vector<std::string> footnotes(const Table& table);

/// Reads the options of --table and judges what has no meaning beside it. Nothing where it is
/// absent.
[[nodiscard]] std::optional<TableOptions> read_table(OptionReader& reader);

/// Measures, prints, and writes the picture.
[[nodiscard]] Result<int> run_table(const TableOptions& options);

/// The estimates that Foley and van Dam quote, as far as the scenes have their sizes; z-buffer at
/// 100 = 1.
[[nodiscard]] std::vector<TableRow> historical_rows(const std::vector<TableScene>& scenes);

/// A log-log plot above the table, as one SVG file (bench_plot.cpp).
[[nodiscard]] std::string table_as_svg(const Table& table);

}  // namespace sightline::cli
