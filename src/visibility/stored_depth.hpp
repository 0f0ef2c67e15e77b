// The pieces of stored_depth() that algorithms inline into their loops. Whoever evaluates
//
//     clamp(z0 + (gx * dx + gy * dy), 0, kStoredDepthMax)      dx = x - at.x, dy = y - at.y
//
// in single precision, in this order, where |gx * dx| + |gy * dy| <= kRegularRise, and calls
// stored_depth() elsewhere, has the stored depth to the bit.
//
// Error. With u = 2^-24 and T = |gx dx| + |gy dy| <= 2^30: the gradient is a double quotient
// rounded to float (u, plus 2^-52), dx is exact (|dx| < 2^24), the product rounds (u): each term is
// off by 2.01 u |t|. The sum of the terms adds u T, the conversion of z0 adds u z0, the last
// addition u |z|, where |z| <= z0 + T. Together at most u (4.01 T + 2 z0) <= 2^-24 * 6.01 * 2^30 <
// 385; kStoredDepthError = 400. Clamping is monotone and takes nothing from this.
#pragma once

#include "sightline/screen_scene.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

inline constexpr float kStoredDepthMax = 1073741824.0f;  // 2^30: kDepthMax rounded to float
inline constexpr float kRegularRise = 1073741824.0f;     // T of the derivation above
static_assert(kDepthBits == 30);
static_assert(kStoredDepthError > 0x1p-24 * 6.01 * 0x1p30 + 1);

struct DepthGradient {
    float gx, gy, z0;
};

[[nodiscard]] inline DepthGradient depth_gradient(const Plane& plane) {
    const double c = static_cast<double>(plane.c);
    return {static_cast<float>(static_cast<double>(plane.a) / c),
            static_cast<float>(static_cast<double>(plane.b) / c), static_cast<float>(plane.at.z)};
}

}  // namespace sightline
