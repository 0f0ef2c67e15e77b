// draw(): the bytes of every file are those of the functions that take whole pictures.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "shading/draw_groups.hpp"
#include "shading/view_of.hpp"
#include "support/files.hpp"
#include "support/scenes.hpp"

namespace sightline::test {
namespace {

using testing::read_file;
using testing::SceneBuilder;
using testing::TemporaryFolder;

/// A bowl of smooth triangles, each of its own colour, and two that cross it.
Scene bowl() {
    SceneBuilder builder;
    constexpr int kSide = 9;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const auto at = [](int i, int j) {
                const double u = i / 4.5 - 1, v = j / 4.5 - 1;
                return glm::dvec3(u, v, -1.6 - 0.4 * (u * u - v * v));
            };
            builder.polygon({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
        }
    }
    builder.polygon({{-1, -0.9, -1.2}, {1, -0.7, -2.1}, {0.1, 0.9, -1.7}});
    builder.polygon({{-0.9, 0.8, -1.4}, {0.9, 0.7, -1.5}, {0, -0.8, -2}});
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> colors;
    for (const glm::dvec3& p : builder.scene.positions) {
        normals.emplace_back(0.8 * p.x, -0.8 * p.y, 1.0);
        colors.emplace_back(0.5 + 0.4 * p.x, 0.5 + 0.3 * p.y, 0.6, 1.0);
    }
    builder.vertex_normals(normals);
    builder.vertex_colors(colors);
    return std::move(builder.scene);
}

struct Files {
    std::vector<PictureFile> list;

