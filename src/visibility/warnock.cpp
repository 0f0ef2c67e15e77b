// Warnock's subdivision: where a part of the picture is simple it is decided at once, elsewhere it
// is divided into quadrants, down to the sample.
//
// Source: J. Warnock, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures",
// University of Utah TR 4-15, 1969; J. Blinn, "Triage Tables", IEEE Computer Graphics and
// Applications 10(1), 1990.
//
// How this version differs: quadrants hold samples, coverage is integers, and "in front at the
// corners" is decided by exact depth and id, so every sample gets the canonical answer. The upper
// levels are taken in one step, on all cores: the first level is a grid of quadrants of 64 x 64
// samples. Every triangle is fetched once, by chunks; the large ones are asked first which of them
// hide a quadrant of the first level, and what lies wholly behind is dropped before it gets into
// any list. Each quadrant of the first level is then the work of one task (warnock_quadrants.cpp).
// Quadrants of 16 x 16 samples are not divided further: a list short enough is settled faster
// sample by sample. Under an observer there is one quadrant at the first level, the whole picture,
// and division goes on down to single samples, as in the textbook.
//
// Hidden surfaces behind a polygon of two triangles: along the diagonal neither surrounds a
// quadrant, but the two together do, and the farther one of them bounds what is hidden.
//
// Time O(triangles + triangle-quadrant pairs), where the pairs are those that are seen or nearly
// so; memory O(triangles + pairs of the first level) beside the picture.
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "visibility/algorithms.hpp"
#include "visibility/bins.hpp"
#include "visibility/parallel.hpp"
#include "visibility/warnock_quadrants.hpp"

namespace sightline {

namespace {

using namespace warnock;

constexpr int kFirstBits = 6;  // quadrants of the first level have 2^6 samples a side

/// A triangle whose box holds samples.
struct Candidate {
    std::uint32_t number;
    std::int32_t nearest;  ///< z of its nearest corner
    Rect box;
};

/// Consecutive triangles, the work of one task.
struct Chunk {
    std::uint32_t first = 0, end = 0;
    std::vector<Candidate> candidates;
    Bins<std::uint32_t> large;    // indices of candidates that may surround a quadrant
    Bins<std::uint32_t> numbers;  // of triangles that are not hidden, by quadrant
    std::uint64_t hidden = 0;
};

/// What hides a quadrant of the first level: nothing in it is seen beyond `depth`.
struct Hider {
    double depth = std::numeric_limits<double>::infinity();
    std::uint32_t id = kNone;
};

/// Triangles that hold a quadrant but for one edge that runs through it, and whose neighbours
/// across that edge are awaited.
class Halves {
public:
    /// Remembers a triangle whose edge p -> q is open, and how deep it reaches. Returns how deep
    /// the nearest pair reaches that it makes with one beyond that edge; infinity without such a
    /// one. Neighbours mostly follow one another, so few need to be kept.
    double join(const ScreenPoint& p, const ScreenPoint& q, double depth) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Half& half : kept_)
            if (half.used && same(half.p, q) && same(half.q, p))
                nearest = std::min(nearest, std::max(depth, half.depth));
        kept_[next_++ % kCount] = {p, q, depth, true};
        return nearest;
    }

private:
    static constexpr std::size_t kCount = 8;
    struct Half {
        ScreenPoint p{}, q{};
        double depth = 0;
        bool used = false;
    };
    static bool same(const ScreenPoint& a, const ScreenPoint& b) {
        return a.x == b.x && a.y == b.y;
    }

    Half kept_[kCount];
    std::size_t next_ = 0;
};

class Warnock {
public:
    Warnock(const ScreenScene& screen, const ResolveOptions& options, Visibility& out)
        : screen_(screen),
          options_(options),
          out_(out),
          units_(out.grid, screen.subpixel_bits()),
          bits_(options.observer == nullptr ? kFirstBits : bits_of_picture()),
          across_(quadrants(units_.columns)),
          hiders_(std::size_t{across_} * quadrants(units_.rows)) {}

