// Options that several commands share, and the reading of values: every value that does not hold
// is reported with the option's name, the value and what was expected.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "commands.hpp"
#include "sightline/camera.hpp"
#include "sightline/load.hpp"
#include "sightline/screen_scene.hpp"
#include "sightline/visibility.hpp"

namespace sightline::cli {

// -- rows of the help --------------------------------------------------------------------------

extern const std::span<const Option> kCameraOptions;  ///< gaze, projection, planes, resolution
extern const std::span<const Option> kModelOptions;   ///< --format
extern const std::span<const Option> kCommonOptions;  ///< threads, stats, json, ...
extern const Option kCullOption;

// -- values ------------------------------------------------------------------------------------

/// A number (not NaN, not infinite) that fills all of `text`; blanks around it are allowed.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view text);
/// "x,y,z".
[[nodiscard]] std::optional<glm::dvec3> parse_point(std::string_view text);
/// "WxH", without limits on the sides.
[[nodiscard]] std::optional<glm::u64vec2> parse_size(std::string_view text);
/// "R,G,B[,A]" in 0..255, "#rrggbb[aa]" or "none": sRGB with straight alpha, 0..255 a component.
[[nodiscard]] std::optional<glm::u8vec4> parse_color(std::string_view text);
/// At the commas; blanks around the items are dropped.
[[nodiscard]] std::vector<std::string_view> split_list(std::string_view text);

/// An interval of numbers; an open end does not belong to it.
struct Range {
    double low, high;
    bool low_open = false, high_open = false;
    [[nodiscard]] bool contains(double x) const {
        return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
    }
};

/// Reads values of options one after another and keeps the first error, so that a command reads
/// everything and asks once.
class OptionReader {
public:
    explicit OptionReader(const Arguments& arguments) : arguments_(arguments) {}

    /// `expected` ends the message: "--fov: '200' is not <expected>".
    std::optional<double> number(std::string_view option, Range range, std::string_view expected);
    std::optional<std::uint64_t> count(std::string_view option, std::uint64_t low,
                                       std::uint64_t high, std::string_view expected);
    std::optional<glm::dvec3> point(std::string_view option);
    std::optional<glm::u8vec4> color(std::string_view option);
    /// One of `names`; gives its index.
    std::optional<std::size_t> choice(std::string_view option,
                                      std::span<const std::string_view> names);
    /// Algorithms by name, at the commas; none when the option is absent.
    std::vector<const Algorithm*> algorithms(std::string_view option);

    void fail(Error error) {
        if (!error_) error_ = std::move(error);
    }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }
    [[nodiscard]] const Arguments& arguments() const { return arguments_; }

private:
    void reject(std::string_view option, std::string_view value, std::string_view expected);

    const Arguments& arguments_;
    std::optional<Error> error_;
};

// -- groups of options -------------------------------------------------------------------------

struct CommonOptions {
    int threads = 0;  ///< 0 = all cores
    bool quiet = false, stats = false, json = false;
};

/// Cores that may be used, when --threads does not say otherwise.
[[nodiscard]] int all_threads();

/// Reads the common options and puts them into force: limits the number of threads and starts the
/// watch of --time-limit.
[[nodiscard]] CommonOptions read_common(OptionReader& reader);

/// The camera of the command line, checked as far as it can be without a model.
[[nodiscard]] CameraOptions read_camera(OptionReader& reader);

/// `over` where it says something, else `under` (a camera of a scene file). Where both together say
/// too much (eye, target and a direction or view), what `under` said gives way.
[[nodiscard]] CameraOptions merge_cameras(const CameraOptions& under, const CameraOptions& over);

/// Merges likewise, under `asked`, the camera of the file that a scene was loaded from, if it has
/// one.
[[nodiscard]] CameraOptions merge_cameras(const Scene& scene, const CameraOptions& asked);

/// The camera of a loaded scene: the command line over that of a scene file. It is fitted to all
/// frames of what moves.
[[nodiscard]] Result<Camera> camera_for(const Scene& scene, const CameraOptions& asked,
                                        Resolution resolution);

/// --resolution within the limits of project(). Those of all pixels together are by default the
/// ones of resolve(), which keeps the whole picture in memory.
[[nodiscard]] Resolution read_resolution(OptionReader& reader, Resolution fallback,
                                         std::uint64_t max_pixels = kMaxSamples);

/// auto, none, back, front.
[[nodiscard]] std::string_view name_of(Cull cull);
[[nodiscard]] Cull read_cull(OptionReader& reader, Cull fallback);

/// Model paths and --format, checked; `required` = at least one.
struct Models {
    std::vector<std::string> paths;
    LoadOptions options;
};
[[nodiscard]] Models read_models(OptionReader& reader, bool required = true);

}  // namespace sightline::cli
