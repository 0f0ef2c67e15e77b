#include "visibility/sort_pieces.hpp"

#include <algorithm>
#include <utility>

#include "visibility/sample_box.hpp"
#include "visibility/scan_edges.hpp"

namespace sightline {

namespace {

std::vector<SortFace> faces_of(const ScreenScene& screen, const SampleGrid* grid) {
    std::vector<SortFace> faces;
    for (std::uint32_t k = 0; k < screen.triangle_count(); ++k) {
        if (!screen.drawable(k)) continue;
        if (grid != nullptr &&
            sample_box(screen, SampleUnits(*grid, screen.subpixel_bits()), k).empty())
            continue;
        const Corners c = screen.corners(k);
        if (OrientedTriangle(screen.point(c.x), screen.point(c.y), screen.point(c.z)).area2 > 0)
            faces.emplace_back(screen, k);
    }
    return faces;
}

}  // namespace

SortPieces::SortPieces(const ScreenScene& screen, const SampleGrid* grid, Observer* observer)
    : screen_(screen), grid_(grid), observer_(observer), faces_(faces_of(screen, grid)) {
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
        nodes_.push_back({f});
        nodes_.back().box = faces_[f].box;
    }
    if (grid != nullptr) cut_judge_.emplace(screen, SampleUnits(*grid, screen.subpixel_bits()));
    counts[SortCount::polygons] = faces_.size();
    sorted.pieces.reserve(faces_.size());
}

Precedes SortPieces::precedes(std::uint32_t q, std::uint32_t p) {
    const Node &node_p = nodes_[p], &node_q = nodes_[q];
    if (node_p.face == node_q.face || !node_p.box.overlaps(node_q.box)) return Precedes::no;
    ++counts[SortCount::pairs];
    tell(StepKind::polygons_tested, p, q);
    const SortFace &face_p = faces_[node_p.face], &face_q = faces_[node_q.face];
    if (face_p.shared == face_q.shared && face_p.shared != kNone) return precedes_in_plane(q, p);
    ++counts[SortCount::plane_tests];
    const PlaneSides of_p = sides_of_plane(p, node_q.face);
    if (!of_p.in_front) return of_p.behind ? Precedes::no : precedes_in_plane(q, p);
    const PlaneSides of_q = sides_of_plane(q, node_p.face);
    if (!of_q.behind) return Precedes::no;
    const bool decided = !of_p.behind || !of_q.in_front;
    if (decided) return overlap(q, p) ? Precedes::yes : Precedes::no;

    ++counts[SortCount::projection_tests];
    if (are_disjoint(face_q, face_p)) return Precedes::no;
    ++counts[SortCount::intersections];
    const auto signs = intersection(q, p).signs(line_where_deeper(face_q.plane, face_p.plane));
    if (!signs.positive) return Precedes::no;
    return signs.negative ? Precedes::crossing : Precedes::yes;
}

Precedes SortPieces::precedes_in_plane(std::uint32_t q, std::uint32_t p) {
    return face_of(p).id < face_of(q).id && overlap(q, p) ? Precedes::yes : Precedes::no;
}

PlaneSides SortPieces::sides_of_plane(std::uint32_t n, std::uint32_t cutter) {
    const SortFace &face = face_of(n), &by = faces_[cutter];
    const PlaneSides sides = sides_of(face, by, counts[SortCount::exact]);
    if (!(sides.behind && sides.in_front) || nodes_[n].region.empty()) return sides;
    const auto signs = nodes_[n].region.signs(line_where_deeper(face.plane, by.plane));
    return {signs.positive, signs.negative};
}

bool SortPieces::overlap(std::uint32_t q, std::uint32_t p) {
    ++counts[SortCount::projection_tests];
    if (are_disjoint(face_of(q), face_of(p))) return false;
    if (nodes_[q].region.empty() && nodes_[p].region.empty()) return true;
    ++counts[SortCount::intersections];
    return !intersection(q, p).empty();
}

