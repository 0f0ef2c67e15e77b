#include "support/soak.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>

#include "math/predicates.hpp"
#include "sightline/bsp.hpp"
#include "support/bsp_differences.hpp"
#include "support/models.hpp"
#include "support/targets.hpp"

namespace sightline::testing {
namespace {

/// One view in so many shows a real model.
constexpr std::uint64_t kModelEvery = 50;
/// So many views in succession show one scene, for making it takes longer than a view.
constexpr std::uint64_t kViewsOfScene = 4;
constexpr std::uint32_t kMostSamples = 4096;  ///< of a view
/// List-priority algorithms cut what crosses, so that larger models take seconds a view.
constexpr std::uint32_t kMostForLists = 3000;

/// The answer is that of the layers nearest to the eye.
constexpr std::string_view kLayers = " layers";

/// What takes turns: all that is exact but the z-buffer, and bsp.
const std::vector<std::string>& others() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Algorithm& a : algorithms()) {
            if ((!a.exact && a.name != kTreeAlgorithm) || a.exhaustive || a.name == "zbuffer")
                continue;
            all.emplace_back(a.name);
            if (a.exact && a.open_layers != nullptr)
                all.push_back(std::string(a.name) + std::string(kLayers));
        }
        return all;
    }();
    return names;
}

bool needs_lists(const std::string& name) {
    return name.starts_with("depth-sort") || name == kTreeAlgorithm;
}

/// Keeps the last run at each sample, which is the nearest.
struct Nearest final : RunSink {
    explicit Nearest(Visibility& answer) : out(answer) {}
    void take(const Run& run) override {
        const auto row =
            out.ids.begin() + static_cast<std::ptrdiff_t>(run.row) * out.grid.columns();
        std::fill(row + run.first, row + run.end, run.id);
    }
    Visibility& out;
};

Visibility nearest_layers(const std::string& algorithm, const ScreenScene& screen,
                          const ResolveOptions& options) {
    Visibility out;
    out.grid = {screen.resolution(), options.samples_per_axis};
    out.ids.assign(out.grid.count(), kNone);
    const auto source = must(open_layers(*find_algorithm(algorithm), screen, options));
    Nearest sink(out);
    for (std::uint32_t row = 0, band = 0; row < out.grid.rows(); row += source->band_rows())
        source->visit_band(band++, sink);
    return out;
}

// Whether a triangle is drawn whose box is of the z-buffer's tiniest kind, and holds a sample.
bool has_tiny_triangles(const ScreenScene& screen, std::uint32_t samples_per_axis) {
    const std::int32_t step = (1 << screen.subpixel_bits()) / static_cast<int>(samples_per_axis);
    const auto further = [step](std::int32_t lo, std::int32_t hi) {
        return (hi - step / 2) / step - (lo + step / 2 - 1) / step;  // samples less one
    };
    for (std::uint32_t k = 0; k < screen.scene().triangle_count(); ++k) {
        if (!screen.drawable(k)) continue;
        const Corners c = screen.corners(k);
        const ScreenPoint &p = screen.point(c.x), &q = screen.point(c.y), &r = screen.point(c.z);
        const auto [x0, x1] = std::minmax({p.x, q.x, r.x});
        const auto [y0, y1] = std::minmax({p.y, q.y, r.y});
        if (x0 < 0 || y0 < 0) continue;
        const std::int32_t columns = further(x0, x1), rows = further(y0, y1);
        if (std::min(columns, rows) >= 0 && std::max(columns, rows) < 3) return true;
    }
    return false;
}

std::string first_difference(const Visibility& truth, const Visibility& seen, bool ids_only) {
    const auto name = [](std::uint32_t id) {
        return id == kNone ? std::string("nothing") : std::to_string(id);
    };
    for (std::size_t i = 0; i < truth.ids.size(); ++i) {
        const bool same_depth =
            ids_only || std::memcmp(&truth.depth[i], &seen.depth[i], sizeof(float)) == 0;
        if (truth.ids[i] == seen.ids[i] && same_depth) continue;
        const std::uint32_t columns = truth.grid.columns();
        return "at (" + std::to_string(i % columns) + ", " + std::to_string(i / columns) + ") " +
               name(seen.ids[i]) + " in the place of " + name(truth.ids[i]);
    }
    return {};
}

// Of layers that are exactly equally deep at a sample either may come first.
bool are_tied(const ScreenScene& screen, const Visibility& a, const Visibility& b, std::size_t at) {
    if (a.ids[at] == kNone || b.ids[at] == kNone) return false;
    const std::int32_t step = a.grid.step(screen.subpixel_bits());
    const std::int32_t offset = a.grid.offset(screen.subpixel_bits());
    const auto column = static_cast<std::int32_t>(at % a.grid.columns());
    const auto row = static_cast<std::int32_t>(at / a.grid.columns());
    return compare_depth_exactly(screen.plane(a.ids[at]), screen.plane(b.ids[at]),
                                 offset + column * step, offset + row * step) == 0;
}

}  // namespace

struct Soak::Model {
    explicit Model(Scene s) : scene(std::move(s)) {}
    Scene scene;
    std::optional<BspTree> tree;
};

struct Soak::Job {
    std::uint64_t seed;
    const Scene& scene;
    Model* model;  ///< null: a scene made for this
    View view;
    ScreenScene screen;
    ResolveOptions options;
    Visibility truth;
};

Soak::Soak(std::ostream& log) : log_(log), targets_(vector_targets()) {}
Soak::~Soak() = default;

