// Pictures joined by depth: flat ones, of which the nearest pixel is taken, and deep ones, of which
// all samples are kept in their order.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sightline/error.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// A picture with one depth a pixel, as flat EXR files hold it.
struct FlatPicture {
    ColorImage color;
    DepthImage depth;
    std::optional<NormalImage> normals;
    std::optional<IdImage> objects, triangles;
    Placement placement = {};
};

/// What write_exr() takes; valid as long as the picture.
[[nodiscard]] ExrLayers layers_of(const FlatPicture& picture);

using ExrPicture = std::variant<FlatPicture, DeepImage>;

/// Reads an EXR file of scan lines or tiles, or of deep scan lines; of several parts the first. It
/// needs R, G, B and Z; without A a pixel is opaque where its depth is finite. Taken along where
/// they are there: N.X N.Y N.Z, and "object" and "triangle" of whole numbers; of deep files ZBack,
/// "object" and "triangle". Numbers of any type become float, halves without loss.
///
/// Limits: 65,536 pixels a side, 2^28 pixels and 2^28 samples. Errors: io for a file that can't be
/// opened and when memory is short; bad_input for what is no such EXR file, or a damaged one.
[[nodiscard]] Result<ExrPicture> read_exr(const std::string& path);

struct CompositeOptions {
    int threads = 0;                       ///< 0 = all cores; the result depends on none
    std::span<const std::string> names{};  ///< of the pictures, for messages; may be empty
    /// Of each picture: how many pixels it gave (flat; background counts nowhere) or how many
    /// samples it had (deep). Null: not wanted.
    std::vector<std::uint64_t>* taken = nullptr;
};

/// Joins pictures by depth.
///
/// The result has the smallest data window that holds those of all, and the display window of the
/// first.
///
/// Flat ones: every pixel, with all of its channels, is that of the picture with the smallest
/// depth; a tie goes to the earlier one. Pixels with alpha 0, or without a finite depth, see
/// nothing and don't count; where all are such the pixel of the first that has it stays, with
/// infinite depth. Normals and ids are kept where all have them. Pixels are not blended:
/// translucent ones want deep pictures.
///
/// Deep ones: the samples of all become one tidy list in each pixel: sorted by z, without overlaps.
/// Volumes are split where others begin or end, and what then coincides is merged (P. Hillman,
/// "The Theory of OpenEXR Deep Samples", 2013; F. Kainz, "Interpreting OpenEXR Deep Pixels", 2013).
/// A merged sample has the ids of the one that absorbs most, of equals those of the first. Samples
/// without a depth (NaN) are dropped.
///
/// Precondition: at least one picture. Errors: bad_input for flat and deep ones together, for
/// pictures with neither one display window nor one data window, and for a result beyond the limits
/// of read_exr(); io when memory is short.
[[nodiscard]] Result<ExrPicture> composite(std::vector<ExrPicture> pictures,
                                           const CompositeOptions& options = {});

/// What a deep picture looks like: the samples of each pixel laid over one another, and the depth
/// of the nearest one that is not wholly clear; infinite where there is none. The picture need not
/// be tidy.
[[nodiscard]] FlatPicture flatten(const DeepImage& image, int threads = 0);

}  // namespace sightline
