// Visibility: which triangle is seen at each sample, and the algorithms that decide it.
//
// The canonical answer at a sample is the triangle that covers it (top-left rule on the snapped
// edges) with the exactly smallest depth; a tie goes to the lower id. Every algorithm that promises
// exactness gives it in every sample.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/aligned_vector.hpp"
#include "sightline/error.hpp"
#include "sightline/screen_scene.hpp"

namespace sightline {

/// The samples of a picture: n x n in each pixel, sample (i, j) of a pixel at ((i + 1/2)/n,
/// (j + 1/2)/n). n = 1 is the pixel's centre. n must be a power of two up to 16.
struct SampleGrid {
    Resolution resolution;
    std::uint32_t per_axis = 1;

    [[nodiscard]] std::uint32_t columns() const { return resolution.width * per_axis; }
    [[nodiscard]] std::uint32_t rows() const { return resolution.height * per_axis; }
    [[nodiscard]] std::uint64_t count() const { return std::uint64_t{columns()} * rows(); }
    /// Distance of neighbouring samples, and position of the first one, in units of the screen.
    [[nodiscard]] std::int32_t step(int subpixel_bits) const {
        return (std::int32_t{1} << subpixel_bits) / static_cast<std::int32_t>(per_axis);
    }
    [[nodiscard]] std::int32_t offset(int subpixel_bits) const { return step(subpixel_bits) / 2; }
};

/// What is seen at every sample of a grid: ids and depth, row by row from the top.
struct Visibility {
    SampleGrid grid;
    AlignedVector<std::uint32_t> ids;  ///< of triangles; kNone where nothing is seen
    /// z of the winner in units of the depth grid, as stored_depth() gives it; infinity where
    /// nothing is seen. For lengths in the scene's unit see depth_map().
    AlignedVector<float> depth;
};

/// The depth of a plane at a point of the screen, in units of the depth grid: computed from the
/// integers of the plane, within 2^-20 of the rational value, and clamped to 0 .. 2^30. Every depth
/// that is written to a file comes from here. Precondition: plane.c > 0.
[[nodiscard]] double evaluate_depth(const Plane& plane, std::int32_t x, std::int32_t y);

/// The same in single precision, as every algorithm leaves it in Visibility::depth: one fixed
/// sequence of IEEE operations, so it does not depend on the algorithm that found the winner.
/// Within kStoredDepthError of the rational value.
[[nodiscard]] float stored_depth(const Plane& plane, std::int32_t x, std::int32_t y);

/// Bound of stored_depth's error, in units of the depth grid; derived in src/visibility/depth.cpp.
inline constexpr float kStoredDepthError = 400.0f;

/// One named number that an algorithm counted ("exact comparisons", "tiles", ...).
struct Counter {
    std::string name;
    std::uint64_t value = 0;
};

/// The steps of an algorithm, as a textbook would show them. An Observer is told of each.
enum class StepKind {
    triangle_taken,    ///< a triangle is looked at (triangle)
    tile_entered,      ///< work on a part of the picture begins (area)
    block_dismissed,   ///< a triangle is hidden in all of a block (triangle, area)
    sample_decided,    ///< a sample gets an owner (triangle; other = owner before; area = sample)
    exact_comparison,  ///< the float filter could not decide between two (triangle, other)
};

struct Step {
    StepKind kind{};
    std::uint32_t triangle = kNone, other = kNone;
    /// In samples, half-open: x0 <= x < x1.
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Watches an algorithm at work. Called from one thread at a time: an algorithm that is watched
/// runs on one thread. Without an observer the calls are compiled out of the inner loops.
class Observer {
public:
    virtual ~Observer() = default;
    virtual void step(const Step& step) = 0;
};

struct ResolveOptions {
    std::uint32_t samples_per_axis = 1;
    int threads = 0;  ///< 0 = all cores
    Observer* observer = nullptr;
    /// Appended to, when given: what the algorithm did.
    std::vector<Counter>* counters = nullptr;
};

/// Where an algorithm decides (Sutherland, Sproull, Schumacker 1974).
enum class Space { image, object, list_priority };

/// One row of the registry.
struct Algorithm {
    std::string_view name;      ///< as in --algorithm
    std::string_view title;     ///< for people
    std::string_view citation;  ///< author, title, year
    std::string_view help;      ///< one line
    Space space = Space::image;
    bool exact = true;        ///< promises the canonical answer in every sample
    bool exhaustive = false;  ///< cost grows with samples times triangles: for small scenes
    void (*resolve)(const ScreenScene&, const ResolveOptions&, Visibility&) = nullptr;
};

/// All algorithms; the first exact one that is not exhaustive is the default.
[[nodiscard]] std::span<const Algorithm> algorithms();
[[nodiscard]] const Algorithm* find_algorithm(std::string_view name);
[[nodiscard]] const Algorithm& default_algorithm();

/// Runs an algorithm into `out`, whose memory is reused when it has the right size.
/// Error (bad_option): samples_per_axis is not a power of two up to 16, or the grid is larger than
/// 2^28 samples.
[[nodiscard]] Status resolve(const Algorithm& algorithm, const ScreenScene& screen,
                             const ResolveOptions& options, Visibility& out);

}  // namespace sightline