// The samples of the repository, and the larger ones where they are (models.hpp).
void Soak::load_models() {
    if (std::exchange(models_loaded_, true)) return;
    std::vector<std::string> paths;
    for (const std::filesystem::path& folder :
         {std::filesystem::path(SIGHTLINE_SOURCE_DIR) / "samples", models_folder()}) {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
            const std::string ending = entry.path().extension().string();
            if (ending == ".obj" || ending == ".ply") paths.push_back(entry.path().string());
        }
    }
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
        constexpr std::uint32_t kMostTriangles = 20000;
        Result<Scene> scene = load_scene(std::vector<std::string>{path});
        if (scene.ok() && scene.value().triangle_count() > 0 &&
            scene.value().triangle_count() <= kMostTriangles)
            models_.push_back(std::make_unique<Model>(std::move(scene).value()));
    }
}

Soak::Model* Soak::model_of(std::uint64_t seed) {
    if (seed % kModelEvery != kModelEvery - 1) return nullptr;
    load_models();
    return models_.empty() ? nullptr : models_[seed / kModelEvery % models_.size()].get();
}

void Soak::compare_view(std::uint64_t seed) {
    if (Model* model = model_of(seed))
        compare(model->scene, model, seed, model->scene.triangle_count() <= kMostForLists);
    else
        compare(random_scene(seed / kViewsOfScene), nullptr, seed, true);
}

void Soak::compare_view(const Scene& scene, std::uint64_t seed, bool lists) {
    compare(scene, nullptr, seed, lists);
}

void Soak::compare(const Scene& scene, Model* model, std::uint64_t seed, bool lists) {
    Job job{seed, scene, model, random_view(scene, seed, kMostSamples), {}, {}, {}};
    {
        const ForcedTarget plain(targets_.back());
        job.screen = must(project(scene, job.view.camera, job.view.options));
    }
    job.options.threads = job.view.options.threads;
    job.options.samples_per_axis = job.view.samples_per_axis;
    job.truth = run("brute", job.screen, job.options);
    count_view(job);
    for (const std::int64_t target : targets_) compare_on(job, "zbuffer", target);
    // Each of the others meets each target, as their numbers of turns have no common factor.
    for (std::uint64_t k = 0; k < 2; ++k) {
        const std::uint64_t turn = 2 * seed + k;
        const std::string& name = others()[turn % others().size()];
        if (needs_lists(name) && !lists) continue;
        compare_on(job, name, targets_[turn / others().size() % targets_.size()]);
    }
}

void Soak::compare_samples(std::uint64_t first_seed, std::uint64_t samples) {
    const std::uint64_t end = sum().samples + samples;
    for (std::uint64_t seed = first_seed; sum().samples < end; ++seed) compare_view(seed);
}

Soak::Row Soak::sum() const {
    Row sum;
    for (const auto& [key, row] : rows_) {
        sum.views += row.views;
        sum.samples += row.samples;
        sum.differing += row.differing;
    }
    return sum;
}

void Soak::count_view(const Job& job) {
    ++views_.views;
    views_.samples += job.truth.ids.size();
    for (const std::uint32_t id : job.truth.ids) views_.covered += id != kNone;
    views_.of_models += job.model != nullptr;
    views_.clipped_and_tiny += job.screen.counts().clipped > 0 &&
                               has_tiny_triangles(job.screen, job.view.samples_per_axis);
}

void Soak::compare_on(const Job& job, const std::string& algorithm, std::int64_t target) {
    const ForcedTarget forced(target);
    const ScreenScene screen = must(project(job.scene, job.view.camera, job.view.options));
    if (!std::ranges::equal(screen.points(), job.screen.points())) {
        add(job, algorithm, target, job.truth.ids.size(), "the snapped points");
        return;
    }
    std::string first;
    const std::uint64_t differing = differences(job, screen, algorithm, first);
    add(job, algorithm, target, differing, first);
}

std::uint64_t Soak::differences(const Job& job, const ScreenScene& screen,
                                const std::string& algorithm, std::string& first) {
    ResolveOptions options = job.options;
    if (algorithm == kTreeAlgorithm) {
        if (job.model != nullptr) {
            if (!job.model->tree) job.model->tree = must(build_bsp(job.scene));
            options.tree = &*job.model->tree;
        }
        const Visibility seen = run(algorithm, screen, options);
        const Differences found = DifferenceJudge(screen).compare(job.truth, seen);
        grazed_ += found.grazed;
        first = found.first;
        return found.unexplained;
    }
    if (algorithm.ends_with(kLayers)) {
        const Visibility seen =
            nearest_layers(algorithm.substr(0, algorithm.size() - kLayers.size()), screen, options);
        std::uint64_t differing = 0;
        for (std::size_t i = 0; i < seen.ids.size(); ++i)
            differing += seen.ids[i] != job.truth.ids[i] && !are_tied(screen, job.truth, seen, i);
        if (differing > 0) first = first_difference(job.truth, seen, true);
        return differing;
    }
    const Visibility seen = run(algorithm, screen, options);
    const std::uint64_t differing = count_differences(job.truth, seen);
    if (differing > 0) first = first_difference(job.truth, seen, false);
    return differing;
}

void Soak::add(const Job& job, const std::string& algorithm, std::int64_t target,
               std::uint64_t differing, const std::string& first) {
    const std::string target_name = hwy::TargetName(target);
    Row& row = rows_[{algorithm, target_name}];
    ++row.views;
    row.samples += job.truth.ids.size();
    row.differing += differing;
    if (differing == 0) return;
    log_ << "seed " << job.seed << ": " << algorithm << " on " << target_name << " differs in "
         << differing << " of " << job.truth.ids.size() << " samples, first " << first << "\n"
         << std::flush;
}

}  // namespace sightline::testing
