#include "drawing/skyline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline {
namespace {

double param(const Slope& line, double u) {
    if (u <= line.u0) return 0;
    if (u >= line.u1) return 1;
    return (u - line.u0) / (line.u1 - line.u0);
}

/// Takes t0..t1 out of the parts from `begin` on.
void cut_out(std::vector<Seen>& parts, std::size_t begin, double t0, double t1) {
    for (std::size_t k = begin; k < parts.size(); ++k) {
        Seen& part = parts[k];
        if (part.t1 <= t0 || part.t0 >= t1) continue;
        if (part.t0 < t0 && part.t1 > t1) {
            const Seen rest{t1, part.t1, part.side};
            part.t1 = t0;
            parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(k) + 1, rest);
            ++k;
        } else if (part.t0 < t0) {
            part.t1 = t0;
        } else if (part.t1 > t1) {
            part.t0 = t1;
        } else {
            parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(k));
            --k;
        }
    }
}

/// Where a line is below another one, as an interval of u inside from..to (empty: from >= to).
std::array<double, 2> below(const Slope& line, const Slope& other, double from, double to) {
    const double a = other.at(from) - line.at(from), b = other.at(to) - line.at(to);
    if (a <= 0 && b <= 0) return {to, from};
    if (a >= 0 && b >= 0) return {from, to};
    const double cross = from + (to - from) * (a / (a - b));
    return a > 0 ? std::array{from, cross} : std::array{cross, to};
}

}  // namespace

/// Joins what both horizons tell. Where nothing was before, only the upper one is asked.
template <class Walk>
void Skyline::collect(const Slope& line, std::vector<Seen>& out, const Walk& walk) {
    const std::size_t begin = out.size();
    const auto tell = [&](const Overlap& part, Side side) {
        const double t0 = param(line, part.from), t1 = param(line, part.to);
        if (!(t0 < t1)) return;
        if (out.size() > begin && out.back().side == side && out.back().t1 == t0) {
            out.back().t1 = t1;
        } else {
            out.push_back({t0, t1, side});
        }
    };
    walk(upper_, line,
         [&](const Overlap& part) { tell(part, part.first ? Side::either : Side::upper); });
    walk(lower_, line.upside_down(), [&](const Overlap& part) {
        if (!part.first) tell(part, Side::lower);
    });
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(),
              [](const Seen& a, const Seen& b) { return a.t0 < b.t0; });
    if (has_bands_) behind_bands(line, out);
}

void Skyline::see(const Slope& line, std::vector<Seen>& out, Horizon::Ties ties) {
    out.clear();
    if (is_upright({line.u0, line.u1})) return see_upright(line, out);
    collect(line, out, [ties](const Horizon& horizon, const Slope& slope, const auto& tell) {
        horizon.above(slope, tell, ties);
    });
}

void Skyline::see_and_raise(const Slope& line, std::vector<Seen>& out) {
    out.clear();
    if (is_upright({line.u0, line.u1})) return see_upright(line, out);
    collect(line, out, [](Horizon& horizon, const Slope& slope, const auto& tell) {
        horizon.raise(slope, tell);
    });
}

void Skyline::raise(const Slope& line) {
    if (is_upright({line.u0, line.u1})) return;
    upper_.raise(line);
    lower_.raise(line.upside_down());
}

void Skyline::see_upright(const Slope& line, std::vector<Seen>& out) const {
    const double u = line.u0, length = line.v1 - line.v0;
    if (!(u >= upper_.from() && u <= upper_.to()) || length == 0) return;
    const auto t_of = [&](double v) { return std::clamp((v - line.v0) / length, 0.0, 1.0); };
    const auto high = upper_.at(u), low = lower_.at(u);
    const bool up = length > 0;
    if (!high || !low) {
        out.push_back({0, 1, Side::either});
    } else {
        const double above = t_of(*high), under = t_of(-*low);
        const Seen upper = up ? Seen{above, 1, Side::upper} : Seen{0, above, Side::upper};
        const Seen lower = up ? Seen{0, under, Side::lower} : Seen{under, 1, Side::lower};
        for (const Seen& part : up ? std::array{lower, upper} : std::array{upper, lower})
            if (part.t0 < part.t1) out.push_back(part);
    }
    if (!has_bands_) return;
    for (const Band& band : buckets_[bucket_of(u)]) {
        if (!(u >= band.from && u <= band.to)) continue;
        const double a = t_of(band.low.at(u)), b = t_of(band.high.at(u));
        cut_out(out, 0, std::min(a, b), std::max(a, b));
    }
}

// -- gaps -----------------------------------------------------------------------------------------

std::size_t Skyline::bucket_of(double u) const {
    const double share = (u - upper_.from()) / (upper_.to() - upper_.from());
    return static_cast<std::size_t>(
        std::clamp(share * static_cast<double>(kBuckets), 0.0, static_cast<double>(kBuckets - 1)));
}

void Skyline::set_aside(double from, double to) {
    upper_.each(from, to, [&](double a, double b, const Slope* high) {
        if (high == nullptr) return;
        lower_.each(a, b, [&](double c, double d, const Slope* low) {
            if (low == nullptr) return;
            const Band band{c, d, *high, low->upside_down()};
            const std::size_t last = bucket_of(d);
            for (std::size_t k = bucket_of(c); k <= last; ++k) buckets_[k].push_back(band);
            has_bands_ = true;
        });
    });
    upper_.clear(from, to);
    lower_.clear(from, to);
}

void Skyline::behind_bands(const Slope& line, std::vector<Seen>& seen) const {
    const std::size_t last = bucket_of(line.u1);
    for (std::size_t k = bucket_of(line.u0); k <= last && !seen.empty(); ++k) {
        for (const Band& band : buckets_[k]) {
            const double from = std::max(line.u0, band.from), to = std::min(line.u1, band.to);
            if (!(from < to)) continue;
            const auto under = below(line, band.high, from, to);
            const auto over = below(band.low, line, from, to);
            const double a = std::max(under[0], over[0]), b = std::min(under[1], over[1]);
            if (a < b) cut_out(seen, 0, param(line, a), param(line, b));
        }
    }
}

}  // namespace sightline
