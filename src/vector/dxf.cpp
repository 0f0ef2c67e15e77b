// DXF of AutoCAD 2000 (AC1015), through dxflib.
//
// dxflib writes to a file of its own and does not say when the disk is full. But all that it prints
// goes through five virtual functions, which are overridden here to print into our file.
//
// Layers: FILL, HIDDEN_KIND and VISIBLE_KIND (KIND as in SILHOUETTE) and CONSTRUCTION_X, _Y and _Z
// and LABELS, each only when something is on it. Paths and loops of regions are light-weight
// polylines; those of regions are closed and have their colour. y points up, from the lower edge of
// the page.
#include <dxflib/dl_dxf.h>
#include <dxflib/dl_writer_ascii.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "vector/text.hpp"
#include "vector/writers.hpp"

namespace sightline {
namespace {

/// dxflib's writer with another place to write to.
class DxfSink : public DL_WriterA {
public:
    explicit DxfSink(AtomicFile& file) : DL_WriterA("", DL_Codes::AC1015), out_(file) {}

    void dxfReal(int code, double value) const override {
        put_code(code);
        if (std::abs(value) < kLargest) {
            out_.put_decimal(grid_.round(value), grid_.decimals());
        } else {
            out_.put(fmt::format("{}", value));
        }
        out_.put('\n');
    }
    void dxfInt(int code, int value) const override {
        put_code(code);
        out_.put_decimal(value, 0);
        out_.put('\n');
    }
    void dxfHex(int code, int value) const override {
        put_code(code);
        out_.put(fmt::format("{:X}\n", static_cast<unsigned>(value)));
    }
    void dxfString(int code, const char* value) const override {
        put_code(code);
        out_.put(value);
        out_.put('\n');
    }
    void dxfString(int code, const std::string& value) const override {
        dxfString(code, value.c_str());
    }
    void variable(const char* name) const { dxfString(9, name); }
    void flush() { out_.flush(); }

private:
    static constexpr double kLargest = 1e8;  // what the grid can hold

    void put_code(int code) const {
        out_.put_decimal(code, 0);
        out_.put('\n');
    }

    DecimalGrid grid_{6};  // dxflib would print 16 decimals, most of them noise
    mutable TextSink out_;
};

// Colours of AutoCAD's index: 7 is black on white and white on black.
constexpr int kRed = 1, kGreen = 3, kBlue = 5, kForeground = 7, kDarkGrey = 8, kLightGrey = 9;
constexpr int kByLayer = 256, kWidthByLayer = -1, kDefaultWidth = -3;
constexpr const char* kSolid = "CONTINUOUS";
constexpr const char* kDashed = "DASHED";

/// The line weight nearest to a width: DXF has these, in 1/100 mm.
int line_weight(double millimetres) {
    constexpr std::array<int, 24> kWeights = {0,  5,   9,   13,  15,  18,  20,  25,
                                              30, 35,  40,  50,  53,  60,  70,  80,
                                              90, 100, 106, 120, 140, 158, 200, 211};
    const auto away = [millimetres](int weight) { return std::abs(weight - 100 * millimetres); };
    return *std::min_element(kWeights.begin(), kWeights.end(),
                             [&](int a, int b) { return away(a) < away(b); });
}

std::string layer_of(EdgeKind kind, bool visible) {
    std::string name(visible ? "VISIBLE_" : "HIDDEN_");
    for (const char c : name_of(kind)) name += static_cast<char>(c - 'a' + 'A');
    return name;
}

std::string layer_of_guide(std::size_t axis) { return std::string("CONSTRUCTION_") + "XYZ"[axis]; }

class DxfWriter {
public:
    DxfWriter(AtomicFile& file, const Drawing& drawing, const Paths& paths,
              const VectorOptions& options)
        : to_(file), drawing_(drawing), options_(options), layout_(options.layout), paths_(paths) {}

    void write() {
        put_header();
        put_tables();
        put_blocks();
        to_.sectionEntities();
        put_regions();
        put_paths();
        put_guides();
        put_labels();
        to_.sectionEnd();
        dxf_.writeObjects(to_);
        dxf_.writeObjectsEnd(to_);
        to_.dxfEOF();
        to_.flush();
    }

private:
    struct Layer {
        std::string name;
        int color;
        double width;  // 0: as thin as can be
        bool dashed;
    };

