// Drawings on paper: sizes, scales and what can't be.
#include <gtest/gtest.h>

#include <limits>

#include "sightline/vector.hpp"

namespace {

using namespace sightline;

Camera parallel_camera() {
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.resolution = {400, 200};
    camera.view_height = 1'000;  // units: 5 a pixel
    return camera;
}

void expect_refused(const PageOptions& options, const Camera& camera, const char* word) {
    const Result<PageLayout> layout = lay_out(options, camera);
    ASSERT_FALSE(layout.ok()) << word;
    EXPECT_EQ(layout.error().kind, ErrorKind::bad_option);
    EXPECT_NE(layout.error().message.find(word), std::string::npos) << layout.error().message;
}

TEST(Layout, WithoutASizeAUnitIsAPixel) {
    const Result<PageLayout> layout = lay_out({}, parallel_camera());
    ASSERT_TRUE(layout.ok());
    EXPECT_EQ(layout->width, 400);
    EXPECT_EQ(layout->height, 200);
    EXPECT_FALSE(layout->millimetres);
    EXPECT_EQ(layout->scale, 1);
    EXPECT_EQ(layout->offset, glm::dvec2(0, 0));
}

TEST(Layout, FillsWhatMarginsLeaveAndIsCentred) {
    Camera perspective;
    perspective.resolution = {400, 200};
    const Result<PageLayout> layout = lay_out({glm::dvec2(210, 297), 5, {}}, perspective);
    ASSERT_TRUE(layout.ok());
    EXPECT_TRUE(layout->millimetres);
    EXPECT_EQ(layout->width, 210);
    EXPECT_EQ(layout->height, 297);
    EXPECT_DOUBLE_EQ(layout->scale, 0.5);
    EXPECT_DOUBLE_EQ(layout->offset.x, 5);
    EXPECT_DOUBLE_EQ(layout->offset.y, 98.5);
}

TEST(Layout, AScaleIsLengthOnPaperOverLengthInTheScene) {
    // 2000 x 1000 units at 1:50 are 40 x 20 mm.
    const Result<PageLayout> alone = lay_out({{}, 10, 0.02}, parallel_camera());
    ASSERT_TRUE(alone.ok());
    EXPECT_TRUE(alone->millimetres);
    EXPECT_DOUBLE_EQ(alone->width, 40);
    EXPECT_DOUBLE_EQ(alone->height, 20);
    EXPECT_DOUBLE_EQ(alone->scale, 0.1);
    EXPECT_EQ(alone->offset, glm::dvec2(0, 0));

    const Result<PageLayout> sized = lay_out({glm::dvec2(100, 60), 10, 0.02}, parallel_camera());
    ASSERT_TRUE(sized.ok());
    EXPECT_DOUBLE_EQ(sized->scale, 0.1);
    EXPECT_DOUBLE_EQ(sized->offset.x, 30);
    EXPECT_DOUBLE_EQ(sized->offset.y, 20);
}

TEST(Layout, ADrawingThatFitsExactlyIsNotRefused) {
    EXPECT_TRUE(lay_out({glm::dvec2(60, 40), 10, 0.02}, parallel_camera()).ok());
    EXPECT_TRUE(lay_out({glm::dvec2(40, 20), 0, 0.02}, parallel_camera()).ok());
}

TEST(Layout, RefusesWhatCannotBe) {
    const Camera camera = parallel_camera();
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    expect_refused({{}, 10, 0.02}, Camera(), "perspective");
    expect_refused({glm::dvec2(210, 297), 105, {}}, camera, "leaves nothing");
    expect_refused({glm::dvec2(59, 40), 10, 0.02}, camera, "40.0 x 20.0 mm");
    expect_refused({{}, 10, 0.0}, camera, "scale");
    expect_refused({{}, 10, kNan}, camera, "scale");
    expect_refused({glm::dvec2(0, 10), 0, {}}, camera, "width and height");
    expect_refused({glm::dvec2(10, kNan), 0, {}}, camera, "width and height");
    expect_refused({glm::dvec2(10, 10), -1, {}}, camera, "--margin");
}

TEST(VectorFormats, ByNameAndByPath) {
    for (const VectorFormat format : {VectorFormat::svg, VectorFormat::pdf, VectorFormat::eps,
                                      VectorFormat::dxf, VectorFormat::png}) {
        EXPECT_EQ(parse_vector_format(name_of(format)), format);
    }
    EXPECT_EQ(vector_format_of("a/b.c/D.SVG"), VectorFormat::svg);
    EXPECT_EQ(vector_format_of("a.svg/b"), std::nullopt);
    EXPECT_EQ(vector_format_of("svg"), std::nullopt);
    EXPECT_EQ(parse_vector_format("SVG"), std::nullopt);
}

}  // namespace