    void add(PictureContent content, const std::string& path, ImageFormat format) {
        list.push_back({content, path, format, true, true});
    }
};

/// Every content in every format, in a folder.
Files all_files(const TemporaryFolder& folder, const std::string& prefix) {
    constexpr std::array kContents = {PictureContent::color, PictureContent::depth,
                                      PictureContent::ids, PictureContent::normals,
                                      PictureContent::mask};
    constexpr std::array kNames = {"color", "depth", "ids", "normals", "mask"};
    Files files;
    for (std::size_t i = 0; i < kContents.size(); ++i) {
        const std::string name = prefix + kNames[i];
        files.add(kContents[i], folder.file(name + ".png"), ImageFormat::png);
        files.add(kContents[i], folder.file(name + ".npy"), ImageFormat::npy);
        if (kContents[i] == PictureContent::mask) continue;
        files.add(kContents[i], folder.file(name + ".exr"), ImageFormat::exr);
    }
    return files;
}

/// The same files from whole pictures in memory.
void write_whole(const View& samples, const View& centres, const Files& files) {
    const ScreenScene& screen = centres.screen;
    const Visibility& seen = centres.visibility;
    const ColorImage color = samples.shade(Shading::phong, {0.1f, 0.2f, 0.3f, 0.5f});
    const DepthImage depth = depth_map(screen, seen);
    const NormalImage normals = normal_map(screen, seen, true);
    const IdImage triangles = triangle_map(seen), objects = object_map(screen, seen);
    const MaskImage mask = mask_map(seen);
    const Camera& camera = screen.camera();
    const std::array<ExrLayers, 4> layers = {
        ExrLayers{&color, &depth, &normals, &objects, &triangles}, ExrLayers{.depth = &depth},
        ExrLayers{.objects = &objects, .triangles = &triangles}, ExrLayers{.normals = &normals}};
    for (const PictureFile& file : files.list) {
        const auto write = [&](const auto& npy, const Status& png) {
            if (file.format == ImageFormat::png) return png;
            if (file.format == ImageFormat::npy) return write_npy(file.path, npy);
            return write_exr(file.path, layers[static_cast<std::size_t>(file.content)]);
        };
        const bool png = file.format == ImageFormat::png;
        Status done = success();
        switch (file.content) {
            case PictureContent::color:
                done = write(color, png ? write_color_png(file.path, color) : success());
                break;
            case PictureContent::depth:
                done = write(depth, png ? write_depth_png(file.path, depth, camera.near_plane,
                                                          camera.far_plane)
                                        : success());
                break;
            case PictureContent::ids:
                done = write(triangles, png ? write_ids_png(file.path, triangles) : success());
                break;
            case PictureContent::normals:
                done = write(normals, png ? write_normals_png(file.path, normals) : success());
                break;
            case PictureContent::mask:
                done = write(mask, png ? write_mask_png(file.path, mask) : success());
                break;
            case PictureContent::matte:
                FAIL() << "no map of its own";
        }
        ASSERT_TRUE(done.ok()) << done.error().message;
    }
}

DrawOptions options_of(std::uint32_t per_axis, int threads) {
    DrawOptions options;
    options.samples_per_axis = per_axis;
    options.shading = {Shading::phong, {0.1f, 0.2f, 0.3f, 0.5f}, threads};
    return options;
}

constexpr std::array kAlgorithms = {"zbuffer", "scanline-zbuffer", "scanline", "spans"};

void expect_same_bytes(Resolution resolution, std::uint32_t per_axis) {
    Scene scene = bowl();
    const View samples = view_of(scene, forward_camera(), resolution, per_axis);
    const View centres = view_of(scene, forward_camera(), resolution);
    const TemporaryFolder folder;
    const Files expected = all_files(folder, "expected-"), drawn = all_files(folder, "drawn-");
    write_whole(samples, centres, expected);
    std::vector<std::string> bytes;
    for (const PictureFile& file : expected.list) bytes.push_back(read_file(file.path));
    for (const char* name : kAlgorithms) {
        // Groups of as few rows as the bands allow, and as they are by default.
        for (const std::uint32_t group : {1u, 0u}) {
            SCOPED_TRACE(name + std::string(" in groups of ") + std::to_string(group));
            const Status done =
                draw_in_groups(centres.screen, *find_algorithm(name),
                               options_of(per_axis, group == 1 ? 3 : 1), drawn.list, group);
            ASSERT_TRUE(done.ok()) << done.error().message;
            for (std::size_t i = 0; i < drawn.list.size(); ++i) {
                EXPECT_TRUE(read_file(drawn.list[i].path) == bytes[i]) << drawn.list[i].path;
            }
        }
    }
}

// 1,500 pixels make PNG bands of 43, 87 and 58 rows; the algorithms' bands have 32 rows of samples.
TEST(Draw, SameBytesWhereBandsOfPngAndAlgorithmDiffer) { expect_same_bytes({1500, 90}, 1); }
TEST(Draw, SameBytesWithSamples) {
    expect_same_bytes({1100, 68}, 2);
    expect_same_bytes({37, 41}, 8);
}
TEST(Draw, SameBytesOfThinPictures) {
    expect_same_bytes({333, 1}, 1);
    expect_same_bytes({333, 1}, 2);
    expect_same_bytes({1, 75}, 1);
}

TEST(Draw, EachOutputAlone) {
    Scene scene = bowl();
    const View view = view_of(scene, forward_camera(), {50, 70}, 2);
    const View centres = view_of(scene, forward_camera(), {50, 70});
    const TemporaryFolder folder;
    const Files expected = all_files(folder, "expected-"), drawn = all_files(folder, "drawn-");
    write_whole(view, centres, expected);
    for (std::size_t i = 0; i < drawn.list.size(); ++i) {
        const Status done = draw_in_groups(view.screen, *find_algorithm("spans"), options_of(2, 2),
                                           {&drawn.list[i], 1}, 1);
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_TRUE(read_file(drawn.list[i].path) == read_file(expected.list[i].path))
            << drawn.list[i].path;
    }
}

TEST(Draw, TellsItsStagesAndCounts) {
    Scene scene = bowl();
    const View view = view_of(scene, forward_camera(), {50, 100});
    const TemporaryFolder folder;
    std::vector<Counter> counters;
    std::vector<std::uint32_t> resolved;
    bool shaded = false, written = false;
    DrawOptions options = options_of(1, 1);
    options.counters = &counters;
    options.on_stage = [&](DrawStage stage, std::uint32_t rows) {
        if (stage == DrawStage::resolve) resolved.push_back(rows);
        shaded = shaded || stage == DrawStage::shade;
        written = written || stage == DrawStage::write;
    };
    const PictureFile file{PictureContent::color, folder.file("a.npy"), ImageFormat::npy};
    ASSERT_TRUE(
        draw_in_groups(view.screen, *find_algorithm("scanline"), options, {&file, 1}, 1).ok());
    resolved.erase(std::unique(resolved.begin(), resolved.end()), resolved.end());
    EXPECT_EQ(resolved, (std::vector<std::uint32_t>{0, 32, 64, 96}));
    EXPECT_TRUE(shaded && written);
    EXPECT_FALSE(counters.empty());
}

TEST(Draw, FailuresAreValuesAndLeaveNothing) {
    Scene scene = bowl();
    const View view = view_of(scene, forward_camera(), {50, 100});
    const TemporaryFolder folder;
    const auto drawn = [&](std::vector<PictureFile> files, std::uint32_t per_axis) {
        return draw_in_groups(view.screen, *find_algorithm("spans"), options_of(per_axis, 1), files,
                              1);
    };
    const PictureFile good{PictureContent::ids, folder.file("i.png"), ImageFormat::png};
    const Status mask =
        drawn({good, {PictureContent::mask, folder.file("m.exr"), ImageFormat::exr}}, 1);
    ASSERT_FALSE(mask.ok());
    EXPECT_EQ(mask.error().kind, ErrorKind::bad_option);
    const Status missing =
        drawn({good, {PictureContent::color, folder.file("no/a.exr"), ImageFormat::exr}}, 1);
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().kind, ErrorKind::io);
    EXPECT_FALSE(drawn({{PictureContent::color, folder.file("a.png"), ImageFormat::png}}, 3).ok());
    EXPECT_FALSE(drawn({{PictureContent::color, "/dev/full", ImageFormat::npy}, good}, 1).ok());
    EXPECT_EQ(folder.count(), 0);
}

/// Rows first .. end-1 (of pixels) of a picture.
Visibility cut(const Visibility& whole, std::uint32_t first, std::uint32_t end) {
    Visibility band;
    band.grid = whole.grid;
    band.first_row = first * whole.grid.per_axis;
    const std::size_t row = std::size_t{whole.grid.columns()} * whole.grid.per_axis;
    band.ids.assign(whole.ids.data() + first * row, whole.ids.data() + end * row);
    band.depth.assign(whole.depth.data() + first * row, whole.depth.data() + end * row);
    return band;
}

template <class T>
void expect_rows(const Image<T>& whole, const Image<T>& band, std::uint32_t first) {
    ASSERT_EQ(band.width, whole.width);
    for (std::uint32_t y = 0; y < band.height; ++y) {
        EXPECT_TRUE(std::ranges::equal(band.row(y), whole.row(first + y))) << y;
    }
}

TEST(Bands, GiveTheRowsOfTheWholePicture) {
    Scene scene = bowl();
    constexpr std::uint32_t kFirst = 11, kEnd = 27;
    for (const std::uint32_t per_axis : {1u, 2u}) {
        View view = view_of(scene, forward_camera(), {45, 40}, per_axis);
        const Visibility whole = view.visibility, band = cut(whole, kFirst, kEnd);
        const ShadeOptions options{Shading::phong, {}, 1};
        const ColorImage colors = shade(view.screen, band, options);
        EXPECT_EQ(colors.height, kEnd - kFirst);
        expect_rows(shade(view.screen, whole, options), colors, kFirst);
        if (per_axis > 1) continue;
        expect_rows(depth_map(view.screen, whole), depth_map(view.screen, band), kFirst);
        expect_rows(normal_map(view.screen, whole, true), normal_map(view.screen, band, true),
                    kFirst);
        expect_rows(triangle_map(whole), triangle_map(band), kFirst);
        expect_rows(object_map(view.screen, whole), object_map(view.screen, band), kFirst);
        expect_rows(mask_map(whole), mask_map(band), kFirst);
        EXPECT_EQ(mask_map(band).height, kEnd - kFirst);
    }
}

}  // namespace
}  // namespace sightline::test
