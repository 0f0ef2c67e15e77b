// The table of algorithms. The command line, `sightline algorithms`, the documentation and the
// agreement tests read it: a new algorithm is one file and one row.
#include <array>
#include <bit>

#include "sightline/visibility.hpp"
#include "visibility/algorithms.hpp"

namespace sightline {

namespace {

constexpr std::uint32_t kMaxSamplesPerAxis = 16;
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 28;

constexpr std::array kAlgorithms{
    Algorithm{.name = "zbuffer",
              .title = "z-buffer",
              .citation = "E. Catmull, Computer Display of Curved Surfaces, 1975",
              .help = "keeps the nearest depth of every sample; the default",
              .space = Space::image,
              .exact = true,
              .exhaustive = false,
              .resolve = resolve_zbuffer},
    Algorithm{.name = "brute",
              .title = "brute force",
              .citation = "J. Foley, A. van Dam, S. Feiner, J. Hughes, Computer Graphics, 1990",
              .help = "asks every triangle at every sample, in integers; the oracle of the tests",
              .space = Space::image,
              .exact = true,
              .exhaustive = true,
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

Status resolve(const Algorithm& algorithm, const ScreenScene& screen, const ResolveOptions& options,
               Visibility& out) {
    const std::uint32_t n = options.samples_per_axis;
    if (!std::has_single_bit(n) || n > kMaxSamplesPerAxis ||
        (std::int32_t{1} << screen.subpixel_bits()) < 2 * static_cast<std::int32_t>(n))
        return Error{ErrorKind::bad_option,
                     "samples per axis must be a power of two, at most 16: use 1, 2, 4, 8 or 16"};
    out.grid = {screen.resolution(), n};
    if (out.grid.count() > kMaxSamples)
        return Error{ErrorKind::bad_option,
                     "the picture has more than 2^28 samples: lower the resolution or the samples"};
    out.ids.resize(out.grid.count());
    out.depth.resize(out.grid.count());
    algorithm.resolve(screen, options, out);
    return success();
}

}  // namespace sightline
