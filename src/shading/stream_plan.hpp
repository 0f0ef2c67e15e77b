// What a StreamPlan knows, for the picture that is made by it.
#pragma once

#include <array>
#include <optional>
#include <utility>

#include "scene/plane_index.hpp"
#include "scene/sheet_joiner.hpp"
#include "sightline/stream.hpp"

namespace sightline {

struct StreamPlan::State {
    // Of the survey.
    Scene frame;
    bool has_file_normals = false;
    std::uint32_t parts = 0;
    std::uint32_t triangles = 0, meshes = 0;  ///< of all parts; meshes: objects with triangles
    std::vector<bool> shared;

    // For finding the planes that parts share.
    PlaneIndex planes;
    SheetScale scale;
    std::optional<SheetJoiner> joiner;

    /// Faces of different parts that lie in one plane: triangle of the part, number of the group.
    struct Member {
        std::uint32_t triangle, group;
    };
    std::vector<std::vector<Member>> members;  ///< by part, ascending
    Scene faces;                               ///< all of them; its sheets are the groups
    std::vector<std::array<glm::dvec3, 3>> group_frames;  ///< corners of Sheets::frame
    std::vector<Plane> group_planes;                      ///< in the view
};

}  // namespace sightline
