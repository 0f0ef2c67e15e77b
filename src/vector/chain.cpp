// Segments joined into paths: a walk over the graph of each layer.
//
// Notation: a *part* is a segment of DrawnLines, a *vertex* a point at which parts end (points are
// one vertex when their coordinates are equal), a *layer* the parts of one visibility, kind and
// object.
//
// A walk goes on until no unused part is left where it stands. It begins at vertices of odd degree
// first: with 2k of those, k paths end at them and no cover has fewer; every other walk returns to
// its beginning. At a junction it takes the part that turns it least, so that long smooth curves
// stay whole; of very many parts only some are looked at, which bounds the work.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

#include "sightline/scene.hpp"
#include "sightline/vector.hpp"
#include "vector/pen_order.hpp"

namespace sightline {
namespace {

/// Points and their numbers, in the order in which they come: an open-addressed table.
class Vertices {
public:
    explicit Vertices(std::size_t most) : slots_(std::bit_ceil(2 * most + 2), kNone) {}

    std::uint32_t number_of(glm::dvec2 point) {
        point += 0.0;  // -0 equals 0
        const std::size_t mask = slots_.size() - 1;
        std::size_t slot = hash(point) & mask;
        for (; slots_[slot] != kNone; slot = (slot + 1) & mask) {
            if (points_[slots_[slot]] == point) return slots_[slot];
        }
        slots_[slot] = static_cast<std::uint32_t>(points_.size());
        points_.push_back(point);
        return slots_[slot];
    }
    [[nodiscard]] glm::dvec2 operator[](std::uint32_t vertex) const { return points_[vertex]; }
    [[nodiscard]] std::size_t size() const { return points_.size(); }

private:
    static std::size_t hash(glm::dvec2 point) {
        // Odd multipliers (of the golden ratio and of SplitMix64), and the high bits folded down:
        // coordinates on a grid differ in their high bits alone.
        std::uint64_t h = std::bit_cast<std::uint64_t>(point.x) * 0x9E3779B97F4A7C15u;
        h = (h ^ h >> 32 ^ std::bit_cast<std::uint64_t>(point.y)) * 0xBF58476D1CE4E5B9u;
        return h ^ h >> 32;
    }

    std::vector<std::uint32_t> slots_;
    std::vector<glm::dvec2> points_;
};

struct Ends {
    std::uint32_t from, to;
};

/// A part and what it is sorted by.
struct Keyed {
    std::uint64_t key;
    std::uint32_t part;
};

/// Stable; digit by digit from the lowest. Digits in which all keys agree, the most of them here,
/// cost nothing but a count.
void sort_by_key(std::vector<Keyed>& all) {
    constexpr int kBits = 11;
    constexpr std::size_t kDigits = std::size_t{1} << kBits;
    std::vector<Keyed> other(all.size());
    for (int shift = 0; shift < 64; shift += kBits) {
        const auto digit = [shift](const Keyed& k) { return k.key >> shift & (kDigits - 1); };
        std::array<std::size_t, kDigits> next{};
        for (const Keyed& k : all) ++next[digit(k)];
        if (!all.empty() && next[digit(all.front())] == all.size()) continue;
        std::exclusive_scan(next.begin(), next.end(), next.begin(), std::size_t{0});
        for (const Keyed& k : all) other[next[digit(k)]++] = k;
        all.swap(other);
    }
}

/// Which of two parts between the same vertices is drawn: the visible one, then the one of the
/// lower kind, then the first.
bool goes_before(const DrawnLines& lines, std::uint32_t a, std::uint32_t b) {
    const auto rank = [&](std::uint32_t i) {
        return std::tuple(lines.visible[i] == 0, lines.kind[i], i);
    };
    return rank(a) < rank(b);
}

/// The parts, each stretch between two vertices once.
std::vector<Keyed> unique_parts(const DrawnLines& lines, const std::vector<Ends>& ends) {
    std::vector<Keyed> parts(lines.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const auto [low, high] = std::minmax(ends[i].from, ends[i].to);
        parts[i] = {std::uint64_t{low} << 32 | high, i};
    }
    sort_by_key(parts);
    std::size_t count = 0;
    for (const Keyed& p : parts) {
        if (count == 0 || parts[count - 1].key != p.key) {
            parts[count++] = p;
        } else if (goes_before(lines, p.part, parts[count - 1].part)) {
            parts[count - 1] = p;
        }
    }
    parts.resize(count);
    return parts;
}

/// Puts the parts in the order of their layers, hidden ones first.
void sort_by_layer(const DrawnLines& lines, std::vector<Keyed>& parts) {
    for (Keyed& p : parts) {
        const std::uint64_t visible = lines.visible[p.part] != 0 ? 1 : 0;
        const auto kind = static_cast<std::uint64_t>(lines.kind[p.part]);
        p.key = visible << 40 | kind << 32 | lines.object[p.part];
    }
    sort_by_key(parts);
}

/// Walks over one layer after the other.
class Walker {
public:
    Walker(const std::vector<Ends>& ends, const Vertices& vertices, Paths& out)
        : ends_(ends),
          vertices_(vertices),
          out_(out),
          used_(ends.size(), 0),
          local_(vertices.size(), kNone) {}

