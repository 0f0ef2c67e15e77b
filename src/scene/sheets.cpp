// Sheets: faces that are coplanar in the world, up to the rounding of the file's coordinates.
//
// Snapped to a screen one by one, a wall and the decal on it are no longer coplanar and fight; so
// the clusters are found here, in the world, once, and share a plane in every view.
//
// Method, of one part of the scene (a file). A plane is a point (normal, offset) of a
// four-dimensional grid of cells; a face asks the cells that its own uncertainty reaches (most
// often one) for partners. Faces with a partner are then taken from the largest down: each that is
// still free becomes a seed and takes every free face whose corners lie within `tolerance` of its
// plane. Membership refers to the seed and is not handed on from member to member, so a finely
// tessellated sphere does not grow into one sheet; and since the seeds come in an order that only
// geometry decides, the order of input does not matter. Sheets of several parts are then joined as
// wholes (sheet_joiner.cpp).
#include "scene/sheets.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>
#include <tuple>

#include "scene/tolerance.hpp"

namespace sightline {

namespace {

// Cells of 8 tolerances along the normal, so that a face rarely reaches two, and of 2 along the
// offset, where parallel planes crowd.
constexpr std::array<double, 4> kCell{0x1p-9, 0x1p-9, 0x1p-9, 0x1p-11};
constexpr std::int64_t kCellBias = 4096;
constexpr int kCellBits = 14;

template <class Body>
void parallel_faces(std::size_t n, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            body(static_cast<std::uint32_t>(i));
    });
}

/// Finds the sheets of some triangles of a scene, one after the other: a part.
class SheetBuilder {
public:
    SheetBuilder(Scene& scene, const SheetScale& scale, TriangleRun run)
        : scene_(scene),
          scale_(scale),
          begin_(run.first),
          count_(run.count),
          sheet_count_(static_cast<std::uint32_t>(scene.sheets.first.size())) {}

    /// Appends the sheets, without frames, to those of the scene, and their seeds.
    void run(std::vector<std::uint32_t>& seeds) {
        fill_cells();
        grow_sheets(find_candidates(), seeds);
    }

private:
    // -- planes and cells ---------------------------------------------------------------------

    [[nodiscard]] const glm::dvec3& corner(std::uint32_t t, int k) const {
        return scene_.positions[scene_.triangles[begin_ + t][k]];
    }

    [[nodiscard]] FacePlane plane_of(std::uint32_t t) const {
        return planes_.empty() ? plane_of_face(scene_, scale_, begin_ + t) : planes_[t];
    }

    /// A face in the hash table, with its plane, so that most are dismissed without a look
    /// elsewhere.
    struct Resident {
        std::uint64_t cell;
        glm::dvec3 normal;
        double offset;
        std::uint32_t triangle;
    };

    // The four coordinates of a plane, all of about the size of 1. A plane and its reverse are one.
    template <class Plane>
    [[nodiscard]] std::array<double, 4> coordinates(const Plane& plane, double sign) const {
        return {sign * plane.normal.x, sign * plane.normal.y, sign * plane.normal.z,
                sign * plane.offset / scale_.radius};
    }

    [[nodiscard]] static std::uint64_t pack(const std::array<std::int64_t, 4>& cell) {
        std::uint64_t key = 0;
        for (const std::int64_t c : cell)
            key = key << kCellBits | static_cast<std::uint64_t>(c + kCellBias);
        return key;
    }

    [[nodiscard]] static std::int64_t cell_of(double coordinate, std::size_t axis) {
        return static_cast<std::int64_t>(std::floor(coordinate / kCell[axis]));
    }

    // A hash table whose slots lie in one row: those of slot s are residents_[first_[s]] to
    // residents_[first_[s + 1] - 1].
    // The planes of a large part are computed whenever they are needed: to keep them would take a
    // quarter of all memory.
    void fill_cells() {
        constexpr std::uint32_t kMostKept = 1u << 22;
        if (count_ <= kMostKept) {
            std::vector<FacePlane> planes(count_);
            parallel_faces(count_, [&](std::uint32_t t) { planes[t] = plane_of(t); });
            planes_.swap(planes);
        }
        slot_bits_ = std::max(4, static_cast<int>(std::bit_width(count_)));
        first_.assign((std::size_t{1} << slot_bits_) + 1, 0);
        parallel_faces(count_, [&](std::uint32_t t) {
            const FacePlane plane = plane_of(t);
            if (plane.is_usable()) ++std::atomic_ref(first_[slot_of(home_of(plane))]);
        });
        std::uint32_t end = 0;
        for (std::uint32_t& first : first_) first = end += first;
        residents_.resize(end);
        // In any order within a slot: nothing that is decided depends on it.
        parallel_faces(count_, [&](std::uint32_t t) {
            const FacePlane plane = plane_of(t);
            if (!plane.is_usable()) return;
            const std::uint64_t cell = home_of(plane);
            const std::uint32_t at = --std::atomic_ref(first_[slot_of(cell)]);
            residents_[at] = {cell, plane.normal, plane.offset, t};
        });
    }

