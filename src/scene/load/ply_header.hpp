// The header of a PLY file: what elements follow, of which properties, in which form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/load/reader.hpp"

namespace sightline::load {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a value in a binary file.
[[nodiscard]] std::size_t size_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type;
    std::optional<PlyType> count_type;  ///< of a list's length; none: a single value
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;  ///< as stated: may be absurd
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    enum class Format { ascii, binary_little_endian, binary_big_endian };
    Format format = Format::ascii;
    std::vector<PlyElement> elements;
    std::size_t size = 0;               ///< of the header, in bytes
    std::vector<std::string> textures;  ///< what comments name as such: the rest of their line
};

/// Errors: no PLY file, or a header that is cut off or can't be understood.
[[nodiscard]] Result<PlyHeader> parse_ply_header(std::string_view bytes,
                                                 const ReadContext& context);

}  // namespace sightline::load
