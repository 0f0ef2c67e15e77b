// Maps, row by row.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "sightline/screen_scene.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// Maps of the rows that a visibility at the pixels' centres holds, counted from its first one; it
/// may come to hold others. Each `out` has room for a row. Read-only once made, so any number of
/// threads may use it. The scene and the visibility must outlive it.
class RowMaps {
public:
    /// With `smooth` normals are interpolated where the scene has them.
    RowMaps(const ScreenScene& screen, const Visibility& visibility, bool smooth);

    void depth(std::uint32_t y, float* out) const;
    void normals(std::uint32_t y, glm::vec3* out) const;
    void triangles(std::uint32_t y, std::uint32_t* out) const;
    void objects(std::uint32_t y, std::uint32_t* out) const;
    void mask(std::uint32_t y, std::uint8_t* out) const;

private:
    [[nodiscard]] std::span<const std::uint32_t> ids(std::uint32_t y) const;
    template <class T, class Value>
    void values(std::uint32_t y, T background, Value of, T* out) const;

    const ScreenScene& screen_;
    const Visibility& visibility_;
    bool smooth_;
};

}  // namespace sightline
