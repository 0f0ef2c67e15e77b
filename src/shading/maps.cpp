// Maps of what is seen: depth, normals, ids and coverage, never blended.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <limits>

#include "shading/surface.hpp"
#include "sightline/shading.hpp"

namespace sightline {
namespace {

/// What shading a map's value needs of one triangle, kept while neighbours share it.
struct DepthOf {
    explicit DepthOf(const ScreenScene& s) : screen(s) {}
    void prepare(std::uint32_t id) { plane = screen.plane(id); }
    [[nodiscard]] float at(std::int32_t x, std::int32_t y) const {
        return static_cast<float>(screen.metric_depth(evaluate_depth(plane, x, y)));
    }
    const ScreenScene& screen;
    Plane plane;
};

struct NormalOf {
    NormalOf(const ScreenScene& s, bool interpolated) : screen(s), smooth(interpolated) {}
    void prepare(std::uint32_t id) {
        surface = make_surface(screen, id);
        interpolate = smooth && surface.smooth;
        if (interpolate) add_attributes(screen, id, surface);
    }
    [[nodiscard]] glm::vec3 at(std::int32_t x, std::int32_t y) const {
        if (!interpolate) return glm::vec3(surface.normal);
        const double scale = 1.0 / static_cast<double>(1 << screen.subpixel_bits());
        return glm::vec3(normal_at(surface, surface.barycentrics.at(glm::dvec2(x, y) * scale)));
    }
    const ScreenScene& screen;
    bool smooth, interpolate = false;
    Surface surface{};
};

/// Image of what `value` says of each sample that sees a triangle, rows in parallel.
template <class T, class Value>
Image<T> map_of(const ScreenScene& screen, const Visibility& visibility, T background,
                const Value& value) {
    assert(visibility.grid.per_axis == 1);
    const Resolution size = visibility.grid.resolution;
    const std::int32_t step = visibility.grid.step(screen.subpixel_bits());
    const std::int32_t offset = visibility.grid.offset(screen.subpixel_bits());
    Image<T> image(size.width, size.height, background);
    tbb::parallel_for(std::uint32_t{0}, size.height, [&](std::uint32_t y) {
        Value of = value;
        std::uint32_t prepared = kNone;
        const std::size_t row = std::size_t{y} * size.width;
        for (std::uint32_t x = 0; x < size.width; ++x) {
            const std::uint32_t id = visibility.ids[row + x];
            if (id == kNone) continue;
            if (id != prepared) of.prepare(id);
            prepared = id;
            image.pixels[row + x] = of.at(static_cast<std::int32_t>(x) * step + offset,
                                          static_cast<std::int32_t>(y) * step + offset);
        }
    });
    return image;
}

/// Image of a function of the ids.
template <class T, class Function>
Image<T> map_of_ids(const Visibility& visibility, const Function& function) {
    assert(visibility.grid.per_axis == 1);
    Image<T> image(visibility.grid.resolution.width, visibility.grid.resolution.height);
    std::transform(visibility.ids.begin(), visibility.ids.end(), image.pixels.begin(), function);
    return image;
}

}  // namespace

DepthImage depth_map(const ScreenScene& screen, const Visibility& visibility) {
    return map_of(screen, visibility, std::numeric_limits<float>::infinity(), DepthOf(screen));
}

NormalImage normal_map(const ScreenScene& screen, const Visibility& visibility, bool smooth) {
    return map_of(screen, visibility, glm::vec3(0.0f), NormalOf(screen, smooth));
}

IdImage triangle_map(const Visibility& visibility) {
    return map_of_ids<std::uint32_t>(visibility, [](std::uint32_t id) { return id; });
}

IdImage object_map(const ScreenScene& screen, const Visibility& visibility) {
    const Scene& scene = screen.scene();
    const auto object = [&scene](std::uint32_t id) {
        return id == kNone ? kNone : scene.object_of(id);
    };
    return map_of_ids<std::uint32_t>(visibility, object);
}

MaskImage mask_map(const Visibility& visibility) {
    return map_of_ids<std::uint8_t>(visibility,
                                    [](std::uint32_t id) { return std::uint8_t{id != kNone}; });
}

}  // namespace sightline
