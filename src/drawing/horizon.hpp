// The floating horizon itself: the upper envelope of what has been drawn so far, as an exact
// piecewise linear function that grows from front to back.
//
// Source: T. J. Wright, "A two-space solution to the hidden line problem for plotting functions of
// two variables", IEEE Transactions on Computers C-22 (1973), 28-33; S. L. Watkins, "Masked
// three-dimensional plot program with rotations", CACM 17 (1974), 520-523, algorithm 483. They keep
// an array of heights, one for each column of the picture, and lose what happens between columns.
// Here a horizon is a list of pieces, each a part of the very line that was drawn, so a crossing is
// where two lines cross and a corner stays a corner.
//
// A horizon begins at minus infinity (a piece without a line), so the first curve is seen whole.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

namespace sightline {

/// A straight line over u0..u1; u0 <= u1.
struct Slope {
    double u0, v0, u1, v1;
    double per_u = 1 / (u1 - u0);

    /// Exact at both ends.
    [[nodiscard]] double at(double u) const {
        if (u <= u0) return v0;
        if (u >= u1) return v1;
        const double t = (u - u0) * per_u;
        return (1 - t) * v0 + t * v1;
    }
    [[nodiscard]] Slope upside_down() const { return {u0, -v0, u1, -v1, per_u}; }
};

/// The line between two points (u, v).
[[nodiscard]] inline Slope slope_of(glm::dvec2 a, glm::dvec2 b) {
    return a.x <= b.x ? Slope{a.x, a.y, b.x, b.y} : Slope{b.x, b.y, a.x, a.y};
}

/// A part of a line over from..to, for those who are told of it.
struct Overlap {
    double from, to;
    bool first;  ///< there was nothing before
};

class Horizon {
public:
    /// Nothing yet over from..to. Lines outside of it are left alone.
    Horizon(double from, double to);

    /// Whether a line that lies on the horizon counts as above it.
    enum class Ties { below, above };

    /// Tells of the parts of a line that are above the horizon, from left to right. Neighbours may
    /// touch.
    template <class Tell>
    void above(const Slope& line, const Tell& tell, Ties ties = Ties::below) const;
    /// The same (ties are below), and then the horizon is where the line was above it.
    template <class Tell>
    void raise(const Slope& line, const Tell& tell);
    void raise(const Slope& line) {
        raise(line, [](const Overlap&) {});
    }
    /// Takes note of how high it is, roughly, so that lines far below are dismissed at once. It
    /// never sinks but by clear(), so what is noted stays true.
    void note_heights();
    /// Height at u, the greater one where it jumps; nothing where nothing is.
    [[nodiscard]] std::optional<double> at(double u) const;
    /// Forgets what is over from..to.
    void clear(double from, double to);
    /// Calls visit(from, to, line) for the pieces over from..to; the line is null where nothing is.
    template <class Visit>
    void each(double from, double to, const Visit& visit) const;

    [[nodiscard]] double from() const { return from_; }
    [[nodiscard]] double to() const { return to_; }

private:
    using Index = std::uint32_t;
    static constexpr Index kNo = 0xFFFFFFFFu;
    static constexpr std::size_t kHints = 256;

    /// From u to where the next one begins.
    struct Piece {
        double u;
        Slope line;
        Index prev, next;
        bool empty, alive;
    };
    struct Part {
        double from, to;
        [[nodiscard]] bool none() const { return !(from < to); }
    };

    /// The part of a line that is above a piece, over from..to, where both are straight.
    static Part part_above(const Slope& line, const Piece& piece, double from, double to,
                           Ties ties = Ties::below);
    [[nodiscard]] double end_of(Index piece) const { return pieces_[pieces_[piece].next].u; }
    /// Whether a line is below all that was noted.
    [[nodiscard]] bool is_far_below(const Slope& line) const {
        const double highest = std::max(line.v0, line.v1);
        const std::size_t last = hint_of(line.u1);
        std::size_t k = hint_of(line.u0);
        while (k <= last && highest <= noted_[k]) ++k;
        return k > last;
    }
    /// The piece over [u, ...). Lines come in order, so it is near the one that was found last.
    [[nodiscard]] Index find(double u) const;
    [[nodiscard]] std::size_t hint_of(double u) const {
        return static_cast<std::size_t>(
            std::clamp((u - from_) * hints_per_u_, 0.0, double{kHints - 1}));
    }
    /// Puts one piece over from..to, which begins in piece `first` and ends in piece `last`.
    void replace(Index first, Index last, Part over, const Slope& line, bool empty);
    Index make(const Piece& piece);
    void remove(Index piece);

    double from_, to_, hints_per_u_;
    std::vector<Piece> pieces_;  // a list in ascending order; the last one only marks the end
    Index free_ = kNo;           // a list of pieces that are not used, through `next`
    Index head_ = 0;
    mutable Index cursor_ = 0;
    mutable std::vector<Index> hints_;  // where a search may begin; some are no longer alive
    std::vector<double> noted_;         // no more than the height, of equal parts of the width
};

// -- templates ------------------------------------------------------------------------------------

template <class Tell>
void Horizon::above(const Slope& line, const Tell& tell, Ties ties) const {
    const double begin = std::max(line.u0, from_), end = std::min(line.u1, to_);
    if (!(begin < end) || (ties == Ties::below && is_far_below(line))) return;
    Index p = find(begin);
    for (double u = begin; u < end; p = pieces_[p].next) {
        const double stop = std::min(end, end_of(p));
        const Part part = part_above(line, pieces_[p], u, stop, ties);
        if (!part.none()) tell(Overlap{part.from, part.to, pieces_[p].empty});
        u = stop;
    }
}

template <class Tell>
void Horizon::raise(const Slope& line, const Tell& tell) {
    const double begin = std::max(line.u0, from_), end = std::min(line.u1, to_);
    if (!(begin < end) || is_far_below(line)) return;
    Part open{0, 0};  // a part above that may go on in the next piece
    Index first = kNo, last = kNo;
    const auto close = [&] {
        if (first != kNo) replace(first, last, open, line, false);
        first = kNo;
    };
    Index p = find(begin);
    for (double u = begin; u < end;) {
        const double stop = std::min(end, end_of(p));
        const Index next = pieces_[p].next;
        const Part part = part_above(line, pieces_[p], u, stop);
        if (!part.none()) tell(Overlap{part.from, part.to, pieces_[p].empty});
        if (part.none() || (first != kNo && part.from > open.to)) close();
        if (!part.none()) {
            if (first == kNo) {
                first = p;
                open.from = part.from;
            }
            last = p;
            open.to = part.to;
        }
        u = stop;
        p = next;
    }
    close();
}

template <class Visit>
void Horizon::each(double from, double to, const Visit& visit) const {
    const double begin = std::max(from, from_), end = std::min(to, to_);
    if (!(begin < end)) return;
    Index p = find(begin);
    for (double u = begin; u < end; p = pieces_[p].next) {
        const double stop = std::min(end, end_of(p));
        visit(u, stop, pieces_[p].empty ? nullptr : &pieces_[p].line);
        u = stop;
    }
}

}  // namespace sightline
