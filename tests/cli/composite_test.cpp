// `sightline composite`.
#include "sightline/composite.hpp"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

/// The cube, and a second one that stands through it and reaches out to the front.
const std::string kTower =
    "o tower\n"
    "v 0.4 -1 0.5\nv 1.4 -1 0.5\nv 1.4 2 0.5\nv 0.4 2 0.5\n"
    "v 0.4 -1 1.3\nv 1.4 -1 1.3\nv 1.4 2 1.3\nv 0.4 2 1.3\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class CompositeCommand : public ProgramTest {
protected:
    void SetUp() override {
        ProgramTest::SetUp();
        write("tower.obj", kTower);
    }

    /// Pictures of one view, whatever is in it.
    void render(std::vector<std::string> models, const std::string& output,
                const std::string& size = "120x90", std::vector<std::string> more = {}) const {
        std::vector<std::string> words = {
            "render", "--eye",  "4,3,6", "--target",     "0.5,0.5,0.5", "--near", "2",   "--far",
            "15",     "--cull", "none",  "--resolution", size,          "-o",     output};
        words.insert(words.end(), models.begin(), models.end());
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run(words);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }
    void succeed(std::vector<std::string> words) const {
        words.insert(words.begin(), "composite");
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
    }
    /// Whether two files have the same bytes, which are nothing to print.
    [[nodiscard]] bool same(const std::string& a, const std::string& b) const {
        return read(a) == read(b);
    }
    [[nodiscard]] std::string path(const std::string& name) const {
        return (folder_ / name).string();
    }

    /// Fog before and behind what stands in it: a few kinds of pixels, over and over.
    void write_deep(const std::string& name, float shift) const {
        DeepImage image{32, 20, {0}, {}, {}};
        for (std::uint32_t i = 0; i < 32 * 20; ++i) {
            const auto f = static_cast<float>(i % 32) / 32;
            const float z = 1 + f + shift;
            if (i % 4 > 0) image.samples.push_back({z, z + 1, {0.2f * f, 0, 0.1f, 0.5f}, 1, i});
            if (i % 4 > 1) image.samples.push_back({z + 2, z + 2, {0, 0.5f, f / 2, 0.5f}, 2, i});
            if (i % 4 > 2) image.samples.push_back({z + 3, z + 3, {1, f, 0, 1}, 3, i});
            image.first.push_back(image.samples.size());
        }
        ASSERT_TRUE(write_deep_exr(path(name), image).ok());
    }
    template <class Picture>
    [[nodiscard]] Picture read_picture(const std::string& name) const {
        auto picture = read_exr(path(name));
        EXPECT_TRUE(picture.ok()) << picture.error().message;
        EXPECT_TRUE(std::holds_alternative<Picture>(*picture));
        return std::get<Picture>(std::move(*picture));
    }
};

TEST_F(CompositeCommand, TwoHalvesGiveTheBytesOfTheWhole) {
    for (const std::string background : {"#ffffff", "none"}) {
        const std::vector<std::string> more = {"--background", background};
        render({"cube.obj"}, "cube.exr", "120x90", more);
        render({"tower.obj"}, "tower.exr", "120x90", more);
        render({"cube.obj", "tower.obj"}, "whole.exr", "120x90", more);
        succeed({"cube.exr", "tower.exr", "-o", "both.exr"});
        succeed({"tower.exr", "cube.exr", "-o", "turned.exr", "--threads", "3"});
        EXPECT_TRUE(same("both.exr", "whole.exr"));
        EXPECT_TRUE(same("turned.exr", "whole.exr"));
        EXPECT_FALSE(same("cube.exr", "whole.exr"));
        EXPECT_FALSE(same("tower.exr", "whole.exr"));
    }
}

TEST_F(CompositeCommand, ShippedModelsGiveTheBytesOfTheWhole) {
    const std::string samples = std::string(SIGHTLINE_SOURCE_DIR) + "/samples/";
    const auto draw = [&](std::vector<std::string> models, const std::string& output) {
        std::vector<std::string> words = {
            "render",  "--eye",     "6,5,9", "--target",  "0,0.5,0", "--near",
            "1",       "--far",     "40",    "--shading", "phong",   "--resolution",
            "200x150", "--samples", "1",     "-o",        output};
        for (const std::string& model : models) words.push_back(samples + model);
        EXPECT_EQ(run(words).status, 0);
    };
    draw({"tee.obj"}, "tee.exr");
    draw({"knot.obj"}, "knot.exr");
    draw({"tee.obj", "knot.obj"}, "whole.exr");
    succeed({"tee.exr", "knot.exr", "-o", "both.exr"});
    EXPECT_TRUE(same("both.exr", "whole.exr"));
    EXPECT_FALSE(same("tee.exr", "whole.exr"));
    EXPECT_FALSE(same("knot.exr", "whole.exr"));
}

