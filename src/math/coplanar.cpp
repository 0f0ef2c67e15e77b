// Source: the filter is that of orient3d in J. Shewchuk, "Adaptive Precision Floating-Point
// Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997.
//
// How this version differs: what the filter leaves open is decided in integers. Doubles are
// integers times powers of two, so with one common power the determinant is an integer; 256 bits
// hold it unless the numbers are of very different sizes, else it takes as many as it needs.
#include "math/coplanar.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "math/wide_int.hpp"

namespace sightline::math {

namespace {

using Vectors = std::array<glm::dvec3, 3>;

/// Whether the determinant of three vectors, each off by a relative 2^-53, is surely not zero.
bool is_surely_regular(const Vectors& v) {
    constexpr double kUnit = 0x1p-53;
    constexpr double kBound = (7 + 56 * kUnit) * kUnit;
    // Below it products may underflow, and the bound does not count that.
    constexpr double kLeast = 1e-250;
    double det = 0, permanent = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double a = v[0][j] * v[1][k], b = v[0][k] * v[1][j];
        det += v[2][i] * (a - b);
        permanent += std::abs(v[2][i]) * (std::abs(a) + std::abs(b));
    }
    return permanent > kLeast && std::abs(det) > kBound * permanent;
}

template <class Int>
bool vanishes(const std::array<std::array<Int, 3>, 3>& v) {
    Int det = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        det += v[2][i] * Int(v[0][j] * v[1][k] - v[0][k] * v[1][j]);
    }
    return det == 0;
}

/// The powers of two between which all bits of a vector's numbers lie.
struct BitRange {
    int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();

    void include(const glm::dvec3& v) {
        for (int k = 0; k < 3; ++k) {
            if (v[k] == 0) continue;
            const int exponent = std::ilogb(v[k]);
            lowest = std::min(lowest, std::max(exponent - 52, -1074));
            highest = std::max(highest, exponent + 1);
        }
    }
    [[nodiscard]] int bits() const { return lowest > highest ? 0 : highest - lowest; }
};

/// value / 2^lowest, a whole number.
template <class Int>
Int scaled(double value, int lowest) {
    if (value == 0) return 0;
    int exponent = 0;
    const double mantissa = std::frexp(value, &exponent);
    const Int whole = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    const int shift = exponent - 53 - lowest;
    // Of a subnormal number the last bits are zeros.
    return shift >= 0 ? Int(whole << shift) : Int(whole / (Int(1) << -shift));
}

/// The vectors from points[0] to the two others, and a third one: to[3] - from[3].
struct Question {
    std::array<glm::dvec3, 3> plane;
    glm::dvec3 from, to;
    BitRange ends;  // of from and to

    template <class Int>
    [[nodiscard]] bool answer(const BitRange& corners) const {
        std::array<std::array<Int, 3>, 3> v;
        const auto difference = [](const glm::dvec3& a, const glm::dvec3& b, int lowest) {
            std::array<Int, 3> d;
            for (int k = 0; k < 3; ++k)
                d[static_cast<std::size_t>(k)] =
                    scaled<Int>(b[k], lowest) - scaled<Int>(a[k], lowest);
            return d;
        };
        v[0] = difference(plane[0], plane[1], corners.lowest);
        v[1] = difference(plane[0], plane[2], corners.lowest);
        v[2] = difference(from, to, ends.lowest);
        return vanishes(v);
    }
};

/// Whether to - from is parallel to a plane.
bool decide(const std::array<glm::dvec3, 3>& plane, const glm::dvec3& from, const glm::dvec3& to) {
    if (is_surely_regular({plane[1] - plane[0], plane[2] - plane[0], to - from})) return false;
    BitRange corners;
    Question question{plane, from, to, {}};
    for (const glm::dvec3& corner : plane) corners.include(corner);
    question.ends.include(from);
    question.ends.include(to);
    // A difference has a bit more than its terms; six products of three are summed.
    if (2 * (corners.bits() + 1) + (question.ends.bits() + 1) + 3 < 256)
        return question.answer<Int256>(corners);
    return question.answer<boost::multiprecision::cpp_int>(corners);
}

}  // namespace

bool is_in_plane(const std::array<glm::dvec3, 3>& plane, const glm::dvec3& point) {
    return decide(plane, plane[0], point);
}

bool is_parallel_to_plane(const std::array<glm::dvec3, 3>& plane, const glm::dvec3& direction) {
    return decide(plane, glm::dvec3(0), direction);
}

}  // namespace sightline::math
