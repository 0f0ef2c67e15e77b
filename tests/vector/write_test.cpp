// Files of drawings in every format: their heads and sizes, the same bytes twice, and failures.
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "support/files.hpp"
#include "vector/drawings.hpp"

namespace {

using namespace sightline;
using sightline::testing::pixel_options;
using sightline::testing::read_file;
using sightline::testing::small_drawing;
using sightline::testing::TemporaryFolder;

constexpr VectorFormat kAll[] = {VectorFormat::svg, VectorFormat::pdf, VectorFormat::eps,
                                 VectorFormat::dxf, VectorFormat::png};

VectorOptions paper_options() {
    VectorOptions options;
    options.layout = {254, 127, true, 1, {27, 13.5}};  // 10 x 5 inches
    options.stroke = 0.25;
    options.title = "A (small) drawing";
    return options;
}

std::string written(VectorFormat format, const Drawing& drawing, const VectorOptions& options) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a");
    const Status status = write_drawing(path, format, drawing, options);
    EXPECT_TRUE(status.ok());
    EXPECT_EQ(folder.count(), 1);
    return read_file(path);
}

TEST(WriteDrawing, TheSameBytesTwice) {
    for (const VectorFormat format : kAll) {
        const std::string first = written(format, small_drawing(), paper_options());
        EXPECT_FALSE(first.empty());
        EXPECT_EQ(first, written(format, small_drawing(), paper_options())) << name_of(format);
    }
}

TEST(WriteDrawing, AnEmptyDrawingIsAFileToo) {
    for (const VectorFormat format : kAll) {
        EXPECT_FALSE(written(format, Drawing(), pixel_options(Drawing())).empty())
            << name_of(format);
    }
}

TEST(WriteDrawing, FailuresLeaveNoFile) {
    const TemporaryFolder folder;
    for (const VectorFormat format : kAll) {
        const Status missing = write_drawing(folder.file("no/a"), format, small_drawing(),
                                             pixel_options(small_drawing()));
        ASSERT_FALSE(missing.ok()) << name_of(format);
        EXPECT_EQ(missing.error().kind, ErrorKind::io);
        EXPECT_NE(missing.error().message.find("create the folder"), std::string::npos);
        const Status full = write_drawing("/dev/full", format, small_drawing(), paper_options());
        ASSERT_FALSE(full.ok()) << name_of(format);
        EXPECT_NE(full.error().message.find("No space left"), std::string::npos)
            << full.error().message;
    }
    EXPECT_EQ(folder.count(), 0);
}

TEST(Pdf, HasThePageAndNoClock) {
    const std::string pixels =
        written(VectorFormat::pdf, small_drawing(), pixel_options(small_drawing()));
    EXPECT_EQ(pixels.substr(0, 5), "%PDF-");
    EXPECT_NE(pixels.find("MediaBox [ 0 0 150 75 ]"), std::string::npos);
    const std::string paper = written(VectorFormat::pdf, small_drawing(), paper_options());
    EXPECT_NE(paper.find("MediaBox [ 0 0 720 360 ]"), std::string::npos);
    EXPECT_TRUE(std::regex_search(paper, std::regex(R"(/CreationDate \((D:)?19700101)")));
    EXPECT_NE(paper.find("/Title "), std::string::npos);
}

TEST(Eps, HasThePageAndNoClock) {
    const std::string eps = written(VectorFormat::eps, small_drawing(), paper_options());
    EXPECT_EQ(eps.substr(0, 14), "%!PS-Adobe-3.0");
    EXPECT_NE(eps.substr(0, eps.find('\n')).find("EPSF-3.0"), std::string::npos);
    EXPECT_NE(eps.find("\n%%BoundingBox: 0 0 720 360\n"), std::string::npos);
    EXPECT_NE(eps.find("\n%%Title: A (small) drawing\n"), std::string::npos);
    EXPECT_EQ(eps.find("CreationDate"), std::string::npos);
    EXPECT_NE(eps.find("%%EOF"), std::string::npos);
}

/// Width and height of a PNG, from its first chunk.
std::pair<unsigned, unsigned> png_size(const std::string& png) {
    const auto number = [&](std::size_t at) {
        unsigned n = 0;
        for (std::size_t i = at; i < at + 4; ++i) {
            n = n << 8 | static_cast<unsigned char>(png.at(i));
        }
        return n;
    };
    return {number(16), number(20)};
}

TEST(DrawnPng, HasThePixelsOfThePage) {
    const std::string pixels =
        written(VectorFormat::png, small_drawing(), pixel_options(small_drawing()));
    EXPECT_EQ(pixels.substr(1, 3), "PNG");
    EXPECT_EQ(png_size(pixels), std::pair(200u, 100u));
    EXPECT_EQ(png_size(written(VectorFormat::png, small_drawing(), paper_options())),
              std::pair(3'000u, 1'500u));
}

TEST(DrawnPng, RefusesMorePixelsThanThereCanBe) {
    const TemporaryFolder folder;
    VectorOptions options = pixel_options(small_drawing());
    for (const glm::dvec2 size : {glm::dvec2(32'768, 10), glm::dvec2(20'000, 20'000)}) {
        options.layout.width = size.x;
        options.layout.height = size.y;
        const Status status =
            write_drawing(folder.file("a.png"), VectorFormat::png, small_drawing(), options);
        ASSERT_FALSE(status.ok());
        EXPECT_EQ(status.error().kind, ErrorKind::bad_option);
    }
    EXPECT_EQ(folder.count(), 0);
}

/// Values that follow a code and a value: of group `code` after "before_code\nbefore".
std::vector<std::string> dxf_names(const std::string& dxf, const std::string& entity) {
    std::vector<std::string> out;
    const std::regex layer("\n0\n" + entity + "\n(?:(?!0\n)[0-9]+\n.*\n)*?8\n(.*)\n");
    for (auto i = std::sregex_iterator(dxf.begin(), dxf.end(), layer); i != std::sregex_iterator();
         ++i) {
        out.push_back((*i)[1]);
    }
    return out;
}

TEST(Dxf, EntitiesLieOnLayersOfTheirKind) {
    const std::string dxf = written(VectorFormat::dxf, small_drawing(), paper_options());
    EXPECT_EQ(dxf_names(dxf, "LWPOLYLINE"),
              (std::vector<std::string>{"FILL", "FILL", "FILL", "HIDDEN_CREASE",
                                        "VISIBLE_SILHOUETTE", "VISIBLE_CREASE"}));
    EXPECT_EQ(dxf_names(dxf, "LINE"),
              (std::vector<std::string>{"CONSTRUCTION_X", "CONSTRUCTION_Y"}));
    const std::regex hidden("\n2\nHIDDEN_CREASE\n70\n0\n62\n8\n6\nDASHED\n370\n15\n");
    EXPECT_TRUE(std::regex_search(dxf, hidden));
    EXPECT_NE(dxf.find("\n9\n$INSUNITS\n70\n4\n"), std::string::npos);
    EXPECT_EQ(dxf.substr(dxf.size() - 6), "0\nEOF\n");
}

TEST(Dxf, PointsUpFromTheLowerEdge) {
    // The crease from (90, 10) on a page 100 high.
    const std::string dxf =
        written(VectorFormat::dxf, small_drawing(), pixel_options(small_drawing()));
    EXPECT_NE(dxf.find("\n90\n3\n70\n0\n10\n90\n20\n90\n10\n190.0625\n20\n49.5\n10\n90\n20\n10\n"),
              std::string::npos);
    EXPECT_NE(dxf.find("\n9\n$INSUNITS\n70\n0\n"), std::string::npos);
}

}  // namespace
