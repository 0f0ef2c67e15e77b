// The A-buffer's fragments: for each pixel the surfaces that can be seen there, with their
// coverage.
//
// Source: L. Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984.
//
// How this version differs: the picture is divided into tiles, and a tile's lists stand in an arena
// that is used again for the next one, so memory is bounded by the fullest tile. In a tile the
// triangles come from front to back, roughly, and a pixel that opaque surfaces cover wholly drops
// what lies behind them as it comes. Masks have 8 x 8 samples instead of 8 x 4, and areas are kept
// beside them, exactly (pixel_coverage.hpp). The lists are sorted by depth and then by the corners
// of the triangles, never by their numbers, so the order of the file does not matter.
#include "sightline/fragments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <tuple>
#include <utility>

#include "visibility/algorithms.hpp"
#include "visibility/bins.hpp"
#include "visibility/counts.hpp"
#include "visibility/parallel.hpp"
#include "visibility/pixel_coverage.hpp"
#include "visibility/sampled_plane.hpp"

namespace sightline {

namespace {

constexpr std::int32_t kTile = 32;  // pixels a side

enum class Count : std::uint8_t { fragments, hidden, kept, deepest };

constexpr std::array kCountNames{CountName{"fragments"}, CountName{"fragments found hidden"},
                                 CountName{"fragments kept"},
                                 CountName{"longest list", Combine::maximum}};

using FragmentCounts = Counts<Count, kCountNames>;

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelArea {
    std::int32_t x0, y0, x1, y1;
};

/// A triangle in a tile.
struct TileTriangle {
    ScreenPoint a, b, c;
    std::uint32_t id;
    bool opaque;
    float near;  ///< no fragment of it is nearer
};

/// The lists of one tile.
class TileLists {
public:
    explicit TileLists(const ScreenScene& screen)
        : screen_(screen),
          size_(std::int32_t{1} << screen.subpixel_bits()),
          samples_({screen.resolution(), kMaskSide}, screen.subpixel_bits()) {}

    void open(const PixelArea& area) {
        area_ = area;
        lists_.fill({});
        nodes_.clear();
    }

    void add(TileTriangle t, std::uint32_t number) {
        const CoveredTriangle covered(t.a, t.b, t.c);
        if (!covered.has_area() || screen_.plane(t.id).c == 0) return;
        const SampledPlane plane = sampled_plane_of(screen_, samples_, number);
        t.near = plane.shared == kNone ? nearest_of(t) : 0;
        const std::int32_t top = std::max(area_.y0, std::min({t.a.y, t.b.y, t.c.y}) >> bits()),
                           last = std::min(area_.y1 - 1, std::max({t.a.y, t.b.y, t.c.y}) >> bits());
        const std::int32_t left = std::max(area_.x0, std::min({t.a.x, t.b.x, t.c.x}) >> bits()),
                           right =
                               std::min(area_.x1 - 1, std::max({t.a.x, t.b.x, t.c.x}) >> bits());
        constexpr std::int32_t kNarrow = 3;  // asking each pixel is cheaper then
        for (std::int32_t y = top; y <= last; ++y) {
            std::int32_t from = left, to = right;
            if (right - left > kNarrow) {
                const auto columns = covered.columns(std::int64_t{y} * size_, size_);
                from = std::max(from, static_cast<std::int32_t>(columns.from));
                to = std::min(to, static_cast<std::int32_t>(columns.last));
            }
            for (std::int32_t x = from; x <= to; ++x) add(t, covered, plane, x, y);
        }
    }

    void visit(FragmentSink& sink) {
        for (std::int32_t y = area_.y0; y < area_.y1; ++y) {
            for (std::int32_t x = area_.x0; x < area_.x1; ++x) {
                const List& list = lists_[index(x, y)];
                if (list.count == 0) continue;
                gather(list);
                if (may_hide(list)) drop_hidden();
                counts[Count::kept] += sorted_.size();
                counts.reaches(Count::deepest, sorted_.size());
                sink.take(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), sorted_);
            }
        }
    }

    FragmentCounts counts;

private:
    struct Node {
        Fragment fragment;
        std::uint32_t next;
        bool opaque;
    };
    struct List {
        std::uint64_t mask = 0,
                      area = 0;  ///< of the opaque ones together, the thin ones not in the mask
        std::uint32_t head = kNone, count = 0;
        std::uint32_t cleared = 0;        ///< count when hidden ones were taken out
        std::uint32_t limit = kLongList;  ///< of count, when hidden ones are looked for
        /// All of the pixel is covered by opaque surfaces that are nowhere deeper than this.
        float closed = std::numeric_limits<float>::infinity();
    };
    static constexpr std::uint32_t kLongList = 24;

