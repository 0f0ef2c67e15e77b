// The bound on the work of exhaustive algorithms (see the header).
#include "affordable.hpp"

#include <algorithm>
#include <cstdint>

namespace sightline::cli {
namespace {

constexpr std::uint64_t kExhaustiveWork = std::uint64_t{1} << 38;

}  // namespace

bool is_affordable(const Algorithm& algorithm, const ScreenScene& screen) {
    const SampleGrid grid{screen.resolution(), 1};
    return !algorithm.exhaustive ||
           grid.count() * std::max<std::uint64_t>(screen.triangle_count(), 1) <= kExhaustiveWork;
}

}  // namespace sightline::cli
