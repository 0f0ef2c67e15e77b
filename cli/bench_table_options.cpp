// Options of `sightline bench --table`, the table of 1974 that stands beside ours, and its numbers
// as text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench_table.hpp"
#include "errors.hpp"
#include "sightline/generate.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view kDefaultSizes = "100,2500,60000,1000000";
constexpr std::size_t kMaxSizes = 12;

/// I. Sutherland, R. Sproull, R. Schumacker, A Characterization of Ten Hidden-Surface Algorithms,
/// 1974, as quoted by J. Foley and A. van Dam: estimated work at three numbers of polygons.
struct Historical {
    std::string_view name;
    std::array<double, 3> work;
};
constexpr std::array<std::uint32_t, 3> kHistoricalSizes = {100, 2500, 60000};
constexpr std::array kHistorical = {Historical{"painter (1974)", {1, 10, 507}},
                                    Historical{"z-buffer (1974)", {54, 54, 54}},
                                    Historical{"Warnock (1974)", {11, 64, 307}}};
constexpr double kHistoricalUnit = 54;  // the z-buffer at 100

std::vector<std::uint32_t> read_sizes(OptionReader& reader) {
    const std::string text(
        reader.arguments().value("--sizes").value_or(std::string(kDefaultSizes)));
    std::vector<std::uint32_t> sizes;
    for (const std::string_view item : split_list(text)) {
        const auto size = parse_count(item);
        if (!size || *size == 0 || *size > kMaxGeneratedTriangles) {
            reader.fail(
                wrong_use("--sizes: '{}' is not a number of triangles from 1 to 2^30, as "
                          "in --sizes 100,2500,60000",
                          item));
            return sizes;
        }
        sizes.push_back(static_cast<std::uint32_t>(*size));
    }
    std::sort(sizes.begin(), sizes.end());
    sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
    if (sizes.size() > kMaxSizes) {
        reader.fail(wrong_use("--sizes: more than {} numbers; choose fewer", kMaxSizes));
    }
    return sizes;
}

std::optional<Output> read_svg(OptionReader& reader) {
    const auto path = reader.arguments().value("--output");
    if (!path) return std::nullopt;
    if (!path->ends_with(".svg") && !path->ends_with(".SVG")) {
        reader.fail(
            wrong_use("-o: '{}' does not end in .svg, which is what --table draws; name "
                      "a file like table.svg",
                      *path));
        return std::nullopt;
    }
    Output output{{"-o", *path}};
    check_outputs(reader, {&output, 1}, {});
    check_report(reader, {&output.path, 1});
    return output;
}

/// Options that --table leaves no choice of.
void refuse_others(OptionReader& reader) {
    const Arguments& arguments = reader.arguments();
    if (!arguments.models().empty()) {
        reader.fail(wrong_use("--table makes its own scenes, but '{}' is given; leave one away",
                              arguments.models().front()));
    }
    const auto refuse = [&](std::string_view option) {
        if (!arguments.has(option)) return;
        reader.fail(
            wrong_use("{} has no meaning beside --table, which has its own scenes and "
                      "camera; leave one away",
                      option));
    };
    for (const std::string_view option :
         {"--peers", "--rounds", "--peer-limit", "--algorithm", "--cull", "--subdivide", "--repeat",
          "--repeat-gap", "--farthest-first", "--generate", "--format"}) {
        refuse(option);
    }
    for (const Option& option : kCameraOptions) {
        if (option.name != "--resolution") refuse(option.name);
    }
}

}  // namespace

std::string three_digits(std::optional<double> number) {
    if (!number) return "-";
    return *number >= 100 ? fmt::format("{:.0f}", *number) : fmt::format("{:.3g}", *number);
}

std::string grouped(std::uint64_t number) {
    std::string text = fmt::to_string(number);
    for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
    return text;
}

std::vector<std::string> footnotes(const Table& table) {
    std::vector<std::string> notes;
    if (table.scenes.size() > 1) {
        notes.push_back(
            fmt::format("growth: exponent of the time, from {} triangles to the most that were run",
                        grouped(table.growth_from)));
    }
    notes.emplace_back(
        "1974: estimates of Sutherland, Sproull and Schumacker as quoted by Foley and van Dam");
    notes.insert(notes.end(), table.notes.begin(), table.notes.end());
    return notes;
}

std::optional<TableOptions> read_table(OptionReader& reader) {
    const Arguments& arguments = reader.arguments();
    if (!arguments.has("--table")) {
        for (const std::string_view option : {"--sizes", "--algorithms", "--output"}) {
            if (!arguments.has(option)) continue;
            reader.fail(wrong_use("{} belongs to --table; give that too, or leave it away",
                                  option == "--output" ? "-o" : option));
        }
        return std::nullopt;
    }
    refuse_others(reader);
    TableOptions options;
    options.sizes = read_sizes(reader);
    options.named = reader.algorithms("--algorithms");
    options.svg = read_svg(reader);
    return options;
}

std::vector<TableRow> historical_rows(const std::vector<TableScene>& scenes) {
    std::vector<TableRow> rows;
    for (const Historical& historical : kHistorical) {
        TableRow& row = rows.emplace_back();
        row.name = historical.name;
        row.historical = true;
        for (const TableScene& scene : scenes) {
            const auto found =
                std::find(kHistoricalSizes.begin(), kHistoricalSizes.end(), scene.triangles);
            std::optional<double>& ratio = row.ratios.emplace_back();
            if (found == kHistoricalSizes.end()) continue;
            const auto index = static_cast<std::size_t>(found - kHistoricalSizes.begin());
            ratio = historical.work[index] / kHistoricalUnit;
        }
    }
    return rows;
}

}  // namespace sightline::cli
