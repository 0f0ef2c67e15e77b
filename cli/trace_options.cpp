#include "trace_options.hpp"

#include <array>

#include "notes.hpp"
#include "sightline/load.hpp"
#include "tessellate.hpp"

namespace sightline::cli {

constinit const Option kMethodOption = {
    "--algorithm", "fast|pairwise",
    "how it is found; pairwise: every face against every other one (default: fast)"};

TraceMethod read_method(OptionReader& reader) {
    constexpr std::array<std::string_view, 2> kNames = {"fast", "pairwise"};
    const auto method = reader.choice("--algorithm", kNames);
    return method ? static_cast<TraceMethod>(*method) : TraceMethod::fast;
}

Result<Scene> load_for_drawing(const Models& models, bool quiet, Progress& progress) {
    progress.stage("loading");
    Result<Scene> scene = load_scene(models.paths, models.options);
    if (!scene) return scene;
    Notes(quiet, progress).warn_of_files(*scene);
    if (!scene->motions.empty()) *scene = posed(*scene, 0);
    tessellate_for("a drawing is made of triangles", *scene, quiet, progress);
    return scene;
}

void show_progress(Progress& progress, TraceOptions& trace) {
    progress.stage("finding what is visible");
    trace.progress = [&progress](double share) {
        progress.stage("finding what is visible", static_cast<unsigned>(100 * share), 100);
        return true;
    };
}

}  // namespace sightline::cli
