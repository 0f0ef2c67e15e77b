// A piece of an OBJ file, from one line's start to another's end, parsed on its own: pieces are
// parsed side by side, then put together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::load {

/// A line that changes what the polygons after it belong to.
struct ObjEvent {
    enum class Kind { object, group, use_material, material_file };
    Kind kind;
    std::size_t polygon;    ///< number of polygons in the chunk before it
    std::string_view name;  ///< in the text
};

/// A line that can't be read.
struct ObjFault {
    const char* where;  ///< in the text
    std::string what;
};

/// Stands for an index that no vertex or normal can have.
inline constexpr std::uint32_t kObjOutOfRange = 0x80000000u;  // files have fewer vertices

/// Indices in a file count from 1, or from the latest vertex back when negative.
struct ObjIndices {
    std::vector<std::uint32_t> values;  ///< from 0; kNone: the corner has none
    /// Places in `values` whose value still counts from the start of the chunk (modulo 2^32).
    std::vector<std::size_t> relative;
};

struct ObjChunk {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> colors;             ///< one a position, or empty
    std::vector<std::uint32_t> polygon_sizes;  ///< >= 3
    ObjIndices corners;
    ObjIndices normal_corners;  ///< one a corner, or empty
    std::vector<ObjEvent> events;
    std::uint64_t ignored = 0;  ///< points, line segments, and faces of less than 3 corners
    std::optional<ObjFault> fault;
};

/// How many vertices and normals stand before a chunk, and how many vertices in the whole file.
struct ObjCounts {
    std::size_t positions_before = 0, normals_before = 0, positions = 0;
};

/// Parses a chunk up to its first fault. With `counts` given, vertices out of range are faults too.
/// Precondition: the text is empty or ends with '\n'.
[[nodiscard]] ObjChunk parse_obj_chunk(std::string_view text, const ObjCounts* counts = nullptr);

}  // namespace sightline::load
