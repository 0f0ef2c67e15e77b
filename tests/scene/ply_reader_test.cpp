// The reader of PLY files.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "scene/meshes.hpp"
#include "sightline/image.hpp"
#include "support/models.hpp"

namespace sightline {
namespace {

using scene_test::load_text;
using scene_test::loaded;
using scene_test::message_of;

/// Values of a file in one of its three forms.
class Body {
public:
    explicit Body(std::string format) : format_(std::move(format)) {}

    template <class T>
    Body& put(std::initializer_list<double> values) {
        for (const double value : values) {
            const auto stored = static_cast<T>(value);
            if (format_ == "ascii") {
                bytes_ += std::to_string(stored) + " ";
                continue;
            }
            std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(stored);
            if (format_ == "binary_big_endian") std::ranges::reverse(raw);
            bytes_.append(raw.data(), raw.size());
        }
        return *this;
    }
    [[nodiscard]] std::string file(const std::string& elements, const char* line_end = "\n") const {
        std::string header = "ply\nformat " + format_ + " 1.0\n" + elements + "end_header\n";
        std::string file;
        for (const char c : header) file += c == '\n' ? std::string(line_end) : std::string(1, c);
        return file + bytes_;
    }

private:
    std::string format_, bytes_;
};

const char* const kForms[] = {"ascii", "binary_little_endian", "binary_big_endian"};
const std::string kVertices =
    "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 2\nproperty list uchar int vertex_indices\n";

Body five_vertices(const std::string& form) {
    Body body(form);
    return body.put<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1});
}

Result<Scene> load_ply(const std::string& text) { return load_text(text, "ply"); }

TEST(PlyReader, ThreeFormsAndLineEnds) {
    for (const std::string form : kForms) {
        for (const char* line_end : {"\n", "\r\n", "\r"}) {
            Body body = five_vertices(form);
            body.put<std::uint8_t>({4}).put<int>({0, 1, 2, 3});
            body.put<std::uint8_t>({3}).put<int>({0, 1, 4});
            const Scene scene = loaded(load_ply(body.file(kVertices + kFaces, line_end)));
            ASSERT_EQ(scene.triangle_count(), 3u) << form;
            EXPECT_EQ(scene.triangle_polygon, (std::vector<std::uint32_t>{0, 0, 1}));
            EXPECT_EQ(scene.positions[scene.triangles[2].z], glm::dvec3(0, 0, 1));
        }
    }
}

TEST(PlyReader, AnyOrderTypesAndUnknownParts) {
    for (const std::string form : kForms) {
        Body body(form);
        body.put<std::uint8_t>({7}).put<std::uint16_t>({3}).put<double>({0, 1, 2}).put<float>({9});
        body.put<std::int8_t>({2}).put<std::int16_t>({-5, 6});  // a thing
        for (const double x : {0, 1, 2}) {
            body.put<std::uint8_t>({1}).put<std::uint32_t>({4}).put<double>({x, x * x});
            body.put<std::int16_t>({3});
        }
        const Scene scene = loaded(load_ply(body.file(
            "comment element vertex 9\nobj_info x\nsomething else\n"
            "element face 1\nproperty uint8 flags\nproperty list ushort double vertex_index\n"
            "property float32 quality\nelement thing 1\nproperty list char short a\n"
            "element nothing 1000000000\nelement vertex 3\nproperty list uchar uint32 neighbours\n"
            "property float64 x\nproperty double z\nproperty int16 y\n")));
        ASSERT_EQ(scene.triangle_count(), 1u) << form;
        EXPECT_EQ(scene.positions[scene.triangles[0].z], glm::dvec3(2, 3, 4));
    }
}

TEST(PlyReader, NormalsAndColours) {
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    for (const std::string form : kForms) {
        Body bytes(form), floats(form);
        for (const double x : {0, 1, 2}) {
            bytes.put<float>({x, x * x, 0, 0, 0, 2}).put<std::uint8_t>({255, 128, 0, 255});
            floats.put<float>({x, x * x, 0, 0, 0, 2}).put<float>({1, 128.0 / 255, 0, 1});
        }
        for (Body* body : {&bytes, &floats}) {
            const std::string type = body == &bytes ? "uchar " : "float ";
            body->put<std::uint8_t>({3}).put<int>({0, 1, 2});
            const Scene scene = loaded(load_ply(body->file(
                "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
                normals + "property " + type + "red\nproperty " + type + "green\nproperty " + type +
                "blue\nproperty " + type + "alpha\n" +
                "element face 1\nproperty list uchar int vertex_indices\n")));
            ASSERT_EQ(scene.triangle_colors.size(), 1u);
            EXPECT_EQ(scene.colors[scene.triangle_colors[0].y],
                      glm::vec4(1, from_srgb8(128), 0, 1));
            EXPECT_EQ(scene.normals[scene.triangle_normals[0].y], glm::vec3(0, 0, 1));
            EXPECT_EQ(scene.materials[scene.objects[0].material].base_color, glm::vec3(1));
        }
    }
}

