// A staircase of boxes, anywhere, in every format that has a reader of our own.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::testing {

/// Six steps, 3 wide and 3 deep. Coordinates are multiples of 1/16 beside `origin`.
inline std::vector<glm::dvec3> stairs_at(glm::dvec3 origin) {
    std::vector<glm::dvec3> corners;
    for (int step = 0; step < 6; ++step) {
        const glm::dvec3 lo(0, 0.1875 * step, 0.3125 * step), hi(3, 0.1875 * (step + 1), 3);
        for (const double z : {lo.z, hi.z})
            for (const auto& [x, y] : {std::array{lo.x, lo.y}, std::array{hi.x, lo.y},
                                       std::array{hi.x, hi.y}, std::array{lo.x, hi.y}})
                corners.push_back(origin + glm::dvec3(x, y, z));
    }
    return corners;
}

/// The sides of a box with the corners of stairs_at(), fronts outside.
inline constexpr std::array<std::array<unsigned, 4>, 6> kSidesOfBox = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}}};

inline std::string as_obj(const std::vector<glm::dvec3>& corners) {
    std::string text;
    for (const glm::dvec3& p : corners) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (std::size_t box = 0; box < corners.size(); box += 8)
        for (const auto& [a, b, c, d] : kSidesOfBox)
            text +=
                fmt::format("f {} {} {} {}\n", box + a + 1, box + b + 1, box + c + 1, box + d + 1);
    return text;
}

inline std::string as_stl(const std::vector<glm::dvec3>& corners) {
    std::string text = "solid stairs\n";
    for (std::size_t box = 0; box < corners.size(); box += 8)
        for (const auto& side : kSidesOfBox) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const unsigned k : side) {
                const glm::dvec3& p = corners[box + k];
                text += fmt::format("vertex {} {} {}\n", p.x, p.y, p.z);
            }
            text += "endloop\nendfacet\n";
        }
    return text + "endsolid stairs\n";
}

template <class T>
std::string stored(double value, bool big_endian) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
    if (big_endian) std::ranges::reverse(bytes);
    return {bytes.data(), bytes.size()};
}

/// `format` as in the header; of `Real` numbers: float or double.
template <class Real>
std::string as_ply(const std::vector<glm::dvec3>& corners, const std::string& format) {
    const std::string type = sizeof(Real) == sizeof(float) ? "float" : "double";
    std::string file = fmt::format(
        "ply\nformat {0} 1.0\nelement vertex {2}\nproperty {1} x\nproperty {1} y\nproperty {1} z\n"
        "element face {3}\nproperty list uchar int vertex_indices\nend_header\n",
        format, type, corners.size(), corners.size() / 8 * 6);
    const bool text = format == "ascii", big = format == "binary_big_endian";
    for (const glm::dvec3& p : corners)
        for (int axis = 0; axis < 3; ++axis)
            file += text ? fmt::format("{} ", p[axis]) : stored<Real>(p[axis], big);
    for (std::size_t box = 0; box < corners.size(); box += 8)
        for (const auto& side : kSidesOfBox) {
            file += text ? "4 " : std::string("\4");
            for (const unsigned k : side) {
                const auto index = static_cast<double>(box + k);
                file += text ? fmt::format("{} ", box + k) : stored<std::int32_t>(index, big);
            }
        }
    return file;
}

}  // namespace sightline::testing
