// The second stage of Warnock's subdivision: one quadrant of the first level, divided until every
// part of it is simple.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/visibility.hpp"
#include "visibility/counts.hpp"
#include "visibility/sampled_plane.hpp"
#include "visibility/warnock_block.hpp"
#include "visibility/warnock_shape.hpp"

namespace sightline::warnock {

/// A square of 2^bits samples a side; what lies outside of the picture does not count.
struct Quadrant {
    std::int32_t i = 0, j = 0;  ///< first sample
    int bits = 0;

    [[nodiscard]] Rect samples(const SampleUnits& units) const {
        const std::int32_t last = (std::int32_t{1} << bits) - 1;
        return {i, j, std::min(i + last, units.columns - 1), std::min(j + last, units.rows - 1)};
    }
};

/// What was done below the first level, in the order of the report.
enum class Count : std::uint8_t {
    set_up,
    subdivisions,
    empty,
    single,
    surrounded,
    in_front,
    direct,
    disjoint,  // the four kinds of Relation
    intersecting,
    contained,
    surrounding,
    hidden,
    comparisons,
    exact
};

inline constexpr std::array kCountNames{
    CountName{"triangles handed to quadrants"},
    CountName{"subdivisions"},
    CountName{"quadrants that are empty"},
    CountName{"quadrants with one triangle"},
    CountName{"quadrants with one surrounding triangle"},
    CountName{"quadrants with a surrounding triangle in front"},
    CountName{"quadrants decided by sample"},
    CountName{"triangles classified disjoint"},
    CountName{"triangles classified intersecting"},
    CountName{"triangles classified contained"},
    CountName{"triangles classified surrounding"},
    CountName{"triangles hidden in quadrants"},
    CountName{"depth comparisons"},
    CountName{"exact comparisons"},
};

/// Divides quadrants of the first level, one after another; each thread has one of its own.
class Subdivider {
public:
    using Counts = sightline::Counts<Count, kCountNames>;

    /// Quadrants of 2^direct_bits samples a side, at most those of a Block, are not divided. `out`
    /// outlives this.
    Subdivider(const ScreenScene& screen, const SampleUnits& units, Observer* observer,
               int direct_bits, Visibility& out);

    /// Decides all samples of a quadrant, in which nothing is seen but the triangles with these
    /// numbers.
    void run(const Quadrant& quadrant, std::span<const std::uint32_t> numbers);

    [[nodiscard]] Counts counts() const;

private:
    struct Item {
        Shape shape;
        SampledPlane surface;
        std::uint32_t number = kNone;
    };
    struct Survivors {
        std::size_t first = 0;       // in lists_; they reach to its end
        bool hidden_behind = false;  // others were dropped: they lie behind a surrounding one
    };

    void set_up(std::span<const std::uint32_t> numbers, const Rect& quadrant);
    void add(std::uint32_t number, const Rect& quadrant);
    void take(const Quadrant& quadrant, std::size_t begin, std::size_t end);
    void split(const Quadrant& quadrant, std::size_t begin, std::size_t end);
    Survivors triage(const Rect& r, std::size_t begin, std::size_t end);
    bool sweep(const Rect& r, std::size_t first, std::uint32_t& hider);
    bool hides(const Item& a, const Item& b, const Rect& r);
    void tell(StepKind kind, std::uint32_t triangle, std::uint32_t other, const Rect& r) const;

    void fill(const Rect& r, const Item* owner);
    void scan(const Rect& r, const Item& item);
    void decide_directly(const Rect& r, std::size_t begin, std::size_t end);
    void offer(std::uint32_t index, const Rect& r, double slack, Block& block);
    void write(const Block& block, const Rect& r);

    [[nodiscard]] std::uint32_t* id_row(std::int32_t j) {
        return out_.ids.data() + static_cast<std::size_t>(j) * out_.grid.columns();
    }
    [[nodiscard]] float* depth_row(std::int32_t j) {
        return out_.depth.data() + static_cast<std::size_t>(j) * out_.grid.columns();
    }

    const ScreenScene& screen_;
    SampleUnits units_;
    Observer* observer_;
    int direct_bits_;
    Visibility& out_;
    DepthJudge judge_;
    Counts counts_;
    std::vector<Item> items_;
    std::vector<Rect> boxes_;  // of the items, inside of the quadrant of the first level
    // A stack of lists: a quadrant's list lies above those of the quadrants that it is a part of.
    // An entry is the index of an item, and whether that surrounds the quadrant.
    std::vector<std::uint32_t> lists_;
};

}  // namespace sightline::warnock