TEST(PlyReader, StripsTurnEverySecondTriangle) {
    for (const std::string form : kForms) {
        Body body = five_vertices(form);
        body.put<int>({9}).put<int>({0, 1, 3, 2, -1, 0, 1, -1, -1});
        body.put<int>({3}).put<int>({0, 1, 4});
        const Scene scene = loaded(load_ply(
            body.file(kVertices + "element tristrips 2\nproperty list int int vertex_indices\n")));
        ASSERT_EQ(scene.triangle_count(), 3u) << form;
        EXPECT_EQ(scene.counts.polygons, 3u);
        const auto corners = [&](std::uint32_t t) {
            std::vector<glm::dvec3> points;
            for (int k = 0; k < 3; ++k) points.push_back(scene.positions[scene.triangles[t][k]]);
            return points;
        };
        EXPECT_EQ(corners(0), (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
        EXPECT_EQ(corners(1), (std::vector<glm::dvec3>{{0, 1, 0}, {1, 0, 0}, {1, 1, 0}}));
        EXPECT_EQ(corners(2), (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}));
    }
}

TEST(PlyReader, SmallFacesAreCounted) {
    Body body = five_vertices("ascii");
    body.put<std::uint8_t>({2}).put<int>({0, 1}).put<std::uint8_t>({3}).put<int>({0, 1, 4});
    const Scene scene = loaded(load_ply(body.file(kVertices + kFaces)));
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.counts.ignored_primitives, 1u);
}

TEST(PlyReader, EveryTruncationIsAnErrorAtOnce) {
    for (const std::string form : kForms) {
        Body body = five_vertices(form);
        body.put<std::uint8_t>({4}).put<int>({0, 1, 2, 3});
        body.put<std::uint8_t>({3}).put<int>({0, 1, 4});
        std::string file = body.file(kVertices + kFaces);
        if (form == "ascii") file.pop_back();  // the last blank is not needed
        for (std::size_t size = 1; size < file.size(); ++size) {
            (void)message_of(load_ply(file.substr(0, size)));
        }
    }
    EXPECT_EQ(message_of(load_ply("ply\nformat ascii 1.0\nelement ver")),
              "input.ply: not a readable ply file (it ends within its header); check or export it "
              "again");
    EXPECT_EQ(
        message_of(load_ply(five_vertices("ascii").file(kVertices + kFaces) + "3 0 1 2 3 0\n")),
        "input.ply: not a readable ply file (it ends within element 'face', after 1 of 2); "
        "check or export it again");
}

TEST(PlyReader, AbsurdCountsAllocateNothing) {
    for (const std::string form : kForms) {
        for (const char* count : {"4294967294", "4294967296", "18446744073709551615"}) {
            const std::string vertices = "element vertex " + std::string(count) +
                                         "\nproperty float x\nproperty float y\nproperty float z\n";
            EXPECT_NE(message_of(load_ply(Body(form).file(vertices))).find("too short"),
                      std::string::npos);
            const std::string faces =
                "element face " + std::string(count) + "\nproperty list uchar int vertex_indices\n";
            EXPECT_NE(
                message_of(load_ply(five_vertices(form).file(kVertices + faces))).find("too short"),
                std::string::npos);
        }
        Body list = five_vertices(form);
        list.put<int>({2147483647}).put<int>({0, 1, 2});
        (void)message_of(load_ply(
            list.file(kVertices + "element face 1\nproperty list int int vertex_indices\n")));
        Body negative = five_vertices(form);
        negative.put<int>({-3}).put<int>({0, 1, 2});
        (void)message_of(load_ply(
            negative.file(kVertices + "element face 1\nproperty list int int vertex_indices\n")));
    }
}

TEST(PlyReader, WrongHeaders) {
    const std::string start = "ply\nformat ascii 1.0\n";
    const std::string way_out =
        "' is no line of a PLY header; repair the line or export the file "
        "again";
    Body negative = five_vertices("ascii");
    negative.put<int>({-3}).put<int>({0, 1, 2});
    EXPECT_EQ(message_of(load_ply(negative.file(
                  kVertices + "element face 1\nproperty list int int vertex_indices\n"))),
              "input.ply: not a readable ply file (a list of negative length in face 0); check or "
              "export it again");
    EXPECT_EQ(message_of(load_ply("plyx\n")),
              "input.ply: not a PLY file: it does not begin with \"ply\"; check the format");
    EXPECT_EQ(message_of(load_ply("ply\nformat utf8 1.0\nend_header\n")),
              "input.ply:2: 'format utf8 1.0" + way_out);
    EXPECT_EQ(message_of(load_ply(start + "element vertex -3\nend_header\n")),
              "input.ply:3: 'element vertex -3" + way_out);
    EXPECT_EQ(message_of(load_ply(start + "element vertex 3\nproperty real x\nend_header\n")),
              "input.ply:4: 'property real x" + way_out);
    EXPECT_EQ(message_of(load_ply(start + "property int x\nend_header\n")),
              "input.ply:3: 'property int x" + way_out);
    EXPECT_EQ(message_of(load_ply(start + "element vertex 1\nproperty float x\nend_header\n1\n")),
              "input.ply: not a readable ply file (its element 'vertex' has no x, y and z); check "
              "or export it again");
}

