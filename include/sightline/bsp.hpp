// Binary space partition trees: built once for a scene, they give the order of its surfaces for
// every eye and every direction of view in linear time.
//
// Source: H. Fuchs, Z. Kedem, B. Naylor, "On Visible Surface Generation by A Priori Tree
// Structures", SIGGRAPH 1980.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sightline/error.hpp"
#include "sightline/scene.hpp"

namespace sightline {

namespace bsp {
struct Tree;
}

/// The algorithm that takes a tree (ResolveOptions::tree).
inline constexpr std::string_view kTreeAlgorithm = "bsp";

/// What a tree looks like.
struct BspStats {
    std::uint64_t triangles = 0;    ///< of the scene that stand in the tree
    std::uint64_t left_out = 0;     ///< of the scene that were left out because they move
    std::uint64_t nodes = 0;        ///< all of them
    std::uint64_t free_planes = 0;  ///< nodes whose plane is that of no triangle
    std::uint64_t pieces = 0;       ///< parts of triangles
    std::uint64_t splits = 0;       ///< how often a part was cut in two
    std::uint64_t depth = 0;        ///< nodes on the longest way down
};

/// The tree of a scene. Read-only once made: any number of threads may use it, and copies share the
/// data. It knows triangles by their ids only, so it serves every scene in which the triangles that
/// were not left out have the ids and places that they had when it was built.
class BspTree {
public:
    explicit BspTree(std::shared_ptr<const bsp::Tree> tree) : tree_(std::move(tree)) {}

    [[nodiscard]] BspStats stats() const;
    /// Whether it can be the tree of a scene: as many triangles. That they stand where they stood
    /// is up to the caller; see load_bsp() for a check. O(1).
    [[nodiscard]] bool fits(const Scene& scene) const;
    /// The inside, for the library itself.
    [[nodiscard]] const bsp::Tree& data() const { return *tree_; }

private:
    std::shared_ptr<const bsp::Tree> tree_;
};

struct BspOptions {
    int threads = 0;  ///< 0 = all cores; the tree does not depend on it
    /// One byte a triangle, not 0: it moves and is left out of the tree; the algorithm puts it on
    /// top of the tree where it stands then. Empty: nothing moves.
    std::span<const std::uint8_t> moving;
};

/// Builds the tree of a finished scene; degenerate triangles have no place in it. Quadrics are no
/// part of it either: tessellate_quadrics().
///
/// O(n log n) for the surfaces of usual models; where all surfaces cross one another O(n^2) pieces,
/// O(n^3) at worst. On all cores.
/// Errors: bad_option, when `moving` has another size than the triangles; io, when memory runs out.
[[nodiscard]] Result<BspTree> build_bsp(const Scene& scene, const BspOptions& options = {});

/// Writes a tree to a file of its own format, which appears complete or not at all. The same bytes
/// on every machine. O(tree).
/// Errors (io): the file can't be written; (bad_option): the tree is too large for the format.
[[nodiscard]] Status save_bsp(const BspTree& tree, const std::string& path);

/// Reads a tree that save_bsp() wrote. Whatever the file holds, the tree that comes of it can be
/// used without harm. O(file + scene).
/// Errors: io, the file can't be read; bad_input, it is no such file or it is damaged, or it holds
/// the tree of another scene: one whose triangles that don't move have other ids or places.
[[nodiscard]] Result<BspTree> load_bsp(const std::string& path, const Scene& scene);

}  // namespace sightline
