// A picture made part by part is the picture of the whole.
#include "sightline/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/files.hpp"
#include "support/scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

// The objects first .. end-1 of a scene, on their own.
Scene part_of(const Scene& scene, std::size_t first, std::size_t end) {
    Scene part = scene;
    part.objects.assign(scene.objects.begin() + static_cast<std::ptrdiff_t>(first),
                        scene.objects.begin() + static_cast<std::ptrdiff_t>(end));
    const std::uint32_t begin = part.objects.front().first_triangle;
    const std::uint32_t polygons = part.objects.front().first_polygon;
    std::uint32_t count = 0;
    for (Object& object : part.objects) {
        object.first_triangle -= begin;
        object.first_polygon -= polygons;
        count += object.triangle_count;
    }
    const auto cut = [&](auto& values) {
        if (values.empty()) return;
        values.erase(values.begin() + begin + count, values.end());
        values.erase(values.begin(), values.begin() + begin);
    };
    cut(part.triangles);
    cut(part.triangle_polygon);
    cut(part.polygon_edges);
    for (std::uint32_t& polygon : part.triangle_polygon) polygon -= polygons;
    finish_scene(part);
    return part;
}

// Every triangle an object; none coplanar with another one.
Scene loose_triangles() {
    SceneBuilder b;
    Random random(23);
    for (int k = 0; k < 90; ++k) {
        const glm::dvec3 p = random.point(), q = random.point();
        b.triangle(p, q, random.point());
    }
    Scene scene = b.scene;
    const Object whole = scene.objects[0];
    scene.objects.clear();
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        Object object = whole;
        object.first_triangle = object.first_polygon = t;
        object.triangle_count = object.polygon_count = 1;
        scene.objects.push_back(object);
    }
    finish_scene(scene);
    return scene;
}

TEST(Stream, GivesTheBytesOfTheWhole) {
    const Scene scene = loose_triangles();
    const TemporaryFolder folder;
    for (const std::uint32_t n : {1u, 4u}) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const Camera camera = hostile_camera(scene, seed, {70, 50});
            DrawOptions options;
            options.samples_per_axis = n;
            options.shading = {Shading::flat, {0.5f, 0.5f, 0.5f, 1}, 0};
            const auto files_in = [&](const std::string& prefix) {
                const auto name = [&](const char* end) { return folder.file(prefix + end); };
                return std::vector<PictureFile>{
                    {PictureContent::color, name("c.png"), ImageFormat::png},
                    {PictureContent::color, name("c.exr"), ImageFormat::exr, true, true},
                    {PictureContent::depth, name("d.npy"), ImageFormat::npy},
                    {PictureContent::ids, name("i.npy"), ImageFormat::npy},
                    {PictureContent::normals, name("n.png"), ImageFormat::png},
                    {PictureContent::mask, name("m.png"), ImageFormat::png}};
            };
            const std::vector<PictureFile> whole = files_in("whole-"), parts = files_in("parts-");
            const ScreenScene screen = must(project(scene, camera, {Cull::none, 0}));
            ASSERT_TRUE(draw(screen, default_algorithm(), options, whole).ok());

            StreamedPicture picture(camera, options, parts);
            for (std::size_t k = 0; k < 90; k += 30) {
                const Scene part = part_of(scene, k, k + 30);
                const ScreenScene projected = must(project(part, camera, {Cull::none, 0}));
                ASSERT_TRUE(picture.add(projected).ok());
            }
            ASSERT_TRUE(picture.write().ok());
            for (std::size_t k = 0; k < whole.size(); ++k)
                ASSERT_TRUE(read_file(whole[k].path) == read_file(parts[k].path))
                    << whole[k].path << " " << seed;
        }
    }
}

TEST(Stream, RefusesWhatItCanNotKeep) {
    const Scene scene = loose_triangles();
    const Camera camera = hostile_camera(scene, 1, {20, 20});
    PictureFile deep{PictureContent::color, "unused.exr", ImageFormat::exr};
    deep.deep = true;
    const PictureFile matte{PictureContent::matte, "unused.png", ImageFormat::png};
    for (const PictureFile& file : {deep, matte}) {
        const StreamedPicture picture(camera, {}, std::span(&file, 1));
        const Status done = picture.write();
        ASSERT_FALSE(done.ok());
        EXPECT_EQ(done.error().kind, ErrorKind::bad_option);
    }
}

}  // namespace
}  // namespace sightline