    void run() {
        const std::uint32_t triangles = screen_.triangle_count();
        const std::uint32_t size = std::clamp<std::uint32_t>(triangles / 64, 2048, 16384);
        chunks_.resize((triangles + size - 1) / size);
        for (std::uint32_t c = 0; c < chunks_.size(); ++c) {
            chunks_[c].first = c * size;
            chunks_[c].end = std::min(triangles, (c + 1) * size);
        }
        const auto chunks = static_cast<std::uint32_t>(chunks_.size());
        const auto quadrants = static_cast<std::uint32_t>(hiders_.size());
        for_each_index(chunks, options_, [&](std::uint32_t c) { gather(chunks_[c]); });
        for_each_index(quadrants, options_, [&](std::uint32_t q) { find_hider(q); });
        for_each_index(chunks, options_, [&](std::uint32_t c) { sort(chunks_[c]); });
        tbb::enumerable_thread_specific<Subdivider> subdividers([&] {
            return Subdivider(screen_, units_, options_.observer,
                              options_.observer == nullptr ? kBlockBits : 0, out_);
        });
        for_each_index(quadrants, options_,
                       [&](std::uint32_t q) { divide(subdividers.local(), q); });
        Subdivider::Counts counts;
        for (const Subdivider& s : subdividers) counts += s.counts();
        report(counts);
    }

private:
    // The whole picture in one quadrant.
    [[nodiscard]] int bits_of_picture() const {
        const auto side = static_cast<std::uint32_t>(std::max(units_.columns, units_.rows));
        return static_cast<int>(std::bit_width(side - 1));
    }
    [[nodiscard]] std::uint32_t quadrants(std::int32_t samples) const {
        return static_cast<std::uint32_t>(((samples - 1) >> bits_) + 1);
    }
    [[nodiscard]] Quadrant quadrant(std::uint32_t q) const {
        return {static_cast<std::int32_t>(q % across_) << bits_,
                static_cast<std::int32_t>(q / across_) << bits_, bits_};
    }

    /// visit(q) for the quadrants of the first level that a box meets.
    template <class Visit>
    void for_each_quadrant(const Rect& box, const Visit& visit) const {
        for (std::int32_t j = box.j0 >> bits_; j <= box.j1 >> bits_; ++j)
            for (std::int32_t i = box.i0 >> bits_; i <= box.i1 >> bits_; ++i)
                visit(static_cast<std::uint32_t>(j) * across_ + static_cast<std::uint32_t>(i));
    }

    void gather(Chunk& chunk) const {
        chunk.candidates.reserve(chunk.end - chunk.first);
        for (std::uint32_t k = chunk.first; k < chunk.end; ++k) {
            if (!screen_.drawable(k)) continue;
            const Corners c = screen_.corners(k);
            const ScreenPoint &p = screen_.point(c.x), &q = screen_.point(c.y),
                              &r = screen_.point(c.z);
            const Rect box = box_of(p, q, r, units_);
            if (!box.empty()) chunk.candidates.push_back({k, std::min({p.z, q.z, r.z}), box});
        }
        // A quadrant at the border of the picture has fewer samples: whether a triangle surrounds
        // it is left open unless it surrounds a whole one.
        const std::int32_t side = std::int32_t{1} << bits_;
        const std::int32_t wide = std::min(side, units_.columns);
        const std::int32_t high = std::min(side, units_.rows);
        chunk.large.sort(hiders_.size(), [&](const auto& visit) {
            for (std::uint32_t k = 0; k < chunk.candidates.size(); ++k) {
                const Rect& box = chunk.candidates[k].box;
                if (box.i1 - box.i0 + 1 < wide || box.j1 - box.j0 + 1 < high) continue;
                for_each_quadrant(box, [&](std::uint32_t q) { visit(q, k); });
            }
        });
    }

    void find_hider(std::uint32_t q) {
        const Rect r = quadrant(q).samples(units_);
        Halves halves;
        for (const Chunk& chunk : chunks_)
            for (const std::uint32_t k : chunk.large.of(q))
                consider(chunk.candidates[k], r, halves, hiders_[q]);
    }