TEST(PlyReader, WrongIndicesNameTheLineOrTheFace) {
    Body text = five_vertices("ascii");
    text.put<std::uint8_t>({3}).put<int>({0, 1, 5});
    text.put<std::uint8_t>({3}).put<int>({0, 1, 2});
    EXPECT_EQ(
        message_of(load_ply(text.file(kVertices + kFaces))),
        "input.ply:10: face refers to vertex 5, but there are 5; repair the line or export the "
        "file again");
    Body binary = five_vertices("binary_big_endian");
    binary.put<std::uint8_t>({3}).put<int>({0, 1, 2});
    binary.put<std::uint8_t>({3}).put<int>({0, -1, 2});
    EXPECT_EQ(
        message_of(load_ply(binary.file(kVertices + kFaces))),
        "input.ply: not a readable ply file (face 1 refers to a vertex out of range, but there "
        "are 5); check or export it again");
    Body word = five_vertices("ascii");
    EXPECT_EQ(message_of(load_ply(word.file(kVertices + kFaces) + "\n3 0 one 2\n3 0 1 2\n")),
              "input.ply:11: 'one' is not a number that can stand here; repair the line or export "
              "the file again");
}

TEST(PlyReader, PointCloudsAreCounted) {
    EXPECT_EQ(
        message_of(load_ply(five_vertices("ascii").file(kVertices))),
        "input.ply: no triangles in it (5 points and lines, which are not drawn); use a model "
        "with faces");
}

TEST(PlyReader, ARealFileOfStrips) {
    const std::optional<Scene> igea = testing::real_model("igea.ply");
    if (!igea) GTEST_SKIP() << "needs the models";
    EXPECT_EQ(igea->triangle_count(), 268686u);
    EXPECT_EQ(igea->positions.size(), 134345u);
    EXPECT_TRUE(igea->objects[0].closed) << "the strips' triangles face alike";
}

const std::string kTriangleHeader =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 1\nproperty list uchar int vertex_indices\n";

std::string ascii_triangle(const std::string& body) {
    return "ply\nformat ascii 1.0\n" + kTriangleHeader + "end_header\n" + body;
}

TEST(PlyReader, LinesThatContradictTheHeader) {
    const std::string right = "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n3 0 1 2\n";
    EXPECT_EQ(loaded(load_ply(ascii_triangle(right))).triangle_count(), 1u);
    // Values without regard to lines are read.
    std::string one_line = right;
    std::ranges::replace(one_line, '\n', ' ');
    EXPECT_EQ(loaded(load_ply(ascii_triangle(one_line))).triangle_count(), 1u);
    const auto error = [](const std::string& body) {
        return message_of(load_ply(ascii_triangle(body)));
    };
    const std::string way_out =
        " is not the line of values that the header describes; repair the line or export the file "
        "again";
    EXPECT_EQ(error("0 0 0 1 2 3 4\n1 0 0 1 2 3 4\n1 1 0 1 2 3 4\n3 0 1 2\n"),
              "input.ply:13: vertex" + way_out);
    EXPECT_EQ(error("0 0 0\n1 0 0\n1 1 0\n1 1 1\n0 0 0\n0 0 0\n3 0 1 2\n"),
              "input.ply:13: vertex" + way_out);
    EXPECT_EQ(error("0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n3 0 1 2 9\n"),
              "input.ply:16: face" + way_out);
}

TEST(PlyReader, ByteOrderMarksAndOddLineEnds) {
    EXPECT_EQ(loaded(load_ply("\xef\xbb\xbf" +
                              ascii_triangle("0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n3 0 1 2\n")))
                  .triangle_count(),
              1u);
    for (const char* form : kForms) {
        std::string file = five_vertices(form).put<std::uint8_t>({3}).put<int>({0, 1, 2}).file(
            kVertices + "element face 1\nproperty list uchar int vertex_indices\n");
        file.replace(file.find("end_header\n"), 11, "end_header\r\n");
        EXPECT_EQ(loaded(load_ply(file)).triangle_count(), 1u) << form;
    }
}

TEST(PlyReader, ColoursOfFacesAreNoted) {
    const Scene scene =
        loaded(load_ply(five_vertices("ascii").file(
                            kVertices + "element face 1\nproperty list uchar int vertex_indices\n"
                                        "property uchar red\nproperty uchar green\nproperty uchar "
                                        "blue\n") +
                        "\n3 0 1 2 255 0 0\n"));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_EQ(scene.notes[0], "input.ply: colours of faces are not read");
}

}  // namespace
}  // namespace sightline
