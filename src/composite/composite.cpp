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

namespace sightline {
namespace {

std::string name_of(const CompositeOptions& options, std::size_t i) {
    return i < options.names.size() ? options.names[i] : fmt::format("picture {}", i + 1);
}

/// What must be the same in all pictures.
struct Shape {
    bool deep = false;
    std::uint32_t width = 0, height = 0;
    glm::ivec2 origin{0, 0};
};

Shape shape_of(const ExrPicture& picture) {
    if (const auto* deep = std::get_if<DeepImage>(&picture)) {
        return {true, deep->width, deep->height, deep->placement.origin};
    }
    const FlatPicture& flat = std::get<FlatPicture>(picture);
    return {false, flat.color.width, flat.color.height, flat.placement.origin};
}

/// Why a picture does not go with the first one, if so.
std::optional<Error> misfit(const Shape& first, const Shape& other, const std::string& first_name,
                            const std::string& name) {
    const auto error = [](std::string message) {
        return Error{ErrorKind::bad_input, std::move(message)};
    };
    if (first.deep != other.deep) {
        return error(fmt::format("'{}' is deep but '{}' is flat; give files of one kind",
                                 first.deep ? first_name : name, first.deep ? name : first_name));
    }
    if (first.width != other.width || first.height != other.height) {
        return error(
            fmt::format("'{}' has {}x{} pixels but '{}' has {}x{}; make them with the "
                        "same camera and resolution",
                        first_name, first.width, first.height, name, other.width, other.height));
    }
    if (first.origin != other.origin) {
        return error(fmt::format(
            "the data window of '{}' begins at ({}, {}) but that of '{}' at "
            "({}, {}); make them with the same one",
            first_name, first.origin.x, first.origin.y, name, other.origin.x, other.origin.y));
    }
    return std::nullopt;
}

std::optional<Error> first_misfit(std::span<const ExrPicture> pictures,
                                  const CompositeOptions& options) {
    const Shape first = shape_of(pictures[0]);
    for (std::size_t i = 1; i < pictures.size(); ++i) {
        auto error = misfit(first, shape_of(pictures[i]), name_of(options, 0), name_of(options, i));
        if (error) return error;
    }
    return std::nullopt;
}

// -- flat pictures -----------------------------------------------------------------------------

/// Infinite for what is no depth at all.
float depth_at(const FlatPicture& picture, std::size_t i) {
    const float z = picture.depth.pixels[i];
    return std::isnan(z) ? std::numeric_limits<float>::infinity() : z;
}

/// Which picture each pixel is taken from.
std::vector<std::uint32_t> nearest(std::span<const ExrPicture> pictures) {
    const auto& first = std::get<FlatPicture>(pictures[0]);
    std::vector<std::uint32_t> owners(first.depth.pixels.size(), 0);
    for (std::size_t i = 0; i < owners.size(); ++i) {
        float best = depth_at(first, i);
        for (std::uint32_t k = 1; k < pictures.size(); ++k) {
            const float z = depth_at(std::get<FlatPicture>(pictures[k]), i);
            if (!(z < best)) continue;
            best = z;
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

FlatPicture join_flat(std::vector<ExrPicture>& pictures, std::vector<std::uint64_t>* taken) {
    const std::vector<std::uint32_t> owners = nearest(pictures);
    FlatPicture joined = std::move(std::get<FlatPicture>(pictures[0]));
    for (std::uint32_t k = 1; k < pictures.size(); ++k) {
        const auto& picture = std::get<FlatPicture>(pictures[k]);
        take(joined.color, picture.color, owners, k);
        take(joined.depth, picture.depth, owners, k);
        take(joined.normals, picture.normals, owners, k);
        take(joined.objects, picture.objects, owners, k);
        take(joined.triangles, picture.triangles, owners, k);
    }
    if (taken == nullptr) return joined;
    taken->assign(pictures.size(), 0);
    for (std::size_t i = 0; i < owners.size(); ++i) {
        if (std::isfinite(joined.depth.pixels[i])) ++(*taken)[owners[i]];
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
    if (auto error = first_misfit(pictures, options)) return std::move(*error);
    try {
        if (shape_of(pictures[0]).deep) return ExrPicture(join_all_deep(pictures, options));
        return ExrPicture(join_flat(pictures, options.taken));
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io, fmt::format("not enough memory to join '{}' with {} more; give "
                                                "fewer or smaller files",
                                                name_of(options, 0), pictures.size() - 1)};
    }
}

}  // namespace sightline