    [[nodiscard]] int bits() const { return screen_.subpixel_bits(); }
    [[nodiscard]] std::size_t index(std::int32_t x, std::int32_t y) const {
        return static_cast<std::size_t>(y - area_.y0) * kTile +
               static_cast<std::size_t>(x - area_.x0);
    }

    void add(const TileTriangle& t, const CoveredTriangle& covered, const SampledPlane& plane,
             std::int32_t x, std::int32_t y) {
        List& list = lists_[index(x, y)];
        if (t.near > list.closed) return;
        const PixelSquare pixel{std::int64_t{x} * size_, std::int64_t{y} * size_, size_};
        const PixelCoverage coverage = covered.of(pixel);
        if (coverage.area == 0) return;
        ++counts[Count::fragments];
        Fragment fragment{t.id, coverage.area, coverage.mask, 0, 0, coverage.mask == 0};
        if (fragment.thin) fragment.mask = nearest_bit(t.a, t.b, t.c, pixel);
        set_depth(t, plane, x, y, fragment);
        if (fragment.near > list.closed) {
            ++counts[Count::hidden];
            return;
        }
        nodes_.push_back({fragment, list.head, t.opaque});
        list.head = static_cast<std::uint32_t>(nodes_.size()) - 1;
        ++list.count;
        if (covers_now(list, fragment, t.opaque) || list.count >= list.limit) shorten(list);
    }

    /// Whether with this fragment the opaque ones cover the pixel, and did not before.
    static bool covers_now(List& list, const Fragment& fragment, bool opaque) {
        if (!opaque || list.closed < std::numeric_limits<float>::infinity()) return false;
        if (!fragment.thin) list.mask |= fragment.mask;
        list.area += fragment.area;
        return list.mask == ~std::uint64_t{0} && list.area >= kFullArea;
    }

    static constexpr double kRounding = 64;  // more than that of a depth to float

    static float nearest_of(const TileTriangle& t) {
        return static_cast<float>(std::min({t.a.z, t.b.z, t.c.z}) - kRounding);
    }

    /// z over the samples of the mask lies within these, the rounding to float included.
    void set_depth(const TileTriangle& t, const SampledPlane& plane, std::int32_t x, std::int32_t y,
                   Fragment& fragment) const {
        constexpr double kSide = kMaskSide, kHalf = 0.5 * kSide;
        const double middle = plane.z0 + (plane.gx * (kSide * x + kHalf - 0.5) +
                                          plane.gy * (kSide * y + kHalf - 0.5));
        const double rise = kHalf * (std::abs(plane.gx) + std::abs(plane.gy)) + plane.slack;
        double near = middle - rise, far = middle + rise;
        // A plane that others share may leave the corners behind.
        if (plane.shared == kNone) {
            near = std::max(near, static_cast<double>(std::min({t.a.z, t.b.z, t.c.z})));
            far = std::min(far, static_cast<double>(std::max({t.a.z, t.b.z, t.c.z})));
        }
        fragment.near = static_cast<float>(near - kRounding);
        fragment.far = static_cast<float>(std::max(near, far) + kRounding);
    }

    /// By depth; where that is equal by the corners, and only then by the number.
    [[nodiscard]] bool before(const Fragment& f, const Fragment& g) const {
        if (f.near != g.near) return f.near < g.near;
        if (f.far != g.far) return f.far < g.far;
        const auto f_corners = corners_of(f.id), g_corners = corners_of(g.id);
        return f_corners != g_corners ? f_corners < g_corners : f.id < g.id;
    }

    using Corner = std::tuple<std::int32_t, std::int32_t, std::int32_t>;
    [[nodiscard]] std::array<Corner, 3> corners_of(std::uint32_t id) const {
        const Corners& c = screen_.scene().triangles[id];
        std::array<Corner, 3> corners;
        for (int k = 0; k < 3; ++k) {
            const ScreenPoint& p = screen_.point(c[k]);
            corners[static_cast<std::size_t>(k)] = {p.x, p.y, p.z};
        }
        std::sort(corners.begin(), corners.end());
        return corners;
    }