    [[nodiscard]] std::uint64_t home_of(const FacePlane& plane) const {
        const auto at = coordinates(plane, heading(plane.normal) < 0 ? -1.0 : 1.0);
        std::array<std::int64_t, 4> cell{};
        for (std::size_t k = 0; k < 4; ++k) cell[k] = cell_of(at[k], k);
        return pack(cell);
    }

    [[nodiscard]] std::size_t slot_of(std::uint64_t cell) const {
        // The uppermost bits of a product depend on all bits of its factor (D. Knuth, "Sorting and
        // Searching", 1973): neighbours of a cell that many faces share must not share its slot.
        return static_cast<std::size_t>((cell * 0x9E3779B97F4A7C15u) >> (64 - slot_bits_));
    }

    // Calls visit(resident) for all in a cell whose normals agree with this one, until it answers
    // true; returns whether it did.
    template <class Visit>
    bool any_in_cell(std::uint64_t cell, const glm::dvec3& normal, const Visit& visit) const {
        const std::size_t slot = slot_of(cell);
        for (std::uint32_t i = first_[slot]; i < first_[slot + 1]; ++i) {
            const Resident& r = residents_[i];
            if (r.cell == cell && are_parallel(normal, r.normal) && visit(r)) return true;
        }
        return false;
    }

    template <class Visit>
    bool any_around(const std::array<double, 4>& at, const glm::dvec3& normal,
                    const Visit& visit) const {
        std::array<std::array<std::int64_t, 2>, 4> sides;
        for (std::size_t k = 0; k < 4; ++k)
            sides[k] = {cell_of(at[k] - kNormalTolerance, k), cell_of(at[k] + kNormalTolerance, k)};
        for (std::size_t choice = 0; choice < 16; ++choice) {
            std::array<std::int64_t, 4> cell{};
            bool repeated = false;
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t which = choice >> k & 1;
                repeated = repeated || (which == 1 && sides[k][0] == sides[k][1]);
                cell[k] = sides[k][which];
            }
            if (!repeated && any_in_cell(pack(cell), normal, visit)) return true;
        }
        return false;
    }

    // Calls visit for the faces whose planes may be this one and whose normals agree, the face
    // that has it among them.
    template <class Plane, class Visit>
    bool any_near(const Plane& plane, const Visit& visit) const {
        const double h = heading(plane.normal);
        if (h >= -2 * kNormalTolerance && any_around(coordinates(plane, 1), plane.normal, visit))
            return true;
        return h <= 2 * kNormalTolerance && any_around(coordinates(plane, -1), plane.normal, visit);
    }

    // -- clusters -----------------------------------------------------------------------------

    // Whether a face whose normal agrees with that of a seed lies in its plane.
    template <class Plane>
    [[nodiscard]] bool lies_in(std::uint32_t t, const Plane& seed) const {
        for (int k = 0; k < 3; ++k)
            if (!scale_.holds(seed.normal, seed.offset, corner(t, k))) return false;
        return true;
    }

    // Faces that have a partner at all, from the largest to the smallest.
    [[nodiscard]] std::vector<std::uint32_t> find_candidates() {
        std::vector<std::uint8_t> has_partner(count_, 0);
        // In the order of the table: neighbours there ask the same cells.
        parallel_faces(residents_.size(), [&](std::uint32_t i) {
            const Resident& own = residents_[i];
            has_partner[own.triangle] = any_near(own, [&](const Resident& other) {
                return &other != &own &&
                       (lies_in(other.triangle, own) || lies_in(own.triangle, other));
            });
        });
        std::vector<Candidate> candidates;
        for (std::uint32_t t = 0; t < has_partner.size(); ++t)
            if (has_partner[t] != 0) candidates.push_back({plane_of(t).area2, t});
        tbb::parallel_sort(
            candidates.begin(), candidates.end(),
            [&](const Candidate& a, const Candidate& b) { return comes_before(a, b); });
        std::vector<std::uint32_t> order(candidates.size());
        std::ranges::transform(candidates, order.begin(), &Candidate::triangle);
        return order;
    }

    struct Candidate {
        double area2;
        std::uint32_t triangle;
    };

    // By area, then by place; the number decides only between copies of one face.
    [[nodiscard]] bool comes_before(const Candidate& a, const Candidate& b) const {
        if (a.area2 != b.area2) return a.area2 > b.area2;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 &p = corner(a.triangle, k), &q = corner(b.triangle, k);
            const auto pt = std::tie(p.x, p.y, p.z), qt = std::tie(q.x, q.y, q.z);
            if (pt != qt) return pt < qt;
        }
        return a.triangle < b.triangle;
    }

    void grow_sheets(const std::vector<std::uint32_t>& candidates,
                     std::vector<std::uint32_t>& seeds) {
        if (candidates.empty()) return;
        if (scene_.sheets.of_triangle.empty())
            scene_.sheets.of_triangle.assign(scene_.triangles.size(), kNone);
        const auto of_triangle = std::span(scene_.sheets.of_triangle).subspan(begin_, count_);
        std::vector<std::uint32_t> members;
        for (const std::uint32_t seed : candidates) {
            if (of_triangle[seed] != kNone) continue;
            members.clear();
            const FacePlane plane = plane_of(seed);
            any_near(plane, [&](const Resident& r) {
                if (of_triangle[r.triangle] == kNone && lies_in(r.triangle, plane))
                    members.push_back(r.triangle);
                return false;
            });
            std::sort(members.begin(), members.end());
            members.erase(std::unique(members.begin(), members.end()), members.end());
            if (members.size() < 2) continue;
            for (const std::uint32_t t : members) of_triangle[t] = sheet_count_;
            scene_.sheets.first.push_back(static_cast<std::uint32_t>(scene_.sheets.members.size()));
            for (const std::uint32_t t : members) scene_.sheets.members.push_back(begin_ + t);
            seeds.push_back(begin_ + seed);
            ++sheet_count_;
        }
    }

    Scene& scene_;
    const SheetScale& scale_;
    std::uint32_t begin_, count_;    // of the triangles; all others here are numbered from there
    std::vector<FacePlane> planes_;  // of all, or nothing
    int slot_bits_ = 0;
    std::vector<std::uint32_t> first_;
    std::vector<Resident> residents_;
    std::uint32_t sheet_count_;
};

}  // namespace