    /// Makes the paths of a layer. `begin_path` is called before each.
    template <class BeginPath>
    void walk_layer(const Keyed* begin, const Keyed* end, const BeginPath& begin_path) {
        build(begin, end);
        const auto count = static_cast<std::uint32_t>(corners_.size());
        for (std::uint32_t v = 0; v < count; ++v) {
            if (corners_[v].degree % 2 == 1) walk(v, begin_path);
        }
        for (std::uint32_t v = 0; v < count; ++v) {
            while (corners_[v].degree > 0) walk(v, begin_path);
        }
        for (const Corner& c : corners_) local_[c.vertex] = kNone;
    }

private:
    /// A vertex as the layer sees it; its parts are steps_[first .. last), used ones among them.
    struct Corner {
        std::uint32_t vertex = 0, degree = 0;
        std::size_t first = 0, last = 0;
    };
    struct Step {
        std::uint32_t part, to;  ///< `to` is a corner
    };
    /// So many unused parts of a junction are looked at, lest a fan of n parts take n^2 looks.
    static constexpr int kLooks = 32;

    std::uint32_t corner_of(std::uint32_t vertex) {
        if (local_[vertex] == kNone) {
            local_[vertex] = static_cast<std::uint32_t>(corners_.size());
            corners_.push_back({vertex});
        }
        return local_[vertex];
    }

    void build(const Keyed* begin, const Keyed* end) {
        corners_.clear();
        for (const Keyed* p = begin; p != end; ++p) {
            ++corners_[corner_of(ends_[p->part].from)].degree;
            ++corners_[corner_of(ends_[p->part].to)].degree;
        }
        std::size_t next = 0;
        for (Corner& c : corners_) {
            c.first = c.last = next;
            next += c.degree;
        }
        steps_.resize(next);
        for (const Keyed* p = begin; p != end; ++p) {
            const std::uint32_t a = local_[ends_[p->part].from], b = local_[ends_[p->part].to];
            steps_[corners_[a].last++] = {p->part, b};
            steps_[corners_[b].last++] = {p->part, a};
        }
    }

    [[nodiscard]] glm::dvec2 point(std::uint32_t corner) const {
        return vertices_[corners_[corner].vertex];
    }

    /// The step that turns least from `heading`, of the first few unused; forgets used ones.
    const Step* choose(std::uint32_t at, glm::dvec2 heading) {
        Corner& c = corners_[at];
        const Step* best = nullptr;
        double straightest = 0;
        for (std::size_t i = c.first; i < c.last && i < c.first + kLooks;) {
            if (used_[steps_[i].part] != 0) {
                steps_[i] = steps_[--c.last];
                continue;
            }
            if (c.degree == 1) return &steps_[i];
            const glm::dvec2 way = point(steps_[i].to) - point(at);
            const double cosine = glm::dot(heading, way) / std::sqrt(glm::dot(way, way));
            if (best == nullptr || cosine > straightest) {
                best = &steps_[i];
                straightest = cosine;
            }
            ++i;
        }
        return best;
    }

    template <class BeginPath>
    void walk(std::uint32_t at, const BeginPath& begin_path) {
        begin_path();
        glm::dvec2 heading(0);
        while (corners_[at].degree > 0) {
            const Step step = *choose(at, heading);
            used_[step.part] = 1;
            --corners_[at].degree;
            --corners_[step.to].degree;
            out_.points.push_back(point(at));
            out_.part.push_back(step.part);
            heading = point(step.to) - point(at);
            at = step.to;
        }
        out_.points.push_back(point(at));
        out_.part.push_back(kNone);
    }

    const std::vector<Ends>& ends_;
    const Vertices& vertices_;
    Paths& out_;
    std::vector<std::uint8_t> used_;
    std::vector<std::uint32_t> local_;  // corners of vertices, kNone outside of the layer
    std::vector<Corner> corners_;
    std::vector<Step> steps_;
};

void walk_all(const DrawnLines& lines, const std::vector<Keyed>& parts, Walker& walker,
              Paths& out) {
    for (std::size_t begin = 0; begin < parts.size();) {
        std::size_t end = begin + 1;
        while (end < parts.size() && parts[end].key == parts[begin].key) ++end;
        const std::uint32_t first = parts[begin].part;
        walker.walk_layer(&parts[begin], parts.data() + end, [&] {
            out.kind.push_back(lines.kind[first]);
            out.visible.push_back(lines.visible[first] != 0 ? 1 : 0);
            out.object.push_back(lines.object[first]);
            out.first_point.push_back(static_cast<std::uint32_t>(out.points.size()));
        });
        begin = end;
    }
    out.first_point.push_back(static_cast<std::uint32_t>(out.points.size()));
}

}  // namespace

Paths chain(const DrawnLines& lines, bool sorted) {
    Vertices vertices(2 * lines.size());
    std::vector<Ends> ends(lines.size());
    for (std::size_t i = 0; i < ends.size(); ++i) {
        ends[i].from = vertices.number_of(lines.from[i]);
        ends[i].to = vertices.number_of(lines.to[i]);
    }
    std::vector<Keyed> parts = unique_parts(lines, ends);
    sort_by_layer(lines, parts);
    Paths paths;
    paths.points.reserve(parts.size() + parts.size() / 4);
    paths.part.reserve(parts.size() + parts.size() / 4);
    Walker walker(ends, vertices, paths);
    walk_all(lines, parts, walker, paths);
    return sorted ? in_pen_order(paths) : paths;
}

}  // namespace sightline
