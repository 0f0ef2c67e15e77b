// Source: M. Dowell, P. Jarratt, "A modified regula falsi method for computing the root of an
// equation", BIT 11, 1971 (the "Illinois" method). How this version differs: whenever three steps
// have not halved the bracket, it is bisected, so that poles, jumps and flat roots end as well; and
// a sign change is a root only when the values there are small against those at the ends.
#include "plot/root.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

namespace sightline {
namespace {

constexpr double kTight = 0x1p-52;     // of the piece: where doubles end
constexpr double kRootSize = 0x1p-10;  // of the values at the ends: what is larger is no root
constexpr int kMaxSteps = 200;         // 3 a halving, 52 halvings, and some to spare

/// A bracket that shrinks, with the values at its ends (or half of them: the Illinois trick).
struct Shrinking {
    double a = 0, b = 1, at_a = 0, at_b = 0;

    [[nodiscard]] double middle() const { return 0.5 * (a + b); }
    [[nodiscard]] double secant() const {
        // Divided first, for values near the largest double.
        const double ratio = at_a / at_b;  // < 0 or not finite
        const double t = (a - ratio * b) / (1 - ratio);
        return t > a && t < b ? t : middle();
    }
    void replace(double t, double value, bool at_start_side, int& last_side) {
        if (at_start_side) {
            a = t;
            at_a = value;
            if (last_side == -1) at_b *= 0.5;
            last_side = -1;
        } else {
            b = t;
            at_b = value;
            if (last_side == 1) at_a *= 0.5;
            last_side = 1;
        }
    }
};

}  // namespace

std::optional<double> find_root(Evaluator& value, const Bracket& bracket, double noise) {
    if (bracket.at_from == 0) return 0.0;
    if (bracket.at_to == 0) return 1.0;
    const bool start_sign = bracket.at_from >= 0;
    const double largest = std::max(std::abs(bracket.at_from), std::abs(bracket.at_to));
    const double exact = largest * kTight, small = std::max(largest * kRootSize, noise);
    Shrinking s{0, 1, bracket.at_from, bracket.at_to};
    double best = 0, at_best = std::abs(bracket.at_from), third_width = 1;
    if (std::abs(bracket.at_to) < at_best) {
        best = 1;
        at_best = std::abs(bracket.at_to);
    }
    int last_side = 0;
    bool bisect = false;
    for (int step = 0; step < kMaxSteps && s.b - s.a > kTight; ++step) {
        const double t = bisect ? s.middle() : s.secant();
        if (t <= s.a || t >= s.b) break;
        const double f = value(bracket.from + t * (bracket.to - bracket.from));
        if (!std::isfinite(f)) return std::nullopt;
        if (std::abs(f) < at_best) {
            best = t;
            at_best = std::abs(f);
        }
        if (at_best <= exact) return best;
        s.replace(t, f, (f >= 0) == start_sign, last_side);
        bisect = false;
        if (step % 3 == 2) {
            bisect = s.b - s.a > 0.5 * third_width;
            third_width = s.b - s.a;
        }
    }
    // Near a pole the ends of the piece can be the best there is; near a root they are not, unless
    // all values are rounding.
    if (at_best <= noise) return best;
    const double f = value(bracket.from + s.middle() * (bracket.to - bracket.from));
    if (!(std::abs(f) <= small)) return std::nullopt;
    return best;
}

double usual_size(Evaluator& value, glm::dvec3 lo, glm::dvec3 hi) {
    constexpr int kSide = 12;
    std::vector<double> sizes;
    for (int k = 0; k < kSide * kSide * kSide; ++k) {
        const glm::ivec3 node(k % kSide, k / kSide % kSide, k / (kSide * kSide));
        // Off the middle and off simple fractions, where values are often 0.
        const glm::dvec3 t =
            (glm::dvec3(node) + glm::dvec3(0.4142, 0.5774, 0.4472)) / double{kSide};
        const double size = std::abs(value(glm::mix(lo, hi, t)));
        if (std::isfinite(size) && size > 0) sizes.push_back(size);
    }
    if (sizes.empty()) return 0;
    const auto quartile = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 4);
    std::ranges::nth_element(sizes, quartile);
    return *quartile;
}

}  // namespace sightline
