// A translucent teapot through a translucent bunny: depth sort and the BSP tree lay the same
// surfaces over one another, but for what snapping explains.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "support/bsp_differences.hpp"
#include "support/files.hpp"
#include "support/models.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

// What lies over each sample of the grid, the farthest first.
class LayerSink final : public RunSink {
public:
    explicit LayerSink(const SampleGrid& grid) : layers(grid.count()), columns_(grid.columns()) {}

    void take(const Run& run) override {
        for (std::int32_t i = run.first; i < run.end; ++i)
            layers[static_cast<std::size_t>(run.row) * columns_ + static_cast<std::size_t>(i)]
                .push_back(run.id);
    }

    std::vector<std::vector<std::uint32_t>> layers;

private:
    std::size_t columns_;
};

std::vector<std::vector<std::uint32_t>> layers_of(const ScreenScene& screen,
                                                  const std::string& algorithm) {
    const SampleGrid grid{screen.resolution(), 1};
    const auto source = must(open_layers(*find_algorithm(algorithm), screen, {}));
    LayerSink sink(grid);
    const std::uint32_t height = source->band_rows();
    for (std::uint32_t b = 0; b * height < grid.rows(); ++b) source->visit_band(b, sink);
    return std::move(sink.layers);
}

// Neighbours of the first order that stand the other way round in the second.
std::vector<std::pair<std::uint32_t, std::uint32_t>> inversions(
    const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::map<std::uint32_t, std::size_t> place;
    for (std::size_t k = 0; k < b.size(); ++k) place[b[k]] = k;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (std::size_t k = 0; k < a.size(); ++k)
        for (std::size_t m = k + 1; m < a.size(); ++m)
            if (place[a[k]] > place[a[m]]) found.emplace_back(a[k], a[m]);
    return found;
}

std::optional<Scene> teapot_through_bunny() {
    const auto bunny = models_folder() / "stanford-bunny.obj",
               teapot = models_folder() / "teapot.obj";
    if (!std::filesystem::exists(bunny) || !std::filesystem::exists(teapot)) return std::nullopt;
    const TemporaryFolder folder;
    const std::vector<std::string> paths{folder.write(
        "both.json", R"({"models": [{"path": ")" + bunny.string() +
                         R"(", "transform": [{"scale": 20}], "material": {"opacity": 0.5}},
                       {"path": ")" +
                         teapot.string() +
                         R"(", "transform": [{"scale": 0.6}], "material": {"opacity": 0.5}}]})")};
    return must(load_scene(paths));
}

TEST(BlendModels, TeapotThroughBunny) {
#ifdef SIGHTLINE_SANITIZED
    GTEST_SKIP() << "what it runs is run by smaller scenes under the sanitizers";
#endif
    const std::optional<Scene> scene = teapot_through_bunny();
    if (!scene) GTEST_SKIP() << "no models in " << models_folder() << "; set SIGHTLINE_MODELS";
    const Camera camera = must(make_camera({}, scene->bounds, {480, 360}));
    const ScreenScene screen = must(project(*scene, camera));
    const auto sorted = layers_of(screen, "depth-sort"), tree = layers_of(screen, "bsp");

    std::uint64_t deep = 0, other_order = 0;
    std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs(sorted.size());
    std::size_t most = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        deep += sorted[i].size() > 3;
        // The same surfaces, each once.
        std::vector<std::uint32_t> a = sorted[i], b = tree[i];
        std::ranges::sort(a);
        std::ranges::sort(b);
        ASSERT_EQ(a, b) << "sample " << i;
        ASSERT_EQ(std::ranges::adjacent_find(a), a.end());
        pairs[i] = inversions(sorted[i], tree[i]);
        other_order += !pairs[i].empty();
        most = std::max(most, pairs[i].size());
    }
    EXPECT_GT(deep, 5000u);
    EXPECT_LT(other_order, sorted.size() / 1000);

    // Every pair in another order is one that snapping may exchange.
    const DifferenceJudge judge(screen);
    for (std::size_t k = 0; k < most; ++k) {
        Visibility first, second;
        first.grid = second.grid = {screen.resolution(), 1};
        first.ids.assign(sorted.size(), kNone);
        second.ids = first.ids;
        for (std::size_t i = 0; i < sorted.size(); ++i) {
            if (k >= pairs[i].size()) continue;
            first.ids[i] = pairs[i][k].first;
            second.ids[i] = pairs[i][k].second;
        }
        const Differences differences = judge.compare(first, second);
        EXPECT_EQ(differences.unexplained, 0u) << differences.first;
    }
}

}  // namespace
}  // namespace sightline
