#include "drawing/occluders.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/arena.hpp"
#include "math/morton.hpp"
#include "sightline/visibility.hpp"

namespace sightline {
namespace {

constexpr std::uint64_t kNowhere = ~std::uint64_t{0};

Occluder make_occluder(const ScreenScene& page, std::uint32_t k) {
    const Corners c = page.corners(k);
    Occluder o;
    o.p = page.point(c.x);
    o.q = page.point(c.y);
    o.r = page.point(c.z);
    o.corners = {c.x, c.y, c.z};
    o.turned = side(o.p.x, o.p.y, o.q.x, o.q.y, o.r.x, o.r.y) < 0;
    if (o.turned) {
        std::swap(o.q, o.r);
        std::swap(o.corners[1], o.corners[2]);
    }
    o.id = page.id(k);
    o.sheet = page.shared_plane(o.id);
    o.plane = page.plane(o.id);
    o.has_own_plane = o.sheet == kNone && k == o.id;  // a piece has that of the whole triangle
    o.near = std::min({o.p.z, o.q.z, o.r.z});
    o.far = std::max({o.p.z, o.q.z, o.r.z});
    if (o.sheet == kNone || o.plane.c == 0) return o;
    // The plane of a sheet passes by the corners of its members, not exactly through them.
    for (std::size_t i = 0; i < 3; ++i) {
        const double z = evaluate_depth(o.plane, o.point(i).x, o.point(i).y);
        o.near = std::min(o.near, static_cast<std::int32_t>(std::clamp(
                                      std::floor(z) - 1, 0.0, static_cast<double>(kDepthMax))));
        o.far = std::max(o.far, static_cast<std::int32_t>(std::clamp(
                                    std::ceil(z) + 1, 0.0, static_cast<double>(kDepthMax))));
    }
    return o;
}

bool covers_area(const ScreenScene& page, std::uint32_t k) {
    if (!page.drawable(k)) return false;
    const Corners c = page.corners(k);
    const ScreenPoint &p = page.point(c.x), &q = page.point(c.y), &r = page.point(c.z);
    if (side(p.x, p.y, q.x, q.y, r.x, r.y) == 0) return false;
    // A plane through corners with an area between them is no vertical one.
    const std::uint32_t id = page.id(k);
    return (id == k && page.shared_plane(id) == kNone) || page.plane(id).c > 0;
}

/// Triangles that cover an area, near ones together: whatever looks for neighbours then finds the
/// memory warm.
std::vector<std::uint32_t> find_covering(const ScreenScene& page) {
    struct Placed {
        std::uint64_t place;
        std::uint32_t triangle;
    };
    const std::uint32_t n = page.triangle_count();
    RawVector<Placed> all(n);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, n, 4096), [&](const auto& range) {
        for (std::uint32_t k = range.begin(); k != range.end(); ++k) {
            const ScreenPoint& p = page.point(page.corners(k).x);
            all[k] = {covers_area(page, k) ? morton_code(p.x, p.y) : kNowhere, k};
        }
    });
    std::erase_if(all, [](const Placed& t) { return t.place == kNowhere; });
    tbb::parallel_sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) {
        return a.place != b.place ? a.place < b.place : a.triangle < b.triangle;
    });
    std::vector<std::uint32_t> kept(all.size());
    std::ranges::transform(all, kept.begin(), &Placed::triangle);
    return kept;
}

}  // namespace

SpaceBox Occluder::extents() const {
    SpaceBox box;
    std::tie(box.x0, box.x1) = std::minmax({p.x, q.x, r.x});
    std::tie(box.y0, box.y1) = std::minmax({p.y, q.y, r.y});
    box.near = near;
    box.far = far;
    return box;
}

Occluders::Occluders(const ScreenScene& page, TraceMethod method, int threads) {
    const std::vector<std::uint32_t> kept = in_arena(threads, [&] { return find_covering(page); });
    all_.resize(kept.size());
    RawVector<PageTriangle> triangles(kept.size());
    tbb::enumerable_thread_specific<std::vector<std::uint32_t>> in_sheets;
    in_arena(threads, [&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kept.size(), 4096),
                          [&](const auto& range) {
                              std::vector<std::uint32_t>& mine = in_sheets.local();
                              for (std::size_t i = range.begin(); i != range.end(); ++i) {
                                  all_[i] = make_occluder(page, kept[i]);
                                  triangles[i] = all_[i].triangle();
                                  if (all_[i].sheet != kNone)
                                      mine.push_back(static_cast<std::uint32_t>(i));
                              }
                          });
    });
    for (const auto& some : in_sheets)
        in_sheets_.insert(in_sheets_.end(), some.begin(), some.end());
    if (method == TraceMethod::fast) in_arena(threads, [&] { grid_.emplace(triangles); });
}

}  // namespace sightline
