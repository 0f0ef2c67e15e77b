// Where in a box a surface is: the cells of a coarse grid in which the field changes its sign.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "sightline/sections.hpp"

namespace sightline {
namespace {

constexpr int kCells = 64;

glm::dvec3 node(const Box& box, glm::ivec3 at) {
    return box.lo + glm::dvec3(at) / double{kCells} * box.extent();
}

}  // namespace

Box find_extent(const Field& field, const Box& box) {
    const Evaluator value = field.make();
    constexpr int kNodes = kCells + 1;
    std::vector<signed char> last(kNodes * kNodes), here(kNodes * kNodes);
    glm::ivec3 low(kNodes), high(-1);
    for (int k = 0; k < kNodes; ++k) {
        for (int j = 0; j < kNodes; ++j) {
            for (int i = 0; i < kNodes; ++i) {
                const double f = value(node(box, {i, j, k}));
                const auto sign = static_cast<signed char>(std::isfinite(f) ? (f < 0 ? -1 : 1) : 0);
                const std::size_t at = std::size_t(j) * kNodes + std::size_t(i);
                here[at] = sign;
                // Towards each of the three neighbours before it.
                const auto look = [&](bool exists, signed char other, glm::ivec3 step) {
                    if (!exists || other * sign >= 0) return;
                    const glm::ivec3 a(i, j, k);
                    low = glm::min(low, a - step);
                    high = glm::max(high, a);
                };
                look(i > 0, i > 0 ? here[at - 1] : sign, {1, 0, 0});
                look(j > 0, j > 0 ? here[at - kNodes] : sign, {0, 1, 0});
                look(k > 0, last[at], {0, 0, 1});
            }
        }
        last.swap(here);
    }
    if (high.x < 0) return box;
    // A cell more, in which it may round off unseen.
    Box out;
    out.lo = node(box, glm::max(low - 1, glm::ivec3(0)));
    out.hi = node(box, glm::min(high + 1, glm::ivec3(kCells)));
    return out;
}

}  // namespace sightline
