// From a projected scene to the files of `sightline render`.
#include "render_frame.hpp"

#include <ImfThreading.h>
#include <tbb/info.h>

#include <algorithm>

namespace sightline::cli {
namespace {

/// Linear light, premultiplied.
glm::vec4 linear_color(glm::u8vec4 srgb) {
    const float alpha = static_cast<float>(srgb.a) / 255.0f;
    return {alpha * from_srgb8(srgb.r), alpha * from_srgb8(srgb.g), alpha * from_srgb8(srgb.b),
            alpha};
}

ShadeOptions shade_options(const RenderOptions& options, Shading shading) {
    return {shading, linear_color(options.background), options.common.threads};
}

Status write_color(const RenderOptions& options, Shading shading, const Frame& frame,
                   const std::string& path) {
    if (options.color->format == ImageFormat::png) {
        return write_shaded_png(path, frame.screen, frame.samples, shade_options(options, shading));
    }
    if (options.color->format == ImageFormat::npy) return write_npy(path, frame.color);
    ExrLayers layers;
    layers.color = &frame.color;
    layers.depth = &frame.depth;
    if (options.layers.normals) layers.normals = &frame.normals;
    if (options.layers.ids) layers.objects = &frame.objects, layers.triangles = &frame.triangles;
    return write_exr(path, layers);
}

Status write_depth(ImageFormat format, const Frame& frame, const std::string& path) {
    const Camera& camera = frame.screen.camera();
    if (format == ImageFormat::png) {
        return write_depth_png(path, frame.depth, camera.near_plane, camera.far_plane);
    }
    if (format == ImageFormat::npy) return write_npy(path, frame.depth);
    ExrLayers layers;
    layers.depth = &frame.depth;
    return write_exr(path, layers);
}

Status write_ids(ImageFormat format, const Frame& frame, const std::string& path) {
    if (format == ImageFormat::png) return write_ids_png(path, frame.triangles);
    if (format == ImageFormat::npy) return write_npy(path, frame.triangles);
    ExrLayers layers;
    layers.objects = &frame.objects;
    layers.triangles = &frame.triangles;
    return write_exr(path, layers);
}

Status write_normals(ImageFormat format, const Frame& frame, const std::string& path) {
    if (format == ImageFormat::png) return write_normals_png(path, frame.normals);
    if (format == ImageFormat::npy) return write_npy(path, frame.normals);
    ExrLayers layers;
    layers.normals = &frame.normals;
    return write_exr(path, layers);
}

bool writes_exr(const RenderOptions& options) {
    const auto outputs = {&options.color, &options.depth, &options.ids, &options.normals};
    return std::any_of(outputs.begin(), outputs.end(), [](const std::optional<Output>* output) {
        return *output && (*output)->format == ImageFormat::exr;
    });
}

/// OpenEXR compresses on a pool of its own, which is the program's to fill: the library leaves it
/// alone. The bytes are the same.
void use_exr_threads(int threads) {
    const int count = threads > 0 ? threads : tbb::info::default_concurrency();
    if (count > 1) Imf::setGlobalThreadCount(count);
}

}  // namespace

bool is_smooth(Shading shading) { return shading == Shading::gouraud || shading == Shading::phong; }

Status resolve_samples(const RenderOptions& options, Frame& frame) {
    ResolveOptions resolving{options.per_axis, options.common.threads, nullptr, &frame.counters};
    if (options.color) {
        if (Status done = resolve(*options.algorithm, frame.screen, resolving, frame.samples);
            !done) {
            return done;
        }
    }
    if (!options.needs_centres() || (options.color && options.per_axis == 1)) return success();
    resolving.samples_per_axis = 1;
    // The counters of the picture are those to report.
    if (options.color) resolving.counters = nullptr;
    return resolve(*options.algorithm, frame.screen, resolving, frame.centre_store);
}

void shade_frame(const RenderOptions& options, Shading shading, Frame& frame) {
    if (options.needs_color_image()) {
        frame.color = shade(frame.screen, frame.samples, shade_options(options, shading));
    }
    if (!options.needs_centres()) return;
    const Visibility& centres = frame.centres();
    const bool is_exr = options.color && options.color->format == ImageFormat::exr;
    if (options.depth || is_exr) frame.depth = depth_map(frame.screen, centres);
    if (options.ids || options.layers.ids) {
        frame.triangles = triangle_map(centres);
        frame.objects = object_map(frame.screen, centres);
    }
    if (options.normals || options.layers.normals) {
        frame.normals = normal_map(frame.screen, centres, is_smooth(shading));
    }
    if (options.mask) frame.mask = mask_map(centres);
}

Status write_frame(const RenderOptions& options, Shading shading, const Frame& frame) {
    if (writes_exr(options)) use_exr_threads(options.common.threads);
    OutputBatch batch;
    if (options.color) {
        batch.add(*options.color, [&](const std::string& path) {
            return write_color(options, shading, frame, path);
        });
    }
    const auto add = [&](const std::optional<Output>& output, auto write) {
        if (!output) return;
        const ImageFormat format = output->format;
        batch.add(*output, [&frame, format, write](const std::string& path) {
            return write(format, frame, path);
        });
    };
    add(options.depth, write_depth);
    add(options.ids, write_ids);
    add(options.normals, write_normals);
    add(options.mask, [](ImageFormat format, const Frame& f, const std::string& path) {
        return format == ImageFormat::png ? write_mask_png(path, f.mask) : write_npy(path, f.mask);
    });
    return batch.publish();
}

}  // namespace sightline::cli
