// How exact it is. A part that has left memory can't be asked for its planes again, so a sample
// keeps its depth as a whole number, the remainder and the divisor of the winner's plane: two such
// depths are compared as fractions, in 128 bits. Of equally deep ones the earlier part wins, which
// has the lower number.
#include "sightline/stream.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "math/predicates.hpp"
#include "shading/box_filter.hpp"
#include "shading/picture_rows.hpp"
#include "shading/sample_shader.hpp"
#include "shading/stream_plan.hpp"
#include "visibility/sample_units.hpp"

namespace sightline {
namespace {

/// The divisor of a quadric's depth, which is whole: beyond that of any triangle. At a tie the
/// triangle is seen, for its number is lower in the whole.
constexpr std::int64_t kOfQuadric = std::numeric_limits<std::int64_t>::max();

/// z + rest / divisor.
struct ExactDepth {
    std::int32_t z = std::numeric_limits<std::int32_t>::max();
    std::int64_t rest = 0, divisor = 1;

    [[nodiscard]] bool is_before(const ExactDepth& other) const {
        if (z != other.z) return z < other.z;
        if (rest == 0 && other.rest == 0)
            return divisor != kOfQuadric && other.divisor == kOfQuadric;
        return Int128{rest} * other.divisor < Int128{other.rest} * divisor;
    }
};

ExactDepth depth_of(const Plane& plane, std::int32_t x, std::int32_t y) {
    const Int128 numerator = depth_numerator(plane, x, y);
    Int128 whole = numerator / plane.c, rest = numerator % plane.c;
    if (rest < 0) {
        --whole;
        rest += plane.c;
    }
    return {static_cast<std::int32_t>(whole), static_cast<std::int64_t>(rest), plane.c};
}

/// The nearest depth so far of every sample of a grid; structure of arrays, for 20 bytes a sample.
class DepthStore {
public:
    explicit DepthStore(const SampleGrid& grid)
        : grid_(grid),
          z_(grid.count(), ExactDepth{}.z),
          rest_(grid.count(), 0),
          divisor_(grid.count(), 1) {}

    /// take(row, column, index) for the samples of a row at which the part is nearer than all
    /// before.
    template <class Take>
    void offer(const ScreenScene& part, const Visibility& seen, std::uint32_t row,
               const Take& take) {
        const SampleUnits units(grid_, part.subpixel_bits());
        const std::int32_t y = units.position(static_cast<std::int32_t>(row));
        const std::size_t start = std::size_t{row} * grid_.columns();
        std::uint32_t last = kNone;
        Plane plane;
        for (std::uint32_t i = 0; i < grid_.columns(); ++i) {
            const std::uint32_t id = seen.ids[start + i];
            if (id == kNone) continue;
            const std::int32_t x = units.position(static_cast<std::int32_t>(i));
            ExactDepth depth;
            if (part.is_quadric(id)) {
                depth.z = static_cast<std::int32_t>(seen.depth[start + i]);
                depth.divisor = kOfQuadric;
            } else {
                if (id != last) plane = part.plane(last = id);
                depth = depth_of(plane, x, y);
            }
            if (!depth.is_before({z_[start + i], rest_[start + i], divisor_[start + i]})) continue;
            z_[start + i] = depth.z;
            rest_[start + i] = depth.rest;
            divisor_[start + i] = depth.divisor;
            take(i, start + i, x, y, id);
        }
    }

    [[nodiscard]] const SampleGrid& grid() const { return grid_; }

private:
    SampleGrid grid_;
    std::vector<std::int32_t> z_;
    std::vector<std::int64_t> rest_, divisor_;
};

/// What the files need of the pixels' centres.
struct MapsWanted {
    bool depth = false, ids = false, normals = false;
    [[nodiscard]] bool any() const { return depth || ids || normals; }
};

MapsWanted maps_for(std::span<const PictureFile> files) {
    MapsWanted wanted;
    for (const PictureFile& file : files) {
        const bool color = file.content == PictureContent::color;
        const bool exr = file.format == ImageFormat::exr;
        wanted.depth |= file.content == PictureContent::depth || (color && exr);
        wanted.ids |= file.content == PictureContent::ids || file.content == PictureContent::mask ||
                      (color && file.add_ids);
        wanted.normals |= file.content == PictureContent::normals || (color && file.add_normals);
    }
    return wanted;
}

}  // namespace

struct StreamedPicture::State {
    State(const Camera& camera, const DrawOptions& drawing, std::span<const PictureFile> pictures,
          const StreamPlan::State* of_whole)
        : options(drawing),
          files(pictures),
          maps(maps_for(pictures)),
          near(camera.near_plane),
          far(camera.far_plane),
          size(camera.resolution),
          whole(of_whole) {
        const bool color = std::ranges::any_of(
            files, [](const PictureFile& file) { return file.content == PictureContent::color; });
        if (color) {
            colors.emplace(SampleGrid{size, options.samples_per_axis});
            samples.assign(colors->grid().count(), options.shading.background);
        }
        if (maps.any()) centres.emplace(SampleGrid{size, 1});
        if (maps.depth)
            depth = DepthImage(size.width, size.height, std::numeric_limits<float>::infinity());
        if (maps.ids) {
            triangles = IdImage(size.width, size.height, kNone);
            objects = IdImage(size.width, size.height, kNone);
        }
        if (maps.normals) normals = NormalImage(size.width, size.height, glm::vec3(0));
    }

