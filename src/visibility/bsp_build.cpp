// Building a BSP tree: the faces of a cell are sorted to the two sides of a plane, and split where
// they lie on both, until every face lies in the plane of a node.
//
// Source: H. Fuchs, Z. Kedem, B. Naylor, "On Visible Surface Generation by A Priori Tree
// Structures", 1980.
//
// How this version differs: planes that are no polygon's divide large cells (bsp_choose.cpp), all
// coplanar faces go into one node, and large cells are divided by tasks of their own. There is no
// recursion, so chains of any depth are fine. What a task makes stands in a chunk; chunks are put
// together in an order that follows from the tree alone, so any number of threads gives the same.
//
// Time O(n log n) for usual scenes: every level of free planes sorts all faces once, and a cell
// that is not divided by them holds few.
#include "visibility/bsp_build.hpp"

#include <tbb/task_group.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <mutex>
#include <new>
#include <utility>

#include "math/arena.hpp"
#include "visibility/bsp_choose.hpp"

namespace sightline::bsp {

namespace {

constexpr std::size_t kTaskFaces = 1024;  // a cell with more is divided by a task of its own
constexpr std::uint64_t kMostCuts = std::uint64_t{1} << 30;  // twice that fits into a CutSide

/// A side of a cut while its number in the tree is not known: that of the chunk, of the cut in the
/// chunk, and the side.
using CutName = std::uint64_t;

CutName cut_name(std::uint32_t chunk, std::size_t cut, bool back) {
    return std::uint64_t{chunk} << 32 | cut << 1 | static_cast<std::uint64_t>(back);
}

/// A cell that is to be divided.
struct Cell {
    std::vector<Face> faces;
    std::uint32_t below = kNone;   ///< node of the tree below
    std::uint32_t parent = kNone;  ///< node of the chunk
    bool back = false;             ///< which child of it
};

/// What one task makes. Numbers of nodes are those of the chunk.
struct Chunk {
    struct NamedPart {
        std::uint32_t triangle;
        CutName cut;
        bool reversed;
    };
    struct NamedCut {
        std::uint32_t node;
        CutName parent;
    };
    struct Link {
        std::uint32_t node;
        bool back;
        std::uint32_t chunk;
    };
    std::uint32_t number = 0;
    std::vector<Node> nodes;
    std::vector<TreePlane> planes;
    std::vector<std::uint32_t> below;
    std::vector<NamedPart> parts;
    std::vector<NamedCut> cuts;
    std::vector<Link> links;  ///< children in other chunks
};

bool same_plane(const TreePlane& a, const TreePlane& b) {
    return a == b || (a.normal == -b.normal && a.offset == -b.offset);
}

class Builder {
public:
    Builder(const Surfaces& surfaces, const Tree* below) : surfaces_(surfaces), below_(below) {}

    void run(std::vector<Face> faces) {
        if (faces.empty()) return;
        Cell root;
        root.faces = std::move(faces);
        if (below_ != nullptr) root.below = below_->root();
        start(new_chunk(), std::move(root));
        tasks_.wait();
    }

    [[nodiscard]] const std::deque<Chunk>& chunks() const { return chunks_; }

private:
    Chunk& new_chunk() {
        const std::lock_guard lock(mutex_);
        Chunk& chunk = chunks_.emplace_back();
        chunk.number = static_cast<std::uint32_t>(chunks_.size() - 1);
        return chunk;
    }

    void start(Chunk& chunk, Cell cell) {
        tasks_.run([this, &chunk, held = std::make_shared<Cell>(std::move(cell))] {
            std::vector<Cell> cells;
            cells.push_back(std::move(*held));
            while (!cells.empty()) {
                Cell next = std::move(cells.back());
                cells.pop_back();
                divide(chunk, std::move(next), cells);
            }
        });
    }

    void divide(Chunk& chunk, Cell cell, std::vector<Cell>& cells) {
        const auto node = static_cast<std::uint32_t>(chunk.nodes.size());
        if (cell.parent != kNone) child_of(chunk.nodes[cell.parent], cell.back) = node;
        chunk.nodes.push_back({kNone, kNone, static_cast<std::uint32_t>(chunk.parts.size())});
        Cell front, back;
        sort_faces(chunk, cell, front, back);
        if (cell.below != kNone) {
            front.below = below_->nodes[cell.below].front;
            back.below = below_->nodes[cell.below].back;
        }
        back.back = true;
        cell = {};
        for (Cell* child : {&back, &front}) {
            if (child->faces.empty()) continue;
            if (child->faces.size() > kTaskFaces) {
                Chunk& other = new_chunk();
                chunk.links.push_back({node, child->back, other.number});
                start(other, std::move(*child));
            } else {
                child->parent = node;
                cells.push_back(std::move(*child));
            }
        }
    }