    /// Brings a list into sorted_, with the numbers of its nodes.
    void gather(const List& list) {
        members_.clear();
        for (std::uint32_t n = list.head; n != kNone; n = nodes_[n].next)
            if (nodes_[n].fragment.near <= list.closed) members_.push_back(n);
        std::sort(members_.begin(), members_.end(), [this](std::uint32_t m, std::uint32_t n) {
            return before(nodes_[m].fragment, nodes_[n].fragment);
        });
        sorted_.clear();
        for (const std::uint32_t n : members_) sorted_.push_back(nodes_[n].fragment);
        counts[Count::hidden] += list.count - members_.size();
    }

    /// Finds how deep one can see, and drops what lies deeper. Returns that depth: the least one
    /// such that the opaque fragments up to it cover the pixel. More fragments can only make it
    /// less, so it does not matter when one asks.
    float drop_hidden() {
        by_far_.clear();
        for (std::size_t k = 0; k < sorted_.size(); ++k)
            if (nodes_[members_[k]].opaque) by_far_.push_back(&sorted_[k]);
        std::sort(by_far_.begin(), by_far_.end(),
                  [](const Fragment* f, const Fragment* g) { return f->far < g->far; });
        std::uint64_t mask = 0, area = 0;
        float depth = std::numeric_limits<float>::infinity();
        for (const Fragment* f : by_far_) {
            if (!f->thin) mask |= f->mask;
            area += f->area;
            if (~mask != 0 || area < kFullArea) continue;
            depth = f->far;
            break;
        }
        const auto end = std::find_if(sorted_.begin(), sorted_.end(),
                                      [depth](const Fragment& f) { return f.near > depth; });
        counts[Count::hidden] += static_cast<std::uint64_t>(sorted_.end() - end);
        sorted_.erase(end, sorted_.end());
        return depth;
    }

    /// Whether opaque fragments may cover the pixel, and nobody has looked since the last one came.
    static bool may_hide(const List& list) {
        const bool covered = list.closed < std::numeric_limits<float>::infinity();
        return covered ? list.count != list.cleared : list.area >= kFullArea;
    }

    /// Takes what is hidden out of a list that has become long.
    void shorten(List& list) {
        gather(list);
        list.closed = std::min(list.closed, drop_hidden());
        list.head = kNone;
        for (std::size_t k = sorted_.size(); k-- > 0;) {
            nodes_[members_[k]].next = list.head;
            list.head = members_[k];
        }
        list.count = list.cleared = static_cast<std::uint32_t>(sorted_.size());
        list.limit = std::max(kLongList, 2 * list.count);
    }

    const ScreenScene& screen_;
    std::int32_t size_;  // of a pixel, in units of the screen
    SampleUnits samples_;
    PixelArea area_{};
    std::array<List, std::size_t{kTile} * kTile> lists_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> members_;  // nodes of the list at hand, sorted ...
    std::vector<Fragment> sorted_;        // ... and their fragments
    std::vector<const Fragment*> by_far_;
};

class FragmentTiles final : public FragmentSource {
public:
    FragmentTiles(const ScreenScene& screen, const ResolveOptions& options)
        : screen_(screen),
          options_(options),
          translucent_(translucent_triangles(screen.scene())),
          width_(static_cast<std::int32_t>(screen.resolution().width)),
          height_(static_cast<std::int32_t>(screen.resolution().height)),
          across_((width_ + kTile - 1) / kTile) {
        constexpr std::uint32_t kChunk = 16384;
        const std::uint32_t triangles = screen.triangle_count();
        chunks_.resize((triangles + kChunk - 1) / kChunk);
        for_each_index(static_cast<std::uint32_t>(chunks_.size()), options, [&](std::uint32_t c) {
            take_chunk(chunks_[c], c * kChunk, std::min(triangles, (c + 1) * kChunk));
        });
    }

    [[nodiscard]] std::uint32_t band_rows() const override { return kTile; }

    void visit_band(std::uint32_t band, FragmentSink& sink) override {
        TileLists lists(screen_);
        std::vector<Entry> triangles;
        for (std::int32_t column = 0; column < across_; ++column) {
            const auto y = static_cast<std::int32_t>(band) * kTile, x = column * kTile;
            const PixelArea area{x, y, std::min(width_, x + kTile), std::min(height_, y + kTile)};
            collect(band * static_cast<std::uint32_t>(across_) + static_cast<std::uint32_t>(column),
                    triangles);
            if (triangles.empty()) continue;
            tell_entered(area);
            fill(lists, area, triangles);
            lists.visit(sink);
        }
        const std::lock_guard lock(mutex_);
        counts_ += lists.counts;
    }

