#include "drawing/horizon.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

/// Heights that differ by less than what rounding may do to them touch: a line from or to a corner
/// of the horizon is neither above nor below it there. The sum of the four heights times this
/// bounds the error of two interpolations, three roundings each.
constexpr double kRounding = 0x1p-50;

}  // namespace

Horizon::Horizon(double from, double to)
    : from_(from),
      to_(to),
      hints_per_u_(double{kHints} / (to - from)),
      hints_(kHints, 0),
      noted_(kHints, -INFINITY) {
    pieces_.push_back({from, {0, 0, 0, 0, 0}, kNo, 1, true, true});
    pieces_.push_back({to, {0, 0, 0, 0, 0}, 0, kNo, true, true});
}

Horizon::Part Horizon::part_above(const Slope& line, const Piece& piece, double from, double to,
                                  Ties ties) {
    if (piece.empty) return {from, to};
    const Slope& old = piece.line;
    const double slack =
        kRounding * (std::abs(line.v0) + std::abs(line.v1) + std::abs(old.v0) + std::abs(old.v1));
    const double at_from = line.at(from) - old.at(from), at_to = line.at(to) - old.at(to);
    const bool tie = std::abs(at_from) <= slack && std::abs(at_to) <= slack;
    if (tie) return ties == Ties::above ? Part{from, to} : Part{0, 0};
    if (at_from <= slack && at_to <= slack) return {0, 0};
    if (at_from >= -slack && at_to >= -slack) return {from, to};
    const double cross = std::clamp(from + (to - from) * (at_from / (at_from - at_to)), from, to);
    return at_from > at_to ? Part{from, cross} : Part{cross, to};
}

Horizon::Index Horizon::find(double u) const {
    Index p = cursor_;
    for (int steps = 0; steps < 8; ++steps) {
        if (pieces_[p].u > u) {
            p = pieces_[p].prev;
        } else if (end_of(p) <= u) {
            p = pieces_[p].next;
        } else {
            return cursor_ = p;
        }
    }
    const std::size_t slot = hint_of(u);
    if (pieces_[hints_[slot]].alive) p = hints_[slot];
    while (pieces_[p].u > u) p = pieces_[p].prev;
    while (end_of(p) <= u) p = pieces_[p].next;
    return cursor_ = hints_[slot] = p;
}

std::optional<double> Horizon::at(double u) const {
    if (!(u >= from_ && u <= to_)) return std::nullopt;
    // At the end of everything there is no piece that begins.
    const Index p = u < to_ ? find(u) : pieces_[find(std::nextafter(to_, from_))].next;
    std::optional<double> height;
    const auto look = [&](Index piece) {
        if (piece == kNo || pieces_[piece].empty) return;
        const double v = pieces_[piece].line.at(u);
        if (!height || v > *height) height = v;
    };
    if (u < to_) look(p);
    if (pieces_[p].u == u) look(pieces_[p].prev);
    return height;
}

void Horizon::note_heights() {
    std::fill(noted_.begin(), noted_.end(), INFINITY);
    for (Index p = head_; pieces_[p].next != kNo; p = pieces_[p].next) {
        const Piece& piece = pieces_[p];
        const double end = end_of(p);
        const double low =
            piece.empty ? -INFINITY : std::min(piece.line.at(piece.u), piece.line.at(end));
        const std::size_t last = hint_of(end);
        for (std::size_t k = hint_of(piece.u); k <= last; ++k) noted_[k] = std::min(noted_[k], low);
    }
}

void Horizon::clear(double from, double to) {
    const Part over{std::max(from, from_), std::min(to, to_)};
    if (over.none()) return;
    const Index first = find(over.from);
    Index last = first;
    while (end_of(last) < over.to) last = pieces_[last].next;
    replace(first, last, over, {0, 0, 0, 0, 0}, true);
    for (std::size_t k = hint_of(over.from); k <= hint_of(over.to); ++k) noted_[k] = -INFINITY;
}

Horizon::Index Horizon::make(const Piece& piece) {
    if (free_ == kNo) {
        pieces_.push_back(piece);
        return static_cast<Index>(pieces_.size() - 1);
    }
    const Index made = free_;
    free_ = pieces_[made].next;
    pieces_[made] = piece;
    return made;
}

void Horizon::remove(Index piece) {
    pieces_[piece].alive = false;
    pieces_[piece].next = free_;
    free_ = piece;
}

void Horizon::replace(Index first, Index last, Part over, const Slope& line, bool empty) {
    Index after = pieces_[last].next;
    if (over.to < pieces_[after].u) {  // what is left of the last one
        const Piece rest = pieces_[last];
        const Index made = make({over.to, rest.line, kNo, after, rest.empty, true});
        pieces_[after].prev = made;
        after = made;
    }
    const bool keeps_first = pieces_[first].u < over.from;
    const Index before = keeps_first ? first : pieces_[first].prev;
    for (Index p = keeps_first && first != last ? pieces_[first].next : first;;) {
        const Index next = pieces_[p].next;
        const bool done = p == last;
        if (!(keeps_first && p == first)) remove(p);
        if (done) break;
        p = next;
    }
    const Index made = make({over.from, line, before, after, empty, true});
    (before == kNo ? head_ : pieces_[before].next) = made;
    pieces_[after].prev = made;
    cursor_ = made;
}

}  // namespace sightline