    void take_colors(const ScreenScene& part, const Visibility& seen) {
        const SampleShader shader(part, options.shading.shading);
        tbb::enumerable_thread_specific<FaceCache> caches([&] { return FaceCache(shader); });
        for_rows(0, colors->grid().rows(), options.shading.threads, [&](std::uint32_t row) {
            FaceCache& cache = caches.local();
            colors->offer(part, seen, row,
                          [&](std::uint32_t, std::size_t at, std::int32_t x, std::int32_t y,
                              std::uint32_t id) {
                              const PixelColor* constant = cache.constant_color(id);
                              samples[at] = constant != nullptr
                                                ? constant->linear
                                                : shader.varying_color(cache.face(id), x, y);
                          });
        });
    }

    void note_seen(const Visibility& seen) { anything_seen = anything_seen || sees_anything(seen); }

    void take_maps(const ScreenScene& part, const Visibility& seen) {
        const RowMaps of_part(part, seen, is_smooth(options.shading.shading));
        tbb::enumerable_thread_specific<std::vector<float>> depth_rows;
        tbb::enumerable_thread_specific<std::vector<glm::vec3>> normal_rows;
        for_rows(0, size.height, options.shading.threads, [&](std::uint32_t row) {
            std::vector<float>& depths = depth_rows.local();
            std::vector<glm::vec3>& directions = normal_rows.local();
            if (maps.depth) {
                depths.resize(size.width);
                of_part.depth(row, depths.data());
            }
            if (maps.normals) {
                directions.resize(size.width);
                of_part.normals(row, directions.data());
            }
            centres->offer(part, seen, row,
                           [&](std::uint32_t column, std::size_t at, std::int32_t, std::int32_t,
                               std::uint32_t id) {
                               if (maps.depth) depth.pixels[at] = depths[column];
                               if (maps.normals) normals.pixels[at] = directions[column];
                               if (!maps.ids) return;
                               triangles.pixels[at] = number_of(part, id);
                               objects.pixels[at] = object_of(part, id);
                           });
        });
    }

    // In the whole, quadrics come after all triangles, and so do their objects.
    [[nodiscard]] std::uint32_t number_of(const ScreenScene& part, std::uint32_t id) const {
        if (whole == nullptr) return first_id + first_quadric + id;
        if (!part.is_quadric(id)) return first_id + id;
        return whole->triangles + first_quadric + (id - part.scene().triangle_count());
    }
    [[nodiscard]] std::uint32_t object_of(const ScreenScene& part, std::uint32_t id) const {
        const Scene& scene = part.scene();
        if (whole == nullptr) return first_object + first_quadric + scene.object_of(id);
        if (!part.is_quadric(id)) return first_object + scene.object_of(id);
        return whole->meshes + first_quadric + (id - scene.triangle_count());
    }
    void go_on(const Scene& part) {
        const auto quadrics = static_cast<std::uint32_t>(part.quadrics.size());
        first_id += part.triangle_count();
        first_object += static_cast<std::uint32_t>(part.objects.size()) - quadrics;
        first_quadric += quadrics;
    }

    [[nodiscard]] ColorImage picture() const {
        const std::uint32_t n = options.samples_per_axis;
        ColorImage image(size.width, size.height);
        for_rows(0, size.height, options.shading.threads, [&](std::uint32_t y) {
            box_filter(samples.data() + std::size_t{y} * n * colors->grid().columns(), n,
                       size.width, image.pixels.data() + std::size_t{y} * size.width);
        });
        return image;
    }

    [[nodiscard]] Status write_color(const PictureFile& file) const {
        const ColorImage image = picture();
        switch (file.format) {
            case ImageFormat::png:
                return write_color_png(file.path, image);
            case ImageFormat::npy:
                return write_npy(file.path, image);
            case ImageFormat::exr:
                return write_exr(file.path, {&image, &depth, file.add_normals ? &normals : nullptr,
                                             file.add_ids ? &objects : nullptr,
                                             file.add_ids ? &triangles : nullptr});
        }
        return success();
    }

