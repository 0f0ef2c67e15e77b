// Deferred shading: colours of the visible samples, averaged over the pixels.
#include "sightline/shading.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "image/png_writer.hpp"
#include "math/arena.hpp"
#include "shading/row_shader.hpp"

namespace sightline {
namespace {

constexpr std::array<std::pair<std::string_view, Shading>, 7> kNames = {
    {{"flat", Shading::flat},
     {"gouraud", Shading::gouraud},
     {"phong", Shading::phong},
     {"unlit", Shading::unlit},
     {"depth", Shading::depth},
     {"normals", Shading::normals},
     {"ids", Shading::ids}}};

}  // namespace

std::optional<Shading> parse_shading(std::string_view name) {
    const auto* found = std::find_if(kNames.begin(), kNames.end(),
                                     [name](const auto& row) { return row.first == name; });
    if (found == kNames.end()) return std::nullopt;
    return found->second;
}

std::string_view name_of(Shading shading) {
    const auto* found = std::find_if(kNames.begin(), kNames.end(),
                                     [shading](const auto& row) { return row.second == shading; });
    return found == kNames.end() ? std::string_view{} : found->first;
}

bool is_smooth(Shading shading) { return shading == Shading::gouraud || shading == Shading::phong; }

bool has_translucent_faces(const Scene& scene) {
    const std::size_t first_quadric = scene.objects.size() - scene.quadrics.size();
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const bool is_seen = scene.objects[o].triangle_count > 0 || o >= first_quadric;
        if (is_seen && is_translucent(scene, scene.objects[o])) return true;
    }
    return false;
}

namespace {

bool shows_numbers(Shading shading) {
    return shading == Shading::depth || shading == Shading::normals || shading == Shading::ids;
}

}  // namespace

bool blends(const Algorithm& algorithm, Shading shading, const Scene& scene) {
    return algorithm.open_layers != nullptr && !shows_numbers(shading) &&
           has_translucent_faces(scene);
}

bool antialiases(const Algorithm& algorithm, Shading shading) {
    return algorithm.open_fragments != nullptr && !shows_numbers(shading);
}

ColorImage shade(const ScreenScene& screen, const Visibility& visibility,
                 const ShadeOptions& options) {
    ColorImage image(visibility.grid.resolution.width,
                     visibility.rows() / visibility.grid.per_axis);
    const RowShader shader(screen, visibility, options);
    tbb::enumerable_thread_specific<FaceCache> caches([&] { return shader.make_cache(); });
    // Blocks of rows are tall enough for the caches to serve a triangle more than once.
    constexpr std::uint32_t kGrain = 16;
    in_arena(options.threads, [&] {
        const tbb::blocked_range<std::uint32_t> all(0, image.height, kGrain);
        tbb::parallel_for(all, [&](const auto& range) {
            FaceCache& cache = caches.local();
            for (std::uint32_t y = range.begin(); y != range.end(); ++y) {
                shader.shade(y, cache, image.pixels.data() + std::size_t{y} * image.width);
            }
        });
    });
    return image;
}

Status write_shaded_png(const std::string& path, const ScreenScene& screen,
                        const Visibility& visibility, const ShadeOptions& options) {
    const std::uint32_t width = visibility.grid.resolution.width,
                        height = visibility.rows() / visibility.grid.per_axis;
    Result<PngWriter> writer =
        PngWriter::create(path, width, height, PngLayout::rgba8, PngContent::color);
    if (!writer) return writer.error();
    const RowShader shader(screen, visibility, options);
    tbb::enumerable_thread_specific<FaceCache> caches([&] { return shader.make_cache(); });
    const auto source = [&](std::uint32_t first, std::uint32_t count, std::uint8_t* out) {
        FaceCache& cache = caches.local();
        auto* pixels = reinterpret_cast<std::array<std::uint8_t, 4>*>(out);
        for (std::uint32_t i = 0; i < count; ++i) {
            shader.shade_rgba8(first + i, cache, pixels + std::size_t{i} * width);
        }
    };
    if (Status written = writer->write_rows(source, height, options.threads); !written)
        return written;
    return writer->finish();
}

}  // namespace sightline
