// What the properties of a PLY file's vertices mean to us.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "scene/load/ply_header.hpp"

namespace sightline::load {

struct PlyVertexPlan {
    /// Where the numbers of one vertex go.
    enum Slot : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kAlpha, kOther };
    using Numbers = std::array<float, kOther + 1>;

    struct Entry {
        const PlyProperty* property;  ///< of the element, which must outlive this
        Slot slot;
        float divisor;  ///< makes a colour lie in 0..1
    };
    std::vector<Entry> entries;  ///< one a property
    std::array<bool, kOther + 1> has{};
    bool precise = false;                 ///< x, y or z is of a type that a float can't hold
    std::optional<std::uint64_t> stride;  ///< bytes of a binary vertex, when all have as many

    explicit PlyVertexPlan(const PlyElement& element);

    [[nodiscard]] bool has_all(Slot first, Slot last) const {
        return std::all_of(has.begin() + first, has.begin() + last + 1, [](bool b) { return b; });
    }
};

}  // namespace sightline::load
