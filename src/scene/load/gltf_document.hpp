// What a glTF file says of itself, read before assimp sees it: what it requires of its reader, and
// the files that it names, of which assimp tells only some.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace sightline::load {

struct GltfDocument {
    std::string fault;             ///< why it can't be read, or not rightly; "" when it can
    std::set<std::string> files;   ///< every URI in it, as it stands and decoded; none of the data:
    std::set<std::string> images;  ///< names for messages
};

/// `file`: all of it, as text or in the binary form. A fault: chunks that the file has no room for;
/// JSON that is not valid or has a key twice in an object, as another reader may understand it in
/// another way; an extension in extensionsRequired without which shapes would be read wrongly or
/// not at all. After a fault nothing else is set. O(bytes).
[[nodiscard]] GltfDocument read_gltf_document(std::string_view file);

}  // namespace sightline::load
