// The table of algorithms. The command line, `sightline algorithms`, the documentation and the
// agreement tests read it: a new algorithm is one file and one row.
#include <array>
#include <bit>

#include "sightline/bsp.hpp"
#include "sightline/fragments.hpp"
#include "sightline/visibility.hpp"
#include "visibility/algorithms.hpp"
#include "visibility/parallel.hpp"
#include "visibility/piece_order.hpp"
#include "visibility/quadrics.hpp"

namespace sightline {

namespace {

constexpr std::uint32_t kMaxSamplesPerAxis = 16;

/// An algorithm for triangles, with the quadrics offered after it.
template <auto Resolve>
void with_quadrics(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    Resolve(screen, options, out);
    offer_quadrics(screen, options, out);
}

template <OpenRows Open>
std::unique_ptr<RowSource> rows_with_quadrics(const ScreenScene& screen, const SampleGrid& grid,
                                              const ResolveOptions& options) {
    return offer_quadrics(screen, grid, options, Open(screen, grid, options));
}

constexpr std::array kAlgorithms{
    Algorithm{.name = "zbuffer",
              .title = "z-buffer",
              .citation = "E. Catmull, Computer Display of Curved Surfaces, 1975",
              .help = "keeps the nearest depth of every sample; the default",
              .space = Space::image,
              .exact = true,
              .exhaustive = false,
              .quadrics = true,
              .resolve = with_quadrics<resolve_zbuffer>},
    Algorithm{.name = "scanline-zbuffer",
              .title = "scan-line z-buffer",
              .citation = "A. Watt, Fundamentals of Three-Dimensional Computer Graphics, 1989",
              .help = "one row of depth, used again for every row; for pictures of any height",
              .space = Space::image,
              .quadrics = true,
              .open_rows = rows_with_quadrics<open_scanline_zbuffer>},
    Algorithm{.name = "scanline",
              .title = "scan-line",
              .citation = "C. Wylie, G. Romney, D. Evans, A. Erdahl, Half-Tone Perspective "
                          "Drawings by Computer, 1967",
              .help = "active edges in the order of x; decides where surfaces begin, end or cross",
              .space = Space::image,
              .open_rows = open_scanline},
    Algorithm{.name = "spans",
              .title = "spanning scan-line",
              .citation = "G. Watkins, A Real-Time Visible Surface Algorithm, 1970",
              .help = "one decision for each span between the ends of segments of a row",
              .space = Space::image,
              .open_rows = open_spans},
    Algorithm{.name = "warnock",
              .title = "Warnock's subdivision",
              .citation = "J. Warnock, A Hidden Surface Algorithm for Computer Generated Halftone "
                          "Pictures, 1969; J. Blinn, Triage Tables, 1990",
              .help = "divides the picture into quadrants until every one of them is simple",
              .space = Space::image,
              .resolve = resolve_warnock},
    Algorithm{.name = "depth-sort",
              .title = "depth sort",
              .citation = "M. Newell, R. Newell, T. Sancha, A Solution to the Hidden Surface "
                          "Problem, 1972",
              .help = "orders polygons from back to front, and splits those that cross; blends",
              .space = Space::list_priority,
              .open_rows = open_depth_sort,
              .open_layers = open_depth_sort_layers,
              .order = order_by_depth_sort},
    Algorithm{.name = kTreeAlgorithm,
              .title = "binary space partition",
              .citation =
                  "H. Fuchs, Z. Kedem, B. Naylor, On Visible Surface Generation by A Priori "
                  "Tree Structures, 1980",
              .help = "a tree of planes, built once, orders the surfaces for any viewer; blends",
              .space = Space::list_priority,
              .exact = false,
              .open_rows = open_bsp,
              .open_layers = open_bsp_layers,
              .order = order_by_bsp},
    Algorithm{.name = "abuffer",
              .title = "A-buffer",
              .citation = "L. Carpenter, The A-buffer, an Antialiased Hidden Surface Method, 1984",
              .help = "keeps all surfaces of a pixel with their coverage; blends and antialiases",
              .space = Space::image,
              .resolve = resolve_abuffer,
              .open_layers = open_abuffer_layers,
              .open_fragments = open_fragments},
    Algorithm{.name = "painter",
              .title = "painter's algorithm",
              .citation = "M. Newell, R. Newell, T. Sancha, A Solution to the Hidden Surface "
                          "Problem, 1972, its first step",
              .help = "paints by the farthest point; wrong where that does not tell the order",
              .space = Space::list_priority,
              .exact = false,
              .open_rows = open_painter,
              .order = order_by_painter},
    Algorithm{.name = "brute",
              .title = "brute force",
              .citation = "J. Foley, A. van Dam, S. Feiner, J. Hughes, Computer Graphics, 1990",
              .help = "asks every triangle at every sample, in integers; the oracle of the tests",
              .space = Space::image,
              .exact = true,
              .exhaustive = true,
              .quadrics = true,
              .resolve = resolve_brute},
};

}  // namespace

std::span<const Algorithm> algorithms() { return kAlgorithms; }

const Algorithm* find_algorithm(std::string_view name) {
    for (const Algorithm& algorithm : kAlgorithms)
        if (algorithm.name == name) return &algorithm;
    return nullptr;
}

const Algorithm& default_algorithm() {
    for (const Algorithm& algorithm : kAlgorithms)
        if (algorithm.exact && !algorithm.exhaustive) return algorithm;
    return kAlgorithms.front();
}

namespace {

Status check_samples(const ScreenScene& screen, std::uint32_t n) {
    if (std::has_single_bit(n) && n <= kMaxSamplesPerAxis &&
        (std::int32_t{1} << screen.subpixel_bits()) >= 2 * static_cast<std::int32_t>(n))
        return success();
    return Error{ErrorKind::bad_option,
                 "samples per axis must be a power of two, at most 16: use 1, 2, 4, 8 or 16"};
}

Status check_surfaces(const Algorithm& algorithm, const ScreenScene& screen) {
    if (algorithm.quadrics || screen.quadrics().rays.empty()) return success();
    return Error{ErrorKind::bad_option, std::string(algorithm.name) +
                                            " takes triangles only: tessellate the quadrics, or "
                                            "use zbuffer"};
}

Status check(const Algorithm& algorithm, const ScreenScene& screen, const ResolveOptions& options) {
    if (Status valid = check_samples(screen, options.samples_per_axis); !valid) return valid;
    return check_surfaces(algorithm, screen);
}

}  // namespace

Result<std::unique_ptr<RowSource>> open_rows(const Algorithm& algorithm, const ScreenScene& screen,
                                             const ResolveOptions& options) {
    if (Status valid = check(algorithm, screen, options); !valid) return valid.error();
    if (algorithm.open_rows == nullptr)
        return Error{ErrorKind::bad_option,
                     std::string(algorithm.name) + " needs the whole picture in memory"};
    return algorithm.open_rows(screen, {screen.resolution(), options.samples_per_axis}, options);
}

Result<std::unique_ptr<LayerSource>> open_layers(const Algorithm& algorithm,
                                                 const ScreenScene& screen,
                                                 const ResolveOptions& options) {
    if (Status valid = check(algorithm, screen, options); !valid) return valid.error();
    if (algorithm.open_layers == nullptr)
        return Error{ErrorKind::bad_option,
                     std::string(algorithm.name) + " does not find the order of all surfaces"};
    return algorithm.open_layers(screen, {screen.resolution(), options.samples_per_axis}, options);
}

bool sees_anything(const Visibility& visibility) {
    return std::ranges::any_of(visibility.ids, [](std::uint32_t id) { return id != kNone; });
}

Status resolve(const Algorithm& algorithm, const ScreenScene& screen, const ResolveOptions& options,
               Visibility& out) {
    if (Status valid = check(algorithm, screen, options); !valid) return valid;
    out.grid = {screen.resolution(), options.samples_per_axis};
    if (out.grid.count() > kMaxSamples)
        return Error{ErrorKind::bad_option,
                     "the picture has more than 2^28 samples: lower the resolution or the samples"};
    out.ids.resize(out.grid.count());
    out.depth.resize(out.grid.count());
    out.first_row = 0;
    if (algorithm.resolve != nullptr) {
        algorithm.resolve(screen, options, out);
        return success();
    }
    const auto rows = algorithm.open_rows(screen, out.grid, options);
    resolve_bands(*rows, options, out);
    rows->report();
    return success();
}

}  // namespace sightline
