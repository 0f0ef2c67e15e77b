// What one surface hides, column by column of the page: all between its lower and its upper
// horizon.
//
// Where a surface has a gap (a hole, a jump) one can look through between what is before the gap
// and what is behind it. What is before it then is set aside as trapezoids ("bands"), and both
// horizons begin anew.
#pragma once

#include <vector>

#include "drawing/horizon.hpp"

namespace sightline {

/// Which side of the surface a part of a line shows: where nothing is in front, either.
enum class Side : std::uint8_t { upper, lower, either };

/// A part of a line that can be seen: from parameter t0 to t1 > t0 of it.
struct Seen {
    double t0, t1;
    Side side;
};

class Skyline {
public:
    Skyline(double from, double to) : upper_(from, to), lower_(from, to), buckets_(kBuckets) {}

    /// Appends the parts of a line that are not hidden, in ascending order. A line straight up (u0
    /// = u1) is looked at there, where it is.
    void see(const Slope& line, std::vector<Seen>& out, Horizon::Ties ties = Horizon::Ties::below);
    /// The line hides from now on. Straight up it hides nothing: its neighbours do.
    void raise(const Slope& line);
    /// Both at once.
    void see_and_raise(const Slope& line, std::vector<Seen>& out);
    /// See Horizon.
    void note_heights() {
        upper_.note_heights();
        lower_.note_heights();
    }
    /// The surface ends over from..to: what it hid it goes on hiding, and what comes begins anew.
    void set_aside(double from, double to);

    /// Whether both u are too near to each other for a slope.
    [[nodiscard]] bool is_upright(glm::dvec2 u) const {
        return std::abs(u.y - u.x) <= kUpright * (upper_.to() - upper_.from());
    }
    [[nodiscard]] const Horizon& upper() const { return upper_; }

private:
    static constexpr double kUpright = 1e-12;
    static constexpr std::size_t kBuckets = 512;

    struct Band {
        double from, to;
        Slope high, low;
    };

    void see_upright(const Slope& line, std::vector<Seen>& out) const;
    template <class Walk>
    void collect(const Slope& line, std::vector<Seen>& out, const Walk& walk);
    void behind_bands(const Slope& line, std::vector<Seen>& seen) const;
    [[nodiscard]] std::size_t bucket_of(double u) const;

    Horizon upper_, lower_;  // the lower one upside down
    bool has_bands_ = false;
    std::vector<std::vector<Band>> buckets_;  // those that lie over a part of the width
};

}  // namespace sightline
