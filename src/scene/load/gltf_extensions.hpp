// What a glTF file requires of its reader beyond glTF 2.0.
#pragma once

#include <string>
#include <string_view>

namespace sightline::load {

/// The first entry of a file's extensionsRequired without which its shapes would be read wrongly or
/// not at all; "" when there is none, or when the file can't be read. `file`: all of it, as text or
/// in the binary form. Never throws.
[[nodiscard]] std::string unsupported_gltf_extension(std::string_view file);

}  // namespace sightline::load