    static std::uint32_t& child_of(Node& node, bool back) { return back ? node.back : node.front; }

    // Finds a plane and gives every face its place: in it, in front of it, behind it.
    void sort_faces(Chunk& chunk, Cell& cell, Cell& front, Cell& back) {
        if (cell.below != kNone) {
            const std::span<const Part> parts = below_->parts_of(cell.below);
            const Choice given{below_->planes[cell.below],
                               parts.empty() ? kNone : parts.front().triangle};
            sort_by(chunk, given, cell, front, back);
            return;
        }
        const std::optional<Choice> free = choose_free_plane(surfaces_, cell.faces);
        if (free && divides(free->plane, cell.faces))
            sort_by(chunk, *free, cell, front, back);
        else
            sort_by(chunk, choose_plane_of_face(surfaces_, cell.faces), cell, front, back);
    }

    // Whether there are fewer faces on either side. Most often the first few tell.
    [[nodiscard]] bool divides(const TreePlane& plane, const std::vector<Face>& faces) const {
        bool some_behind = false, some_in_front = false;
        for (std::size_t k = 0; k < faces.size() && !(some_behind && some_in_front); ++k) {
            const Side side = place(FaceCorners(surfaces_, faces[k]).span(), plane).side;
            some_behind = some_behind || side == Side::back;
            some_in_front = some_in_front || side == Side::front;
        }
        return some_behind && some_in_front;
    }

    void sort_by(Chunk& chunk, const Choice& choice, Cell& cell, Cell& front, Cell& back) {
        chunk.planes.push_back(choice.plane);
        if (below_ != nullptr) chunk.below.push_back(cell.below);
        const std::size_t first_part = chunk.parts.size();
        for (Face& face : cell.faces) {
            const FaceCorners corners(surfaces_, face);
            const Placement placement = place(corners.span(), choice.plane);
            if (lies_in(face, placement, choice)) {
                chunk.parts.push_back(
                    {face.triangle, face.cut, surfaces_.is_reversed(face.triangle, choice.plane)});
            } else if (placement.side == Side::both) {
                cut_face(chunk, choice.plane, face, corners.span(), front, back);
            } else {
                (placement.side == Side::front ? front : back).faces.push_back(std::move(face));
            }
        }
        std::sort(chunk.parts.begin() + static_cast<std::ptrdiff_t>(first_part), chunk.parts.end(),
                  [](const auto& a, const auto& b) { return a.triangle > b.triangle; });
    }

    // The faces of a sheet share one plane, even where their corners are off it.
    [[nodiscard]] bool lies_in(const Face& face, const Placement& placement,
                               const Choice& choice) const {
        if (choice.triangle != kNone && surfaces_.share_plane(face.triangle, choice.triangle))
            return true;
        return placement.in_plane && same_plane(surfaces_.plane(face.triangle), choice.plane);
    }

    static void cut_face(Chunk& chunk, const TreePlane& plane, const Face& face,
                         std::span<const glm::dvec3> corners, Cell& front, Cell& back) {
        const std::size_t number = chunk.cuts.size();
        chunk.cuts.push_back({static_cast<std::uint32_t>(chunk.nodes.size() - 1), face.cut});
        front.faces.push_back({face.triangle, cut_name(chunk.number, number, false), {}});
        back.faces.push_back({face.triangle, cut_name(chunk.number, number, true), {}});
        split(corners, plane, front.faces.back().corners, back.faces.back().corners);
    }

    const Surfaces& surfaces_;
    const Tree* below_;
    std::mutex mutex_;
    std::deque<Chunk> chunks_;
    tbb::task_group tasks_;
};

/// Puts the chunks together, every one after those that it hangs on.
class Joiner {
public:
    explicit Joiner(const std::deque<Chunk>& chunks) : chunks_(chunks), starts_(chunks.size()) {}