    void report() override { counts_.report(options_); }

private:
    /// Tiles x0 .. x1, y0 .. y1 that the box of a triangle meets; none when x0 > x1 or y0 > y1.
    [[nodiscard]] PixelArea tiles_of(std::uint32_t number) const {
        const Corners c = screen_.corners(number);
        const ScreenPoint &p = screen_.point(c.x), &q = screen_.point(c.y), &r = screen_.point(c.z);
        const int bits = screen_.subpixel_bits();
        const auto tile = [bits](std::int32_t v, std::int32_t pixels) {
            return std::clamp(v >> bits, 0, pixels - 1) / kTile;
        };
        const auto [x0, x1] = std::minmax({p.x, q.x, r.x});
        const auto [y0, y1] = std::minmax({p.y, q.y, r.y});
        if (x1 < 0 || y1 < 0 || x0 >> bits >= width_ || y0 >> bits >= height_)
            return {0, 0, -1, -1};
        return {tile(x0, width_), tile(y0, height_), tile(x1, width_), tile(y1, height_)};
    }

    void take_chunk(Bins<std::uint32_t>& bins, std::uint32_t first, std::uint32_t end) const {
        const auto tiles = static_cast<std::size_t>(across_) *
                           static_cast<std::size_t>((height_ + kTile - 1) / kTile);
        bins.sort(tiles, [&](const auto& visit) {
            for (std::uint32_t k = first; k < end; ++k) {
                if (!screen_.drawable(k)) continue;
                const PixelArea area = tiles_of(k);
                for (std::int32_t y = area.y0; y <= area.y1; ++y)
                    for (std::int32_t x = area.x0; x <= area.x1; ++x)
                        visit(static_cast<std::uint32_t>(y * across_ + x), k);
            }
        });
    }

    /// A triangle by its number and its nearest corner.
    struct Entry {
        std::int32_t near;
        std::uint32_t number;
    };

    /// The triangles of a tile, roughly from front to back.
    void collect(std::uint32_t tile, std::vector<Entry>& triangles) const {
        triangles.clear();
        for (const Bins<std::uint32_t>& chunk : chunks_) {
            for (const std::uint32_t k : chunk.of(tile)) {
                const Corners c = screen_.corners(k);
                triangles.push_back(
                    {std::min({screen_.point(c.x).z, screen_.point(c.y).z, screen_.point(c.z).z}),
                     k});
            }
        }
        std::sort(triangles.begin(), triangles.end(), [](const Entry& a, const Entry& b) {
            return a.near != b.near ? a.near < b.near : a.number < b.number;
        });
    }

    void fill(TileLists& lists, const PixelArea& area, const std::vector<Entry>& triangles) const {
        lists.open(area);
        for (const Entry& entry : triangles) {
            const Corners c = screen_.corners(entry.number);
            const std::uint32_t id = screen_.id(entry.number);
            lists.add({screen_.point(c.x), screen_.point(c.y), screen_.point(c.z), id,
                       translucent_.empty() || translucent_[id] == 0, 0},
                      entry.number);
        }
    }

    void tell_entered(const PixelArea& area) const {
        if (options_.observer == nullptr) return;
        options_.observer->step(
            {StepKind::tile_entered, kNone, kNone, static_cast<std::uint32_t>(area.x0),
             static_cast<std::uint32_t>(area.y0), static_cast<std::uint32_t>(area.x1),
             static_cast<std::uint32_t>(area.y1)});
    }

    const ScreenScene& screen_;
    ResolveOptions options_;
    std::vector<std::uint8_t> translucent_;
    std::int32_t width_, height_, across_;  // across_: tiles in a row
    std::vector<Bins<std::uint32_t>> chunks_;
    std::mutex mutex_;
    FragmentCounts counts_;
};

}  // namespace

Result<std::unique_ptr<FragmentSource>> open_fragments(const ScreenScene& screen,
                                                       const ResolveOptions& options) {
    if (!screen.quadrics().rays.empty())
        return Error{ErrorKind::bad_option,
                     "fragments are made of triangles only: tessellate the quadrics"};
    return std::unique_ptr<FragmentSource>(std::make_unique<FragmentTiles>(screen, options));
}

}  // namespace sightline
