// Elementary functions that give the same bits on every machine.
//
// The C library's sin, pow, exp and log differ between machines (with and without fused
// multiply-add, from version to version), so nothing that decides an output may call them. These
// are built on + - * /, square root, std::fmod and std::floor (both exact by definition) and on
// the bits of a double; the project is compiled without contraction. All are pure functions and
// may be called from any thread. Bounds of error are in units in the last place of the result.
#pragma once

namespace sightline::math {

/// Sine, cosine and tangent of an angle in degrees, of any size. The angle is reduced exactly, so
/// the results are exact wherever the true value is a double: sin 30 = 0.5, cos 90 = 0,
/// tan 45 = 1. Within 1 ulp (tangent: 3). NaN for an angle that is not finite; the tangent's poles
/// are infinities (positive at 90, negative at 270).
[[nodiscard]] double sin_degrees(double degrees);
[[nodiscard]] double cos_degrees(double degrees);
[[nodiscard]] double tan_degrees(double degrees);

/// Angle in [0, 180] degrees whose cosine is `cosine`; exact at -1, -0.5, 0, 0.5 and 1, within
/// 4 ulp elsewhere. NaN outside [-1, 1].
[[nodiscard]] double acos_degrees(double cosine);

/// Logarithm to the base 2, within 4 ulp and exact at powers of two. -infinity at 0, NaN below.
[[nodiscard]] double log2(double x);

/// 2 to the power of x, within 2 ulp and exact at whole x; overflows to infinity, underflows
/// gradually to 0.
[[nodiscard]] double exp2(double x);

/// `base` to the power of `exponent`, rounded to float from a double that is good to 2^-40.
/// Preconditions: 0 <= base <= 1, exponent >= 0. pow_positive(0, 0) is 1.
[[nodiscard]] float pow_positive(float base, float exponent);

}  // namespace sightline::math