    void put_header();
    void put_tables();
    void put_linetypes();
    void put_layers();
    void put_styles();
    void put_blocks();
    void put_regions();
    void put_paths();
    void put_guides();
    void put_labels();
    void put_polyline(std::span<const glm::dvec2> page, bool closed, const DL_Attributes& look);
    [[nodiscard]] std::vector<Layer> layers() const;
    [[nodiscard]] std::vector<glm::dvec2> flipped(std::span<const glm::dvec2> pixels) const;

    DxfSink to_;
    DL_Dxf dxf_;
    const Drawing& drawing_;
    const VectorOptions& options_;
    const PageLayout& layout_;
    const Paths& paths_;
};

/// On a layer, looking as it says.
DL_Attributes on_layer(const std::string& layer) {
    return {layer, kByLayer, kWidthByLayer, "BYLAYER", 1.0};
}

void DxfWriter::put_header() {
    to_.sectionHeader();
    to_.variable("$ACADVER");
    to_.dxfString(1, "AC1015");
    to_.variable("$HANDSEED");  // above all handles
    to_.dxfHex(5, 0x7FFFFFFF);
    to_.variable("$INSUNITS");
    to_.dxfInt(70, layout_.millimetres ? 4 : 0);
    to_.variable("$MEASUREMENT");
    to_.dxfInt(70, 1);
    const auto corner = [&](const char* name, double x, double y) {
        to_.variable(name);
        to_.dxfReal(10, x);
        to_.dxfReal(20, y);
        to_.dxfReal(30, 0);
    };
    corner("$EXTMIN", 0, 0);
    corner("$EXTMAX", layout_.width, layout_.height);
    to_.sectionEnd();
}

void DxfWriter::put_tables() {
    to_.sectionTables();
    dxf_.writeVPort(to_);
    put_linetypes();
    put_layers();
    put_styles();
    dxf_.writeBlockRecord(to_);
    to_.tableEnd();
    to_.sectionEnd();
}

void DxfWriter::put_linetypes() {
    to_.tableLinetypes(4);
    for (const char* name : {"BYBLOCK", "BYLAYER", kSolid}) {
        dxf_.writeLinetype(to_, DL_LinetypeData(name, "", 0, 0, 0.0));
    }
    std::array<double, 2> pattern = {kDash * options_.stroke, -kGap * options_.stroke};
    dxf_.writeLinetype(to_, DL_LinetypeData(kDashed, "Dashed __ __ __", 0, 2,
                                            pattern[0] - pattern[1], pattern.data()));
    to_.tableEnd();
}

/// Those that something is on, and 0, which every file has.
std::vector<DxfWriter::Layer> DxfWriter::layers() const {
    std::vector<Layer> out = {{"0", kForeground, 0, false}};
    if (drawing_.regions.size() > 0) out.push_back({"FILL", kLightGrey, 0, false});
    for (std::size_t p = 0; p < paths_.size(); ++p) {
        const bool visible = paths_.visible[p] != 0;
        if (p > 0 && paths_.kind[p] == paths_.kind[p - 1] &&
            paths_.visible[p] == paths_.visible[p - 1]) {
            continue;
        }
        const Look look = look_of(paths_.kind[p]);
        const bool black = visible && look.color == Rgb8{0, 0, 0};
        out.push_back({layer_of(paths_.kind[p], visible), black ? kForeground : kDarkGrey,
                       options_.stroke * look.width * (visible ? 1 : kHiddenWidth),
                       !visible && options_.dashed_hidden});
    }
    constexpr std::array<int, 3> kColors = {kRed, kGreen, kBlue};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto along = [axis](const GuideLine& guide) { return guide.axis == axis; };
        if (std::any_of(drawing_.guides.begin(), drawing_.guides.end(), along)) {
            out.push_back(
                {layer_of_guide(axis), kColors[axis], kGuideWidth * options_.stroke, true});
        }
    }
    if (!drawing_.labels.empty()) out.push_back({"LABELS", kForeground, 0, false});
    return out;
}

void DxfWriter::put_layers() {
    const std::vector<Layer> all = layers();
    to_.tableLayers(static_cast<int>(all.size()));
    for (const Layer& layer : all) {
        // A pixel has no width on paper.
        const int weight = layout_.millimetres ? line_weight(layer.width) : kDefaultWidth;
        dxf_.writeLayer(
            to_, DL_LayerData(layer.name, 0),
            DL_Attributes("", layer.color, weight, layer.dashed ? kDashed : kSolid, 1.0));
    }
    to_.tableEnd();
}

/// Tables without which readers complain, though nothing refers to them.
void DxfWriter::put_styles() {
    to_.tableStyle(1);
    dxf_.writeStyle(to_, DL_StyleData("Standard", 0, 0, 1, 0, 0, 2.5, "txt", ""));
    to_.tableEnd();
    dxf_.writeView(to_);
    dxf_.writeUcs(to_);
    to_.tableAppid(1);
    dxf_.writeAppid(to_, "ACAD");
    to_.tableEnd();
    dxf_.writeDimStyle(to_, 1, 1, 1, 1, 1);
}

void DxfWriter::put_blocks() {
    to_.sectionBlocks();
    for (const char* name : {"*Model_Space", "*Paper_Space", "*Paper_Space0"}) {
        dxf_.writeBlock(to_, DL_BlockData(name, 0, 0, 0, 0));
        dxf_.writeEndBlock(to_, name);
    }
    to_.sectionEnd();
}

std::vector<glm::dvec2> DxfWriter::flipped(std::span<const glm::dvec2> pixels) const {
    std::vector<glm::dvec2> out;
    for (const glm::dvec2 pixel : pixels) {
        const glm::dvec2 page = on_page(layout_, pixel);
        out.emplace_back(page.x, layout_.height - page.y);
    }
    return out;
}

void DxfWriter::put_polyline(std::span<const glm::dvec2> page, bool closed,
                             const DL_Attributes& look) {
    dxf_.writePolyline(to_, DL_PolylineData(static_cast<int>(page.size()), 0, 0, closed ? 1 : 0),
                       look);
    for (const glm::dvec2 point : page) dxf_.writeVertex(to_, DL_VertexData(point.x, point.y));
    dxf_.writePolylineEnd(to_);
}

void DxfWriter::put_regions() {
    const DrawnRegions& regions = drawing_.regions;
    const std::span<const glm::dvec2> points(regions.points);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Rgb8 c = rgb8(regions.color[r]);
        const DL_Attributes look("FILL", kByLayer, c[0] << 16 | c[1] << 8 | c[2], kWidthByLayer,
                                 "BYLAYER");
        for (std::uint32_t l = regions.first_loop[r]; l < regions.first_loop[r + 1]; ++l) {
            const std::uint32_t begin = regions.first_point[l], end = regions.first_point[l + 1];
            put_polyline(flipped(points.subspan(begin, end - begin)), true, look);
        }
    }
}