    [[nodiscard]] Status write_depth(const PictureFile& file) const {
        if (file.format == ImageFormat::png) return write_depth_png(file.path, depth, near, far);
        if (file.format == ImageFormat::npy) return write_npy(file.path, depth);
        ExrLayers layers;
        layers.depth = &depth;
        return write_exr(file.path, layers);
    }

    [[nodiscard]] Status write_ids(const PictureFile& file) const {
        if (file.format == ImageFormat::png) return write_ids_png(file.path, triangles);
        if (file.format == ImageFormat::npy) return write_npy(file.path, triangles);
        ExrLayers layers;
        layers.objects = &objects;
        layers.triangles = &triangles;
        return write_exr(file.path, layers);
    }

    [[nodiscard]] Status write_normals(const PictureFile& file) const {
        if (file.format == ImageFormat::png) return write_normals_png(file.path, normals);
        if (file.format == ImageFormat::npy) return write_npy(file.path, normals);
        ExrLayers layers;
        layers.normals = &normals;
        return write_exr(file.path, layers);
    }

    [[nodiscard]] Status write_mask(const PictureFile& file) const {
        MaskImage mask(size.width, size.height);
        std::ranges::transform(triangles.pixels, mask.pixels.begin(), [](std::uint32_t id) {
            return static_cast<std::uint8_t>(id != kNone ? 1 : 0);
        });
        if (file.format == ImageFormat::png) return write_mask_png(file.path, mask);
        if (file.format == ImageFormat::npy) return write_npy(file.path, mask);
        return Error{ErrorKind::bad_option,
                     "cannot write '" + file.path + "': an EXR holds no mask; choose PNG or NPY"};
    }

    [[nodiscard]] Status write(const PictureFile& file) const {
        if (file.deep || file.content == PictureContent::matte)
            return Error{ErrorKind::bad_option,
                         "cannot write '" + file.path +
                             "': a picture made part by part has one surface a sample; leave out "
                             "what is deep or a matte"};
        switch (file.content) {
            case PictureContent::color:
                return write_color(file);
            case PictureContent::depth:
                return write_depth(file);
            case PictureContent::ids:
                return write_ids(file);
            case PictureContent::normals:
                return write_normals(file);
            case PictureContent::mask:
                return write_mask(file);
            case PictureContent::matte:
                break;
        }
        return success();
    }

    DrawOptions options;
    std::span<const PictureFile> files;
    MapsWanted maps;
    double near, far;
    Resolution size;
    std::optional<DepthStore> colors, centres;  // of the samples, of the pixels' centres
    std::vector<glm::vec4> samples;
    DepthImage depth;
    IdImage triangles, objects;
    NormalImage normals;
    const StreamPlan::State* whole;  // null without a plan
    // Triangles, objects with triangles, and quadrics of the parts before.
    std::uint32_t first_id = 0, first_object = 0, first_quadric = 0;
    bool anything_seen = false;
};

StreamedPicture::StreamedPicture(const Camera& camera, const DrawOptions& options,
                                 std::span<const PictureFile> files, const StreamPlan* plan)
    : state_(std::make_unique<State>(camera, options, files,
                                     plan == nullptr ? nullptr : plan->state_.get())) {}
StreamedPicture::~StreamedPicture() = default;

Status StreamedPicture::add(const ScreenScene& part) {
    State& state = *state_;
    ResolveOptions resolving;
    resolving.threads = state.options.shading.threads;
    const std::uint32_t n = state.options.samples_per_axis;
    Visibility seen;
    if (state.colors) {
        resolving.samples_per_axis = n;
        Status done = resolve(default_algorithm(), part, resolving, seen);
        if (!done) return done;
        state.take_colors(part, seen);
        state.note_seen(seen);
    }
    if (state.centres) {
        resolving.samples_per_axis = 1;
        if (!state.colors || n != 1) {
            Status done = resolve(default_algorithm(), part, resolving, seen);
            if (!done) return done;
        }
        state.take_maps(part, seen);
        if (!state.colors) state.note_seen(seen);
    }
    state.go_on(part.scene());
    return success();
}

bool StreamedPicture::anything_seen() const { return state_->anything_seen; }

Status StreamedPicture::write() const {
    for (const PictureFile& file : state_->files)
        if (Status done = state_->write(file); !done) return done;
    return success();
}

}  // namespace sightline
