// Building of BSP trees, and of what moves on top of one.
#pragma once

#include <vector>

#include "visibility/bsp_face.hpp"

namespace sightline::bsp {

/// Nodes, planes, parts and cuts of a tree that holds the faces. With a tree below, the planes of
/// its nodes come first wherever there are faces: the result is to be walked together with it.
/// Runs on the threads of the caller's arena; the result does not depend on them.
/// Throws std::bad_alloc.
[[nodiscard]] Tree divide_space(const Surfaces& surfaces, std::vector<Face> faces,
                                const Tree* below = nullptr);

/// As build_bsp(), with the right number of marks. Throws std::bad_alloc.
[[nodiscard]] BspTree make_tree(const Scene& scene, const BspOptions& options);

}  // namespace sightline::bsp
