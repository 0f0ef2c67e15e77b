// Fuchs, Kedem and Naylor take the polygon of a few tried ones that splits the fewest others. The
// number of pieces then still grows faster than that of the polygons, for planes near the root run
// through the whole scene.
//
// How this version differs: while a cell holds many faces it is divided by a plane perpendicular to
// an axis, chosen from a histogram of where faces begin and end, as in the building of bounding
// volumes (I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007). A plane
// that halves n faces of a surface cuts about sqrt(n) of them, and both halves are small, so no
// later plane reaches far. In small cells the planes of faces compete, by the number of splits and
// the balance of the two sides.
#include "visibility/bsp_choose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace sightline::bsp {

namespace {

constexpr std::size_t kFewFaces = 64;    // a cell that free planes do not divide further
constexpr std::size_t kCandidates = 48;  // faces whose planes are tried
constexpr std::size_t kWitnesses = 96;   // faces on which they are tried
constexpr std::size_t kBins = 32;        // of the histogram along an axis
// A split costs a piece for ever, a lack of balance only a longer way.
constexpr double kSplitCost = 8;
// A free plane shall not cut more than this share of the faces.
constexpr double kMostCut = 0.5;
// ... nor leave nearly all of them on one side.
constexpr double kMostOnOneSide = 0.95;

/// How good a plane is: the smaller, the better.
double cost(double front, double back, double cut) {
    return kSplitCost * cut + std::abs(front - back);
}

struct Interval {
    double lo = std::numeric_limits<double>::infinity();
    double hi = -std::numeric_limits<double>::infinity();
};

using Intervals = std::array<Interval, 3>;  // a box

Intervals box_of(const Surfaces& surfaces, const Face& face) {
    Intervals box;
    const FaceCorners corners(surfaces, face);
    for (const glm::dvec3& p : corners.span()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = p[static_cast<int>(axis)];
            box[axis].lo = std::min(box[axis].lo, x);
            box[axis].hi = std::max(box[axis].hi, x);
        }
    }
    return box;
}

struct FreePlane {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t axis = 0;
    double offset = 0;
};

/// The best plane perpendicular to an axis, where there is a good one.
void try_axis(std::span<const Intervals> boxes, std::size_t axis, const Interval& range,
              FreePlane& best) {
    const double width = (range.hi - range.lo) / kBins;
    if (!(width > 2 * kTolerance)) return;
    std::array<std::uint32_t, kBins> begins{}, ends{};
    const auto bin = [&](double x) {
        const double k = (x - range.lo) / width;
        return static_cast<std::size_t>(std::clamp(k, 0.0, kBins - 1.0));
    };
    for (const Intervals& box : boxes) {
        ++begins[bin(box[axis].lo)];
        // What ends within the tolerance of a plane does not cross it.
        const double middle = 0.5 * (box[axis].lo + box[axis].hi);
        ++ends[bin(std::max(middle, box[axis].hi - kTolerance))];
    }
    const double n = static_cast<double>(boxes.size());
    double below = 0, above = n;
    for (std::size_t k = 1; k < kBins; ++k) {
        below += begins[k - 1];
        above -= ends[k - 1];
        const double cut = below + above - n;
        if (cut > kMostCut * n || std::max(below, above) > kMostOnOneSide * n) continue;
        const double c = cost(above, below, cut);
        if (c < best.cost) best = {c, axis, range.lo + static_cast<double>(k) * width};
    }
}

/// Every so many-th of n, so that there are at most `most`.
std::size_t stride(std::size_t n, std::size_t most) { return (n + most - 1) / most; }

double cost_of(const Surfaces& surfaces, std::span<const Face> faces, const Choice& choice,
               double least) {
    double front = 0, back = 0, cut = 0;
    for (std::size_t k = 0; k < faces.size(); k += stride(faces.size(), kWitnesses)) {
        const Face& face = faces[k];
        if (surfaces.share_plane(face.triangle, choice.triangle)) continue;
        const FaceCorners corners(surfaces, face);
        const Side side = place(corners.span(), choice.plane).side;
        front += side != Side::back ? 1 : 0;
        back += side != Side::front ? 1 : 0;
        cut += side == Side::both ? 1 : 0;
        if (kSplitCost * cut >= least) break;
    }
    return cost(front, back, cut);
}

}  // namespace

std::optional<Choice> choose_free_plane(const Surfaces& surfaces, std::span<const Face> faces) {
    if (faces.size() <= kFewFaces) return std::nullopt;
    thread_local std::vector<Intervals> boxes;
    boxes.clear();
    Intervals all;
    for (const Face& face : faces) {
        const Intervals box = box_of(surfaces, face);
        boxes.push_back(box);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            all[axis].lo = std::min(all[axis].lo, box[axis].lo);
            all[axis].hi = std::max(all[axis].hi, box[axis].hi);
        }
    }
    FreePlane best;
    for (std::size_t axis = 0; axis < 3; ++axis) try_axis(boxes, axis, all[axis], best);
    if (std::isinf(best.cost)) return std::nullopt;
    TreePlane plane{{0, 0, 0}, best.offset};
    plane.normal[static_cast<int>(best.axis)] = 1;
    return Choice{plane, kNone};
}

Choice choose_plane_of_face(const Surfaces& surfaces, std::span<const Face> faces) {
    Choice best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < faces.size(); k += stride(faces.size(), kCandidates)) {
        const Choice choice{surfaces.plane(faces[k].triangle), faces[k].triangle};
        const double c = faces.size() == 1 ? 0 : cost_of(surfaces, faces, choice, least);
        if (c >= least) continue;
        least = c;
        best = choice;
    }
    return best;
}

}  // namespace sightline::bsp
