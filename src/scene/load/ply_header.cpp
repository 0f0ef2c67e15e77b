#include "scene/load/ply_header.hpp"

namespace sightline::load {

std::optional<std::string> ply_problem(std::string_view beginning) {
    if (!beginning.starts_with("ply"))
        return "not a PLY file: it does not begin with \"ply\"; check the format";
    const std::string_view header = beginning.substr(0, beginning.find("end_header"));
    if (header.find("element tristrips") != std::string_view::npos) {
        return "it stores triangle strips, which cannot be read yet; convert it to triangles";
    }
    return std::nullopt;
}

}  // namespace sightline::load