    void consider(const Candidate& candidate, const Rect& r, Halves& halves, Hider& hider) const {
        if (candidate.nearest > hider.depth) return;
        const Corners c = screen_.corners(candidate.number);
        const OrientedTriangle t(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z));
        if (t.area2 == 0) return;
        const std::array<const ScreenPoint*, 4> corners{&t.p, &t.q, &t.r, &t.p};
        std::size_t open = 0, open_edge = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (EdgeFunction(*corners[k], *corners[k + 1], units_).least(r) >= 0) continue;
            ++open;
            open_edge = k;
        }
        if (open > 1) return;
        const SampledPlane surface = sampled_plane_of(screen_, units_, candidate.number);
        double depth = farthest_depth(surface, r);
        // A sample on the one edge that is open belongs to one of the two triangles beside it.
        if (open == 1) depth = halves.join(*corners[open_edge], *corners[open_edge + 1], depth);
        if (depth < hider.depth) hider = {depth, surface.id};
    }

    // Behind the hider at every sample of r: the depth of a triangle is that of its corners at
    // least, where its plane runs through them.
    [[nodiscard]] bool is_hidden(const Candidate& candidate, const Rect& r,
                                 const Hider& hider) const {
        if (candidate.nearest <= hider.depth) return false;
        const bool own_plane = candidate.number < screen_.scene().triangle_count() &&
                               screen_.shared_plane(candidate.number) == kNone;
        return own_plane || nearest_depth(sampled_plane_of(screen_, units_, candidate.number),
                                          intersection(candidate.box, r)) > hider.depth;
    }

    void sort(Chunk& chunk) const {
        struct Place {
            std::uint32_t quadrant, number;
        };
        thread_local std::vector<Place> places;
        places.clear();
        for (const Candidate& candidate : chunk.candidates)
            for_each_quadrant(candidate.box, [&](std::uint32_t q) {
                if (!is_hidden(candidate, quadrant(q).samples(units_), hiders_[q]))
                    places.push_back({q, candidate.number});
                else
                    dismiss(chunk, candidate, q);
            });
        chunk.numbers.sort(hiders_.size(), [&](const auto& visit) {
            for (const Place& place : places) visit(place.quadrant, place.number);
        });
    }

    void dismiss(Chunk& chunk, const Candidate& candidate, std::uint32_t q) const {
        ++chunk.hidden;
        if (options_.observer == nullptr) return;
        const Rect r = intersection(candidate.box, quadrant(q).samples(units_));
        options_.observer->step(
            {StepKind::block_dismissed, screen_.id(candidate.number), hiders_[q].id,
             static_cast<std::uint32_t>(r.i0), static_cast<std::uint32_t>(r.j0),
             static_cast<std::uint32_t>(r.i1 + 1), static_cast<std::uint32_t>(r.j1 + 1)});
    }

    void divide(Subdivider& subdivider, std::uint32_t q) const {
        const Quadrant here = quadrant(q);
        thread_local std::vector<std::uint32_t> numbers;
        numbers.clear();
        for (const Chunk& chunk : chunks_) {
            const std::span<const std::uint32_t> bin = chunk.numbers.of(q);
            numbers.insert(numbers.end(), bin.begin(), bin.end());
        }
        subdivider.run(here, numbers);
    }

    void report(const Subdivider::Counts& counts) const {
        std::uint64_t candidates = 0, hidden = 0;
        for (const Chunk& chunk : chunks_) {
            candidates += chunk.candidates.size();
            hidden += chunk.hidden;
        }
        count(options_, "quadrants of the first level", hiders_.size());
        count(options_, "triangles over samples", candidates);
        count(options_, "triangles hidden at the first level", hidden);
        counts.report(options_);
    }

    const ScreenScene& screen_;
    const ResolveOptions& options_;
    Visibility& out_;
    SampleUnits units_;
    int bits_;
    std::uint32_t across_;
    std::vector<Chunk> chunks_;
    std::vector<Hider> hiders_;  // by quadrant of the first level
};

}  // namespace

void resolve_warnock(const ScreenScene& screen, const ResolveOptions& options, Visibility& out) {
    Warnock(screen, options, out).run();
}

}  // namespace sightline
