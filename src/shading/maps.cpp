// Maps of what is seen: depth, normals, ids and coverage, never blended.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <limits>

#include "shading/quadric_surface.hpp"
#include "shading/row_maps.hpp"
#include "shading/surface.hpp"
#include "sightline/shading.hpp"

namespace sightline {
namespace {

std::uint8_t is_seen(std::uint32_t id) { return static_cast<std::uint8_t>(id != kNone); }

/// What a map's value needs of one triangle or quadric, kept while neighbours share it.
struct DepthOf {
    explicit DepthOf(const ScreenScene& s) : screen(s) {}
    void prepare(std::uint32_t id) {
        quadric = screen.is_quadric(id) ? id : kNone;
        if (quadric == kNone) plane = screen.plane(id);
    }
    [[nodiscard]] float at(std::int32_t x, std::int32_t y) const {
        if (quadric != kNone) return static_cast<float>(quadric_point(screen, quadric, x, y).depth);
        return static_cast<float>(screen.metric_depth(evaluate_depth(plane, x, y)));
    }
    const ScreenScene& screen;
    std::uint32_t quadric = kNone;
    Plane plane;
};

struct NormalOf {
    NormalOf(const ScreenScene& s, bool interpolated) : screen(s), smooth(interpolated) {}
    void prepare(std::uint32_t id) {
        quadric = screen.is_quadric(id) ? id : kNone;
        if (quadric != kNone) return;
        surface = make_surface(screen, id);
        interpolate = smooth && surface.smooth;
        if (interpolate) add_attributes(screen, id, surface);
    }
    [[nodiscard]] glm::vec3 at(std::int32_t x, std::int32_t y) const {
        if (quadric != kNone) return glm::vec3(quadric_point(screen, quadric, x, y).normal);
        if (!interpolate) return glm::vec3(surface.normal);
        const double scale = 1.0 / static_cast<double>(1 << screen.subpixel_bits());
        return glm::vec3(normal_at(surface, surface.barycentrics.at(glm::dvec2(x, y) * scale)));
    }
    const ScreenScene& screen;
    bool smooth, interpolate = false;
    std::uint32_t quadric = kNone;
    Surface surface{};
};

}  // namespace

RowMaps::RowMaps(const ScreenScene& screen, const Visibility& visibility, bool smooth)
    : screen_(screen), visibility_(visibility), smooth_(smooth) {}

/// The ids of a row of pixels.
std::span<const std::uint32_t> RowMaps::ids(std::uint32_t y) const {
    assert(visibility_.grid.per_axis == 1);
    const std::uint32_t width = visibility_.grid.resolution.width;
    return {visibility_.ids.data() + std::size_t{y} * width, width};
}

/// What `of` says of each pixel of a row that sees a triangle.
template <class T, class Value>
void RowMaps::values(std::uint32_t y, T background, Value of, T* out) const {
    const std::int32_t step = visibility_.grid.step(screen_.subpixel_bits());
    const std::int32_t offset = visibility_.grid.offset(screen_.subpixel_bits());
    const std::int32_t height =
        static_cast<std::int32_t>(visibility_.first_row + y) * step + offset;
    std::uint32_t prepared = kNone;
    std::int32_t x = offset;
    for (const std::uint32_t id : ids(y)) {
        if (id != kNone && id != prepared) of.prepare(prepared = id);
        *out++ = id == kNone ? background : of.at(x, height);
        x += step;
    }
}

void RowMaps::depth(std::uint32_t y, float* out) const {
    values(y, std::numeric_limits<float>::infinity(), DepthOf(screen_), out);
}

void RowMaps::normals(std::uint32_t y, glm::vec3* out) const {
    values(y, glm::vec3(0.0f), NormalOf(screen_, smooth_), out);
}

void RowMaps::triangles(std::uint32_t y, std::uint32_t* out) const {
    std::ranges::copy(ids(y), out);
}

void RowMaps::objects(std::uint32_t y, std::uint32_t* out) const {
    const Scene& scene = screen_.scene();
    std::ranges::transform(ids(y), out, [&scene](std::uint32_t id) {
        return id == kNone ? kNone : scene.object_of(id);
    });
}

void RowMaps::mask(std::uint32_t y, std::uint8_t* out) const {
    std::ranges::transform(ids(y), out, is_seen);
}

namespace {

/// All rows that a visibility holds, in parallel.
template <class T>
Image<T> image_of(const Visibility& visibility, const RowMaps& maps,
                  void (RowMaps::*make)(std::uint32_t, T*) const) {
    Image<T> image(visibility.grid.resolution.width, visibility.rows());
    tbb::parallel_for(std::uint32_t{0}, image.height, [&](std::uint32_t y) {
        (maps.*make)(y, image.pixels.data() + std::size_t{y} * image.width);
    });
    return image;
}

}  // namespace

DepthImage depth_map(const ScreenScene& screen, const Visibility& visibility) {
    return image_of(visibility, RowMaps(screen, visibility, false), &RowMaps::depth);
}

NormalImage normal_map(const ScreenScene& screen, const Visibility& visibility, bool smooth) {
    return image_of(visibility, RowMaps(screen, visibility, smooth), &RowMaps::normals);
}

IdImage object_map(const ScreenScene& screen, const Visibility& visibility) {
    return image_of(visibility, RowMaps(screen, visibility, false), &RowMaps::objects);
}

IdImage triangle_map(const Visibility& visibility) {
    assert(visibility.grid.per_axis == 1);
    IdImage image(visibility.grid.resolution.width, visibility.rows());
    std::ranges::copy(visibility.ids, image.pixels.begin());
    return image;
}

MaskImage mask_map(const Visibility& visibility) {
    assert(visibility.grid.per_axis == 1);
    MaskImage image(visibility.grid.resolution.width, visibility.rows());
    std::ranges::transform(visibility.ids, image.pixels.begin(), is_seen);
    return image;
}

}  // namespace sightline