    [[nodiscard]] Tree join() {
        find_order();
        for (const std::uint32_t number : order_) append(chunks_[number]);
        for (const std::uint32_t number : order_)
            for (const Chunk::Link& link : chunks_[number].links) {
                Node& node = tree_.nodes[starts_[number].node + link.node];
                (link.back ? node.back : node.front) = starts_[link.chunk].node;
            }
        tree_.nodes.push_back({kNone, kNone, static_cast<std::uint32_t>(tree_.parts.size())});
        return std::move(tree_);
    }

private:
    struct Start {
        std::uint32_t node = 0, cut = 0;
    };

    void find_order() {
        std::uint64_t nodes = 0, cuts = 0, parts = 0;
        std::vector<std::uint32_t> waiting;
        if (!chunks_.empty()) waiting.push_back(0);
        while (!waiting.empty()) {
            const std::uint32_t number = waiting.back();
            waiting.pop_back();
            order_.push_back(number);
            const Chunk& chunk = chunks_[number];
            starts_[number] = {static_cast<std::uint32_t>(nodes), static_cast<std::uint32_t>(cuts)};
            nodes += chunk.nodes.size();
            cuts += chunk.cuts.size();
            parts += chunk.parts.size();
            if (nodes > kMostCuts || cuts > kMostCuts || parts > kMostCuts) throw std::bad_alloc();
            for (const Chunk::Link& link : chunk.links) waiting.push_back(link.chunk);
        }
        tree_.nodes.reserve(nodes + 1);
        tree_.planes.reserve(nodes);
        tree_.cuts.reserve(cuts);
        tree_.parts.reserve(parts);
    }

    void append(const Chunk& chunk) {
        const auto first_node = static_cast<std::uint32_t>(tree_.nodes.size());
        const auto first_part = static_cast<std::uint32_t>(tree_.parts.size());
        const auto moved = [&](std::uint32_t child) {
            return child == kNone ? kNone : child + first_node;
        };
        for (const Node& node : chunk.nodes)
            tree_.nodes.push_back(
                {moved(node.front), moved(node.back), node.first_part + first_part});
        tree_.planes.insert(tree_.planes.end(), chunk.planes.begin(), chunk.planes.end());
        tree_.below.insert(tree_.below.end(), chunk.below.begin(), chunk.below.end());
        for (const Chunk::NamedCut& cut : chunk.cuts)
            tree_.cuts.push_back({cut.node + first_node, side_of(cut.parent)});
        for (const Chunk::NamedPart& part : chunk.parts)
            tree_.parts.push_back(
                {part.triangle, side_of(part.cut), static_cast<std::uint32_t>(part.reversed)});
    }

    [[nodiscard]] CutSide side_of(CutName name) const {
        if (name == Face::kNoCut) return kNone;
        return 2 * starts_[name >> 32].cut + static_cast<std::uint32_t>(name);
    }

    const std::deque<Chunk>& chunks_;
    std::vector<Start> starts_;
    std::vector<std::uint32_t> order_;
    Tree tree_;
};

}  // namespace

Tree divide_space(const Surfaces& surfaces, std::vector<Face> faces, const Tree* below) {
    Builder builder(surfaces, below);
    builder.run(std::move(faces));
    return Joiner(builder.chunks()).join();
}

}  // namespace sightline::bsp

namespace sightline {

namespace bsp {

BspTree make_tree(const Scene& scene, const BspOptions& options) {
    Tree tree;
    const WorldGrid grid = make_grid(scene.reach);  // also of what is put on top
    std::vector<Face> faces;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const bool left_out = !options.moving.empty() && options.moving[t] != 0;
        const bool degenerate = !scene.degenerate.empty() && scene.degenerate[t] != 0;
        if (!left_out && !degenerate) faces.push_back({t, Face::kNoCut, {}});
    }
    const Surfaces surfaces(scene, grid);
    in_arena(options.threads, [&] { tree = divide_space(surfaces, std::move(faces)); });
    tree.grid = grid;
    tree.moving.assign(options.moving.begin(), options.moving.end());
    tree.fingerprint = fingerprint_of(scene, options.moving);
    tree.triangles = scene.triangle_count();
    return BspTree(std::make_shared<const Tree>(std::move(tree)));
}

}  // namespace bsp

Result<BspTree> build_bsp(const Scene& scene, const BspOptions& options) {
    if (!options.moving.empty() && options.moving.size() != scene.triangles.size())
        return Error{
            ErrorKind::bad_option,
            "the marks of what moves are not as many as the triangles: give one byte each"};
    try {
        return bsp::make_tree(scene, options);
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io,
                     "not enough memory for the tree of the scene: use another algorithm"};
    }
}

}  // namespace sightline
