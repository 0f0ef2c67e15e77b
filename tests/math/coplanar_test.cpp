// Coplanar or not: against rational numbers.
#include "math/coplanar.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;
using boost::multiprecision::cpp_rational;

using Triple = std::array<glm::dvec3, 3>;

bool vanishes(const Triple& plane, const glm::dvec3& from, const glm::dvec3& to) {
    std::array<std::array<cpp_rational, 3>, 3> v;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        v[0][i] = cpp_rational(plane[1][k]) - cpp_rational(plane[0][k]);
        v[1][i] = cpp_rational(plane[2][k]) - cpp_rational(plane[0][k]);
        v[2][i] = cpp_rational(to[k]) - cpp_rational(from[k]);
    }
    return v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
               v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
               v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]) ==
           0;
}

// Corners on a lattice, in which a fourth point in the plane is often exact; moved by a last bit in
// every second case; at all sizes that doubles have.
TEST(Coplanar, IsWhatRationalNumbersSay) {
    Random random(5);
    int in_plane = 0, parallel = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const std::uint32_t spread = trial % 4 == 0 ? 900 : 20;
        const int power = static_cast<int>(random.below(2 * spread)) - static_cast<int>(spread);
        const double size = std::ldexp(1.0, power);
        const auto lattice = [&] {
            return glm::dvec3(static_cast<double>(random.below(9)) - 4,
                              static_cast<double>(random.below(9)) - 4,
                              static_cast<double>(random.below(9)) - 4);
        };
        const Triple corners{lattice(), lattice(), lattice()};
        const double s = static_cast<double>(random.below(7)) - 3;
        const double t = static_cast<double>(random.below(7)) - 3;
        glm::dvec3 direction = s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
        glm::dvec3 point = corners[0] + direction;
        const int axis = static_cast<int>(random.below(3));
        if (random.chance(0.5)) point[axis] = std::nextafter(point[axis], 1e300);
        if (random.chance(0.5)) direction[axis] = std::nextafter(direction[axis], 1e300);
        const Triple plane{size * corners[0], size * corners[1], size * corners[2]};
        point *= size;
        in_plane += math::is_in_plane(plane, point) ? 1 : 0;
        parallel += math::is_parallel_to_plane(plane, direction) ? 1 : 0;
        ASSERT_EQ(math::is_in_plane(plane, point), vanishes(plane, plane[0], point)) << trial;
        ASSERT_EQ(math::is_parallel_to_plane(plane, direction),
                  vanishes(plane, glm::dvec3(0), direction))
            << trial;
    }
    EXPECT_GT(in_plane, 1000);
    EXPECT_LT(in_plane, 3500);
    EXPECT_GT(parallel, 1000);
    EXPECT_LT(parallel, 3500);
}

TEST(Coplanar, NumbersOfVeryDifferentSizes) {
    const Triple plane{glm::dvec3{0, 0, 1e-300}, {1e300, 0, 1e-300}, {0, 1, 1e-300}};
    EXPECT_TRUE(math::is_in_plane(plane, {5, 7e200, 1e-300}));
    EXPECT_FALSE(math::is_in_plane(plane, {5, 7e200, 1.0000000000000002e-300}));
    EXPECT_TRUE(math::is_parallel_to_plane(plane, {1, 5e-324, 0}));
    EXPECT_FALSE(math::is_parallel_to_plane(plane, {1, 1, 5e-324}));
    EXPECT_TRUE(math::is_in_plane({glm::dvec3(0), glm::dvec3(0), glm::dvec3(0)}, {1, 2, 3}));
}

}  // namespace
}  // namespace sightline
