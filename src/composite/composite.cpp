// Which pictures fit together, and flat ones joined by depth: the depth buffer of E. Catmull, "A
// Subdivision Algorithm for Computer Display of Curved Surfaces", 1974, with whole pictures for
// surfaces, as T. Duff has it in "Compositing 3-D Rendered Images", SIGGRAPH 1985.
#include "sightline/composite.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <new>
#include <string_view>
#include <utility>

#include "composite/deep.hpp"
#include "composite/windows.hpp"

namespace sightline {
namespace {

std::string name_of(const CompositeOptions& options, std::size_t i) {
    return i < options.names.size() ? options.names[i] : fmt::format("picture {}", i + 1);
}

bool is_deep(const ExrPicture& picture) { return std::holds_alternative<DeepImage>(picture); }

Error bad_input(std::string message) { return Error{ErrorKind::bad_input, std::move(message)}; }

/// Why a picture does not go with the first one, if so: parts of one whole do.
std::optional<Error> misfit(const ExrPicture& first, const ExrPicture& other,
                            const std::string& first_name, const std::string& name) {
    if (is_deep(first) != is_deep(other)) {
        return bad_input(fmt::format("'{}' is deep but '{}' is flat; give files of one kind",
                                     is_deep(first) ? first_name : name,
                                     is_deep(first) ? name : first_name));
    }
    if (same(data_window(first), data_window(other))) return std::nullopt;
    const Window whole = display_window(first), whole_of_other = display_window(other);
    if (same(whole, whole_of_other)) return std::nullopt;
    if (width_of(whole) != width_of(whole_of_other) ||
        height_of(whole) != height_of(whole_of_other)) {
        return bad_input(
            fmt::format("'{}' has {}x{} pixels but '{}' has {}x{}; make them with the "
                        "same camera and resolution",
                        first_name, width_of(whole), height_of(whole), name,
                        width_of(whole_of_other), height_of(whole_of_other)));
    }
    return bad_input(
        fmt::format("the display window of '{}' begins at ({}, {}) but that of '{}' at ({}, {}); "
                    "make them with the same one",
                    first_name, whole.first.x, whole.first.y, name, whole_of_other.first.x,
                    whole_of_other.first.y));
}

/// The data window of the result: what all pictures have together.
Result<Window> common_window(std::span<const ExrPicture> pictures,
                             const CompositeOptions& options) {
    constexpr std::int64_t kMaxSide = 65'536, kMaxPixels = std::int64_t{1} << 28;
    Window window = data_window(pictures[0]);
    for (std::size_t i = 1; i < pictures.size(); ++i) {
        auto error = misfit(pictures[0], pictures[i], name_of(options, 0), name_of(options, i));
        if (error) return std::move(*error);
        window = around(window, data_window(pictures[i]));
    }
    const std::int64_t width = width_of(window), height = height_of(window);
    if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
        return bad_input(
            fmt::format("'{}' and {} more span {}x{} pixels; at most 65536 a side "
                        "and 2^28 in all can be joined: crop their data windows",
                        name_of(options, 0), pictures.size() - 1, width, height));
    }
    return window;
}

// -- flat pictures -----------------------------------------------------------------------------

/// Whether something is seen in a pixel: it has a depth, and is not wholly clear.
bool is_seen(const FlatPicture& picture, std::size_t i) {
    return std::isfinite(picture.depth.pixels[i]) && picture.color.pixels[i].a != 0;
}

/// Which picture each pixel is taken from: of those that see something there the nearest, else the
/// first one that has the pixel.
std::vector<std::uint32_t> nearest(std::span<const ExrPicture> pictures,
                                   std::span<const Window> windows) {
    const auto& first = std::get<FlatPicture>(pictures[0]);
    std::vector<std::uint32_t> owners(first.depth.pixels.size(), 0);
    std::vector<float> best(owners.size(), std::numeric_limits<float>::infinity());
    for (auto k = static_cast<std::uint32_t>(pictures.size()); k-- > 0;) {
        // From the last to the first, so that ties, and pixels in which nothing is seen, go to the
        // first.
        const auto& picture = std::get<FlatPicture>(pictures[k]);
        const glm::ivec2 origin = picture.placement.origin;
        for (std::size_t i = 0; i < owners.size(); ++i) {
            if (is_seen(picture, i)) {
                if (!(picture.depth.pixels[i] <= best[i])) continue;
                best[i] = picture.depth.pixels[i];
            } else if (std::isfinite(best[i])) {
                continue;
            } else {
                const std::size_t width = picture.depth.width;
                const glm::ivec2 at(static_cast<int>(i % width), static_cast<int>(i / width));
                if (!contains(windows[k], origin + at)) continue;
            }
            owners[i] = k;
        }
    }
    return owners;
}

template <class T>
void take(Image<T>& into, const Image<T>& from, const std::vector<std::uint32_t>& owners,
          std::uint32_t owner) {
    for (std::size_t i = 0; i < owners.size(); ++i) {
        if (owners[i] == owner) into.pixels[i] = from.pixels[i];
    }
}

/// A layer that not all pictures have is dropped.
template <class T>
void take(std::optional<Image<T>>& into, const std::optional<Image<T>>& from,
          const std::vector<std::uint32_t>& owners, std::uint32_t owner) {
    if (!into || !from) {
        into.reset();
        return;
    }
    take(*into, *from, owners, owner);
}

FlatPicture join_flat(std::vector<ExrPicture>& pictures, std::span<const Window> windows,
                      std::vector<std::uint64_t>* taken) {
    const std::vector<std::uint32_t> owners = nearest(pictures, windows);
    FlatPicture joined = std::move(std::get<FlatPicture>(pictures[0]));
    for (std::uint32_t k = 1; k < pictures.size(); ++k) {
        const auto& picture = std::get<FlatPicture>(pictures[k]);
        take(joined.color, picture.color, owners, k);
        take(joined.depth, picture.depth, owners, k);
        take(joined.normals, picture.normals, owners, k);
        take(joined.objects, picture.objects, owners, k);
        take(joined.triangles, picture.triangles, owners, k);
    }
    if (taken != nullptr) taken->assign(pictures.size(), 0);
    for (std::size_t i = 0; i < owners.size(); ++i) {
        if (!is_seen(joined, i)) {
            joined.depth.pixels[i] = std::numeric_limits<float>::infinity();
        } else if (taken != nullptr) {
            ++(*taken)[owners[i]];
        }
    }
    return joined;
}

DeepImage join_all_deep(std::span<const ExrPicture> pictures, const CompositeOptions& options) {
    std::vector<const DeepImage*> images;
    for (const ExrPicture& picture : pictures) images.push_back(&std::get<DeepImage>(picture));
    if (options.taken != nullptr) {
        options.taken->clear();
        for (const DeepImage* image : images) options.taken->push_back(image->samples.size());
    }
    return join_deep(images, options.threads);
}

template <class T>
const T* pointer(const std::optional<T>& layer) {
    return layer ? &*layer : nullptr;
}

}  // namespace

ExrLayers layers_of(const FlatPicture& picture) {
    return {&picture.color,
            &picture.depth,
            pointer(picture.normals),
            pointer(picture.objects),
            pointer(picture.triangles),
            picture.placement};
}

Result<ExrPicture> composite(std::vector<ExrPicture> pictures, const CompositeOptions& options) {
    const auto window = common_window(pictures, options);
    if (!window) return window.error();
    try {
        std::vector<Window> windows;
        for (ExrPicture& picture : pictures) {
            windows.push_back(data_window(picture));
            picture = grown(std::move(picture), *window);
        }
        if (is_deep(pictures[0])) return ExrPicture(join_all_deep(pictures, options));
        return ExrPicture(join_flat(pictures, windows, options.taken));
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io, fmt::format("not enough memory to join '{}' with {} more; give "
                                                "fewer or smaller files",
                                                name_of(options, 0), pictures.size() - 1)};
    }
}

}  // namespace sightline