TEST_F(CompositeCommand, NormalsAndIdsComeAlongWhereAllHaveThem) {
    render({"cube.obj"}, "cube.exr", "120x90", {"--aov", "normals,ids"});
    render({"tower.obj"}, "tower.exr", "120x90", {"--aov", "normals"});
    render({"cube.obj", "tower.obj"}, "whole.exr", "120x90", {"--aov", "normals"});
    succeed({"cube.exr", "tower.exr", "-o", "both.exr"});
    EXPECT_TRUE(same("both.exr", "whole.exr"));
    succeed({"cube.exr", "-o", "same.exr"});
    EXPECT_TRUE(same("same.exr", "cube.exr"));
}

TEST_F(CompositeCommand, PngAndStandardOutput) {
    render({"cube.obj"}, "cube.exr");
    render({"tower.obj"}, "tower.exr");
    succeed({"cube.exr", "tower.exr", "-o", "both.png"});
    EXPECT_EQ(png_size(read("both.png")), (std::array<unsigned, 2>{120, 90}));
    succeed({"cube.exr", "tower.exr", "-o", "both.exr"});
    for (const std::string format : {"png", "exr"}) {
        const Outcome piped =
            run({"composite", "cube.exr", "tower.exr", "-o", "-", "--output-format", format});
        EXPECT_EQ(piped.status, 0) << piped.err;
        EXPECT_TRUE(piped.out == read("both." + format));
    }
}

TEST_F(CompositeCommand, ReportsForPeopleAndPrograms) {
    render({"cube.obj"}, "cube.exr");
    render({"tower.obj"}, "tower.exr");
    const Outcome flat = run({"composite", "cube.exr", "tower.exr", "-o", "a.exr", "--json"});
    const json report = json::parse(flat.out, nullptr, false);
    EXPECT_EQ(report["files"], 2);
    EXPECT_EQ(report["width"], 120);
    EXPECT_EQ(report["deep"], false);
    EXPECT_TRUE(report.contains("load_ms") && report.contains("composite_ms") &&
                report.contains("write_ms"));
    ASSERT_EQ(report["pixels_taken"].size(), 2U);
    EXPECT_GT(report["pixels_taken"][0], 10);
    EXPECT_GT(report["pixels_taken"][1], 10);
    write_deep("fog.exr", 0);
    const Outcome deep =
        run({"composite", "fog.exr", "fog.exr", "-o", "b.exr", "--json", "--stats"});
    const json counts = json::parse(deep.out, nullptr, false);
    EXPECT_EQ(counts["samples_in"], json({960, 960}));
    EXPECT_EQ(counts["samples"], 960);  // all coincide
    EXPECT_NE(deep.err.find("fog.exr"), std::string::npos);
}

TEST_F(CompositeCommand, PartsOfAPictureAndOtherBackgrounds) {
    render({"cube.obj"}, "whole.exr");
    render({"tower.obj"}, "tower.exr", "120x90", {"--background", "none"});
    render({"cube.obj", "tower.obj"}, "all.exr");
    // The first with a data window of its own: its right half.
    auto half = read_picture<FlatPicture>("whole.exr");
    const auto cut = [](auto& image) {
        auto right = image;
        right.width = 60;
        right.pixels.clear();
        for (std::uint32_t y = 0; y < image.height; ++y) {
            const auto row = image.row(y).subspan(60);
            right.pixels.insert(right.pixels.end(), row.begin(), row.end());
        }
        image = std::move(right);
    };
    cut(half.color);
    cut(half.depth);
    half.placement.origin = {60, 0};
    ASSERT_TRUE(write_exr(path("half.exr"), layers_of(half)).ok());
    // The second with depth 0 where nothing is seen, as other programs have it.
    auto zeros = read_picture<FlatPicture>("tower.exr");
    for (float& z : zeros.depth.pixels) z = std::isfinite(z) ? z : 0;
    ASSERT_TRUE(write_exr(path("zeros.exr"), layers_of(zeros)).ok());
    succeed({"zeros.exr", "half.exr", "-o", "out.exr"});
    const auto out = read_picture<FlatPicture>("out.exr");
    const auto all = read_picture<FlatPicture>("all.exr");
    EXPECT_EQ(out.placement.origin, glm::ivec2(0, 0));
    ASSERT_EQ(out.color.width, 120u);
    for (std::uint32_t y = 0; y < 90; ++y) {
        for (std::uint32_t x = 60; x < 120; ++x) {
            ASSERT_EQ(out.depth.at(x, y), all.depth.at(x, y)) << x << ' ' << y;
            const bool seen = std::isfinite(all.depth.at(x, y));
            ASSERT_EQ(out.color.at(x, y), seen ? all.color.at(x, y) : glm::vec4(0));
        }
    }
}