void DxfWriter::put_paths() {
    for (std::size_t p = 0; p < paths_.size(); ++p) {
        const std::uint32_t begin = paths_.first_point[p], end = paths_.first_point[p + 1];
        auto points = std::span<const glm::dvec2>(paths_.points).subspan(begin, end - begin);
        const bool closed = points.size() > 2 && points.front() == points.back();
        if (closed) points = points.first(points.size() - 1);
        put_polyline(flipped(points), closed,
                     on_layer(layer_of(paths_.kind[p], paths_.visible[p] != 0)));
    }
}

void DxfWriter::put_guides() {
    for (const GuideLine& guide : drawing_.guides) {
        const auto part = clipped(guide, layout_);
        if (!part) continue;
        const auto& [from, to] = *part;
        dxf_.writeLine(
            to_, DL_LineData(from.x, layout_.height - from.y, 0, to.x, layout_.height - to.y, 0),
            on_layer(layer_of_guide(guide.axis)));
    }
}

void DxfWriter::put_labels() {
    constexpr int kBaseline = 0, kStandard = 0;
    const double height = kTextHeight * layout_.scale;
    for (const Label& label : drawing_.labels) {
        const glm::dvec2 place = on_page(layout_, label.position);
        const double x = place.x, y = layout_.height - place.y - baseline_of(label) * height;
        const int justified = label.away.x > 0 ? 0 : label.away.x < 0 ? 2 : 1;
        dxf_.writeText(to_,
                       DL_TextData(x, y, 0, x, y, 0, kToTop * height, 1, kStandard, justified,
                                   kBaseline, clean_utf8(label.text), "Standard", 0),
                       on_layer("LABELS"));
    }
}

}  // namespace

Status write_dxf(const std::string& path, const Drawing& drawing, const Paths& paths,
                 const VectorOptions& options) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    DxfWriter(*file, drawing, paths, options).write();
    return file->commit();
}

}  // namespace sightline
