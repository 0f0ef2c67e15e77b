// Visibility: which triangle is seen at each sample, and the algorithms that decide it.
//
// The canonical answer at a sample is the triangle that covers it (top-left rule on the snapped
// edges) with the exactly smallest depth; a tie goes to the lower id. Every algorithm that promises
// exactness gives it in every sample. A quadric takes part with the z of hit_quadric(), in the
// algorithms that can compute it.
#pragma once

#include <cstdint>
#include <memory>
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

/// The largest grid that resolve() takes.
inline constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 28;

/// What is seen at the samples of a grid: ids and depth, row by row from the top; of all rows, or
/// of a band of a picture that is made in bands.
struct Visibility {
    SampleGrid grid;
    /// Of triangles, or of quadrics, see Scene::quadrics; kNone where nothing is seen.
    AlignedVector<std::uint32_t> ids;
    /// z of the winner in units of the depth grid, as stored_depth() gives it, or a quadric's z
    /// as a float; infinity where nothing is seen. For lengths in the scene's unit see depth_map().
    AlignedVector<float> depth;
    std::uint32_t first_row = 0;  ///< row of the grid with which ids and depth begin

    /// Rows of samples that are held.
    [[nodiscard]] std::uint32_t rows() const {
        return static_cast<std::uint32_t>(ids.size() / grid.columns());
    }
};

/// Whether something is seen at one of the samples. Ends at the first.
[[nodiscard]] bool sees_anything(const Visibility& visibility);

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
    depths_compared,   ///< depths of two surfaces are compared (triangle, other; area)
    exact_comparison,  ///< the float filter could not decide between two (triangle, other)
    edge_activated,    ///< an edge joins the active edge list (triangle; area: its column and row)
    span_decided,      ///< a stretch of a row gets an owner (triangle; area)
    span_split,        ///< two surfaces cross on a stretch of a row (triangle, other; area)
    quadrant_split,    ///< a quadrant is divided into four (area)
    quadrant_decided,  ///< all samples of a quadrant get an owner, or none (triangle; area)
    quadrant_scanned,  ///< the only triangle of a quadrant is drawn over the background (triangle;
                       ///< area)
    polygons_tested,   ///< may a polygon be painted before another one? (triangle, other)
    polygons_exchanged,  ///< the other one has to be painted first (triangle, other)
    polygon_split,       ///< a polygon is cut by the plane of another one (triangle, other)
    polygon_painted,     ///< a polygon, or a piece of one, gets its place in the order (triangle)
    node_entered,        ///< a node of a BSP tree is met on the way from back to front (triangle:
                         ///< the first of its plane, kNone where it is a plane of no triangle)
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

class BspTree;
struct PieceOrder;

struct ResolveOptions {
    std::uint32_t samples_per_axis = 1;
    int threads = 0;  ///< 0 = all cores
    Observer* observer = nullptr;
    /// Appended to, when given: what the algorithm did.
    std::vector<Counter>* counters = nullptr;
    /// For "bsp": the tree of the scene, see sightline/bsp.hpp. Made anew when there is none.
    const BspTree* tree = nullptr;
};

/// An answer that is made in bands of rows, on demand: what a picture needs that is too large to
/// stand in memory. Refers to its ScreenScene.
class RowSource {
public:
    virtual ~RowSource() = default;
    /// Rows of samples in a band; the last band may have fewer.
    [[nodiscard]] virtual std::uint32_t band_rows() const = 0;
    /// Fills a band's rows. ids and depth hold them from the band's first row on. Any number of
    /// threads may work on different bands.
    virtual void resolve_band(std::uint32_t band, std::uint32_t* ids, float* depth) = 0;
    /// Appends what was counted so far to the counters of the options.
    virtual void report() = 0;
};

/// A stretch of a row that a surface covers.
struct Run {
    std::uint32_t id = kNone;         ///< of the triangle in the scene
    std::int32_t row = 0;             ///< of the grid
    std::int32_t first = 0, end = 0;  ///< columns first .. end-1, at least one
};

class RunSink {
public:
    virtual ~RunSink() = default;
    virtual void take(const Run& run) = 0;
};

/// All that covers the samples, also what is hidden, surface over surface from back to front: what
/// transparency needs. It is made in bands of rows. Refers to its ScreenScene.
class LayerSource {
public:
    virtual ~LayerSource() = default;
    /// Rows of samples in a band; the last band may have fewer.
    [[nodiscard]] virtual std::uint32_t band_rows() const = 0;
    /// Hands over the runs of a band. Of two at one sample the farther one comes first; of exactly
    /// equally deep ones, as along a fold, either. Any number of threads may work on different
    /// bands.
    virtual void visit_band(std::uint32_t band, RunSink& sink) = 0;
    /// Appends what was counted so far to the counters of the options.
    virtual void report() = 0;
};

class FragmentSource;

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
    bool quadrics = false;    ///< takes quadrics as they are, not tessellated
    /// Exactly one of the two is set: an algorithm makes the whole picture, or any band of it.
    void (*resolve)(const ScreenScene&, const ResolveOptions&, Visibility&) = nullptr;
    std::unique_ptr<RowSource> (*open_rows)(const ScreenScene&, const SampleGrid&,
                                            const ResolveOptions&) = nullptr;
    /// Set where the algorithm finds the order of all surfaces at a sample, so that translucent
    /// ones can be blended.
    std::unique_ptr<LayerSource> (*open_layers)(const ScreenScene&, const SampleGrid&,
                                                const ResolveOptions&) = nullptr;
    /// Set where the algorithm keeps what is in a pixel between its samples; see
    /// sightline/fragments.hpp.
    Result<std::unique_ptr<FragmentSource>> (*open_fragments)(const ScreenScene&,
                                                              const ResolveOptions&) = nullptr;
    /// Set for list-priority algorithms; see sightline/order.hpp.
    PieceOrder (*order)(const ScreenScene&, const ResolveOptions&) = nullptr;
};

/// All algorithms; the first exact one that is not exhaustive is the default.
[[nodiscard]] std::span<const Algorithm> algorithms();
[[nodiscard]] const Algorithm* find_algorithm(std::string_view name);
[[nodiscard]] const Algorithm& default_algorithm();

/// The rows of an algorithm that makes them in bands (Algorithm::open_rows is set), for pictures of
/// up to 65,536 pixels a side. options.observer and .counters must outlive the source.
/// Error (bad_option): samples_per_axis and quadrics as for resolve(); the algorithm needs the
/// whole picture.
[[nodiscard]] Result<std::unique_ptr<RowSource>> open_rows(const Algorithm& algorithm,
                                                           const ScreenScene& screen,
                                                           const ResolveOptions& options);

/// The layers of an algorithm that has them (Algorithm::open_layers is set). Lifetimes and errors
/// as for open_rows().
[[nodiscard]] Result<std::unique_ptr<LayerSource>> open_layers(const Algorithm& algorithm,
                                                               const ScreenScene& screen,
                                                               const ResolveOptions& options);

/// Runs an algorithm into `out`, whose memory is reused when it has the right size.
/// Error (bad_option): samples_per_axis is not a power of two up to 16, or the grid is larger than
/// 2^28 samples; the scene has quadrics and the algorithm takes none: tessellate_quadrics().
[[nodiscard]] Status resolve(const Algorithm& algorithm, const ScreenScene& screen,
                             const ResolveOptions& options, Visibility& out);

}  // namespace sightline