TEST_F(CompositeCommand, DeepFilesAreMergedAndFlattened) {
    write_deep("a.exr", 0);
    write_deep("b.exr", 0.25f);
    succeed({"a.exr", "b.exr", "-o", "all.exr"});
    succeed({"a.exr", "b.exr", "-o", "again.exr", "--threads", "3"});
    EXPECT_TRUE(same("all.exr", "again.exr"));
    const auto all = read_picture<DeepImage>("all.exr");
    EXPECT_EQ(all.pixel(1).size(), 3U);  // two volumes that overlap in part
    succeed({"a.exr", "b.exr", "--flatten", "-o", "flat.exr"});
    succeed({"all.exr", "--flatten", "-o", "later.exr"});
    EXPECT_TRUE(same("flat.exr", "later.exr"));
    const auto flat = read_picture<FlatPicture>("flat.exr");
    EXPECT_EQ(flat.depth.at(5, 0), 1 + 5.0f / 32);
    EXPECT_TRUE(std::isinf(flat.depth.at(4, 0)));
    EXPECT_NEAR(flat.color.at(5, 0).a, 0.75f, 1e-3f);
    EXPECT_EQ(flat.color.at(7, 0).a, 1);
    succeed({"a.exr", "b.exr", "-o", "all.png"});
    EXPECT_EQ(png_size(read("all.png")), (std::array<unsigned, 2>{32, 20}));
}

bool is_on_path(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
        if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
    }
    return false;
}

/// Colours only: OpenImageIO blends depths as if they were colours.
TEST_F(CompositeCommand, OiiotoolFlattensToTheSamePicture) {
    if (!is_on_path("oiiotool")) GTEST_SKIP() << "no oiiotool";
    write_deep("a.exr", 0);
    write_deep("b.exr", 0.25f);
    succeed({"a.exr", "b.exr", "-o", "all.exr"});
    succeed({"a.exr", "b.exr", "--flatten", "-o", "ours.exr"});
    const std::string command =
        "cd '" + folder_.string() +
        "' && oiiotool all.exr --flatten -o theirs.exr >log 2>&1 && "
        "oiiotool a.exr b.exr --deepmerge --flatten -o merged.exr >log 2>&1";
    // NOLINTNEXTLINE(cert-env33-c): a fixed command
    ASSERT_EQ(std::system(command.c_str()), 0) << read("log");
    const auto ours = read_picture<FlatPicture>("ours.exr");
    for (const std::string name : {"theirs.exr", "merged.exr"}) {
        SCOPED_TRACE(name);
        const auto theirs = read_picture<FlatPicture>(name);
        for (std::size_t i = 0; i < ours.color.pixels.size(); ++i) {
            for (int k = 0; k < 4; ++k) {
                ASSERT_NEAR(ours.color.pixels[i][k], theirs.color.pixels[i][k], 1e-3f);
            }
        }
    }
}

TEST_F(CompositeCommand, FailedJobs) {
    render({"cube.obj"}, "cube.exr");
    render({"cube.obj"}, "small.exr", "60x45");
    render({"cube.obj"}, "depth.exr", "120x90", {"--depth", "only.exr"});
    write_deep("deep.exr", 0);
    write("text.exr", "o cube\nv 0 0 0\n");
    write("cut.exr", read("cube.exr").substr(0, 2000));
    const auto failed = [&](std::vector<std::string> files,
                            std::initializer_list<std::string> needles) {
        files.insert(files.begin(), "composite");
        files.insert(files.end(), {"-o", "out.exr"});
        expect_failure(1, files, needles);
    };
    failed({"cube.exr", "small.exr"}, {"'cube.exr'", "120x90", "'small.exr'", "60x45"});
    failed({"cube.exr", "deep.exr"}, {"'deep.exr' is deep", "'cube.exr' is flat"});
    failed({"deep.exr", "cube.exr"}, {"'deep.exr' is deep", "'cube.exr' is flat"});
    failed({"only.exr"}, {"only.exr", "'R'"});
    failed({"text.exr"}, {"text.exr", "no EXR file"});
    failed({"cube.exr", "cut.exr"}, {"cut.exr", "damaged"});
    failed({"none.exr"}, {"none.exr", "No such file"});
    expect_failure(1, {"composite", "cube.exr", "-o", "nowhere/out.exr"}, {"nowhere"});
}

TEST_F(CompositeCommand, WrongUse) {
    render({"cube.obj"}, "cube.exr");
    expect_failure(2, {"composite", "-o", "out.exr"}, {"no picture", "a.exr"});
    expect_failure(2, {"composite", "cube.exr"}, {"-o"});
    expect_failure(2, {"composite", "-", "-o", "out.exr"}, {"standard input", "name a file"});
    expect_failure(2, {"composite", "cube.exr", "-o", "out.npy"}, {"out.npy", "exr, png"});
    expect_failure(2, {"composite", "cube.exr", "-o", "-"}, {"--output-format"});
    expect_failure(2, {"composite", "cube.exr", "-o", "cube.exr"}, {"cube.exr", "input"});
    expect_failure(2, {"composite", "cube.exr", "-o", "-", "--output-format", "exr", "--json"},
                   {"--json"});
    expect_failure(2, {"composite", "cube.exr", "--flaten", "-o", "out.exr"}, {"--flatten"});
}

}  // namespace
}  // namespace sightline::testing