PieceRegion SortPieces::region(std::uint32_t n) const {
    return nodes_[n].region.empty() ? region_of(face_of(n)) : nodes_[n].region;
}

PieceRegion SortPieces::intersection(std::uint32_t q, std::uint32_t p) const {
    PieceRegion common = region(q);
    const PieceRegion other = region(p);
    for (const PieceRegion::Side& side : other.sides()) {
        common.clip(side.line, side.tag);
        if (common.empty()) break;
    }
    return common;
}

void SortPieces::split(std::uint32_t n, std::uint32_t cutter) {
    ++counts[SortCount::splits];
    const std::uint32_t face = nodes_[n].face;
    tell(StepKind::polygon_split, n, cutter);
    const PageLine deeper = line_where_deeper(faces_[face].plane, faces_[cutter].plane);
    PieceRegion behind = region(n);
    PieceRegion in_front = behind;
    behind.clip(deeper, {cutter, true});
    in_front.clip(deeper.reversed(), {cutter, false});
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    std::vector<std::uint32_t>& pieces = pieces_of_[face];
    std::erase(pieces, n);
    for (PieceRegion* part : {&behind, &in_front}) {
        const PageBox box{part->bounds(nodes_[n].box), nodes_[n].box.far};
        const auto number = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({face, State::waiting, 0, std::move(*part), box});
        if (covers_samples(number))
            pieces.push_back(number);
        else
            nodes_[number].state = State::painted;
    }
    nodes_[n].state = State::split;
    nodes_[n].place = child;
    nodes_[n].conflicts = {};
    nodes_[n].region = {};
}

bool SortPieces::covers_samples(std::uint32_t n) {
    if (grid_ == nullptr) return true;
    const SampleUnits units(*grid_, screen_.subpixel_bits());
    const PageBox& box = nodes_[n].box;
    const std::int32_t top = std::max(0, units.first_from(box.y0)),
                       bottom = std::min(units.rows - 1, units.last_until(box.y1));
    const std::int32_t left = std::max(0, units.first_from(box.x0)),
                       right = std::min(units.columns - 1, units.last_until(box.x1));
    if (top > bottom || left > right) return false;
    constexpr std::int32_t kFewRows = 16;  // for larger ones the question costs more than it saves
    if (bottom - top >= kFewRows) return true;
    std::vector<PlaneCut>& cuts = scratch_;
    cuts.clear();
    const Piece piece = to_piece(n, cuts);
    const std::uint32_t id = face_of(n).id;
    const Corners c = screen_.corners(piece.triangle);
    RowTriangle rows(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z), units, top);
    for (; !rows.empty() && rows.row() <= bottom; rows.advance(units)) {
        const Stretch stretch{rows.left(), rows.right()};
        if (stretch.first >= stretch.end) continue;
        const Stretch left_over = cut_judge_->narrow(id, cuts, rows.row(), stretch);
        if (left_over.first < left_over.end) return true;
    }
    return false;
}

Piece SortPieces::to_piece(std::uint32_t n, std::vector<PlaneCut>& cuts) const {
    Piece piece{face_of(n).number, static_cast<std::uint32_t>(cuts.size()), 0};
    for (const PieceRegion::Side& side : nodes_[n].region.sides()) {
        if (side.tag.cutter == kNone) continue;
        cuts.push_back({faces_[side.tag.cutter].id, side.tag.behind});
    }
    piece.end_cut = static_cast<std::uint32_t>(cuts.size());
    return piece;
}

bool SortPieces::paint(std::uint32_t n) {
    Node& node = nodes_[n];
    node.state = State::painted;
    node.conflicts = {};
    sorted.pieces.push_back(to_piece(n, sorted.cuts));
    if (observer_ != nullptr) observer_->step({StepKind::polygon_painted, face_of(n).id});
    if (n == node.face) return true;
    std::vector<std::uint32_t>& pieces = pieces_of_[node.face];
    std::erase(pieces, n);
    return pieces.empty();
}

}  // namespace sightline