SheetScale::SheetScale(const Box& bounds, double rounding)
    : centre(bounds.centre()),
      radius(0.5 * glm::length(bounds.extent())),
      tolerance(rounding_of(bounds, rounding)) {}

bool SheetScale::holds(const FacePlane& plane, const glm::dvec3& point) const {
    return holds(plane.normal, plane.offset, point);
}

bool SheetScale::holds(const glm::dvec3& normal, double offset, const glm::dvec3& point) const {
    return !(std::abs(glm::dot(normal, point - centre) - offset) > tolerance);
}

bool are_parallel(const glm::dvec3& n, const glm::dvec3& m) {
    return !(1 - std::abs(glm::dot(n, m)) > 0.5 * kNormalTolerance * kNormalTolerance);
}

double heading(const glm::dvec3& normal) {
    return glm::dot(normal, glm::dvec3{0.3717, 0.5423, 0.7535});
}

FacePlane plane_of_face(const Scene& scene, const SheetScale& scale, std::uint32_t triangle) {
    const Corners c = scene.triangles[triangle];
    const glm::dvec3 p = scene.positions[c.x];
    const glm::dvec3 n = glm::cross(scene.positions[c.y] - p, scene.positions[c.z] - p);
    const double length = glm::length(n);
    const bool dropped = !scene.degenerate.empty() && scene.degenerate[triangle] != 0;
    if (dropped || !(length > 0) || !std::isfinite(length)) return {};
    const glm::dvec3 unit = n / length;
    return {unit, glm::dot(unit, p - scale.centre), length};
}

void find_part_sheets(Scene& scene, const SheetScale& scale, TriangleRun part,
                      std::vector<std::uint32_t>& seeds) {
    SheetBuilder(scene, scale, part).run(seeds);
}

std::vector<TriangleRun> parts_of(const Scene& scene) {
    std::vector<TriangleRun> parts;
    std::uint32_t last = kNone;
    for (const Object& object : scene.objects) {
        if (parts.empty() || object.part != last) parts.push_back({object.first_triangle, 0});
        parts.back().count += object.triangle_count;
        last = object.part;
    }
    return parts;
}

void build_sheets(Scene& scene) {
    scene.sheets = {};
    const SheetScale scale(scene.bounds, scene.rounding);
    if (scene.bounds.empty() || !(scale.radius > 0)) return;
    std::vector<std::uint32_t> seeds;
    const std::vector<TriangleRun> parts = parts_of(scene);
    for (const TriangleRun& part : parts) find_part_sheets(scene, scale, part, seeds);
    if (parts.size() > 1) join_sheets_of_parts(scene, scale, parts, seeds);
    frame_sheets(scene);
}

}  // namespace sightline
