// SVG 1.1 (W3C Recommendation, second edition, 2011): written by hand, for speed and few bytes.
//
// The document: an optional <title>, an optional <rect id="background">, then the groups `fill`,
// `hidden` and `visible`, which are always there, and `construction` and `labels` when there are
// guides or words. They,
// and the groups of kinds inside, are layers for Inkscape.
//
//   fill      regions, one <path> each: data-object, and data-source, the source polygon's number.
//             They do not overlap, so their order is free: those of one colour stand together in a
//             <g fill stroke>, which has the colour for all of them. The stroke is a hairline.
//   hidden, visible
//             for each kind of edge that is present one <g class="KIND">, in it the paths of
//             chain(). data-source has an item for each segment of the path, in order and separated
//             by blanks: "a" or "a,b", the source polygons of the edge. Equal items that follow
//             each other are all written, so that item k belongs to segment k. The last segment of
//             a closed path is its "z".
//             Kinds of plots have a style of their own, and one item for all of a path: the number
//             of its curve.
//   construction
//             a <path> each, class x, y or z: the axis of the world that it is parallel to.
//   labels    a <text> each.
//
// Numbers are printed from integers, multiples of the last decimal. Each subpath begins with an
// absolute "M", and goes on relatively with "l": differences of what is printed, so adding them up
// in decimals gives the rounded points exactly. Numbers have no zero before the point and no blank
// before a minus.
#include <fmt/format.h>

#include <span>
#include <utility>

#include "sightline/scene.hpp"
#include "vector/text.hpp"
#include "vector/writers.hpp"

namespace sightline {
namespace {

/// As many decimals as make the last one no more than 1/100 pixel, down to pages on which a pixel
/// of the camera is 1/100 unit.
int decimals_for(const PageLayout& layout) { return layout.scale >= 0.1 ? 3 : 4; }

std::string hex(Rgb8 c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

class SvgWriter {
public:
    SvgWriter(AtomicFile& file, const Drawing& drawing, const VectorOptions& options)
        : out_(file),
          drawing_(drawing),
          options_(options),
          layout_(options.layout),
          grid_(decimals_for(options.layout)) {
        for (const std::string& name : options.object_names) labels_.push_back(xml_text(name));
    }

    void write(const Paths& paths) {
        put_head();
        put_regions();
        put_lines(paths, 0);
        put_lines(paths, 1);
        if (!drawing_.guides.empty()) put_guides();
        if (!drawing_.labels.empty()) put_labels();
        out_.put("</svg>\n");
        out_.flush();
    }

private:
    /// A point in multiples of the last decimal.
    struct GridPoint {
        std::int64_t x, y;
        bool operator==(const GridPoint&) const = default;
    };
    enum class Repeats { keep, drop };  // steps that rounding made zero

    [[nodiscard]] GridPoint rounded(glm::dvec2 page) const {
        return {grid_.round(page.x), grid_.round(page.y)};
    }

    void put_head();
    void put_background();
    void put_regions();
    void put_region(std::uint32_t region);
    void put_lines(const Paths& paths, std::uint8_t visible);
    void put_path(const Paths& paths, std::uint32_t path);
    void put_guides();
    void put_labels();
    void put_object(std::uint32_t object);
    void put_sources(std::span<const std::uint32_t> parts);
    void put_subpath(std::span<const glm::dvec2> points, Repeats repeats);
    void open_layer(std::string_view name, std::string_view attributes);
    [[nodiscard]] std::string pen(double width) const;
    [[nodiscard]] std::string dashes() const;

    TextSink out_;
    const Drawing& drawing_;
    const VectorOptions& options_;
    const PageLayout& layout_;
    DecimalGrid grid_;
    std::vector<std::string> labels_;  // of objects, escaped; empty where there is no name
};

void SvgWriter::put_head() {
    const std::string_view unit = layout_.millimetres ? "mm" : "";
    out_.put(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"");
    out_.put(" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\"");
    const GridPoint size = rounded({layout_.width, layout_.height});
    out_.put(" width=\"");
    out_.put_decimal(size.x, grid_.decimals());
    out_.put(unit);
    out_.put("\" height=\"");
    out_.put_decimal(size.y, grid_.decimals());
    out_.put(unit);
    out_.put("\" viewBox=\"0 0");
    out_.put_next_decimal(size.x, grid_.decimals());
    out_.put_next_decimal(size.y, grid_.decimals());
    out_.put("\">\n");
    if (!options_.title.empty()) out_.put("<title>" + xml_text(options_.title) + "</title>\n");
    if (options_.background.a > 0) put_background();
}

void SvgWriter::put_background() {
    out_.put("<rect id=\"background\" width=\"100%\" height=\"100%\" fill=\"");
    out_.put(hex(rgb8(glm::vec3(options_.background))));
    if (options_.background.a < 1) {
        out_.put(fmt::format("\" fill-opacity=\"{:.3g}", options_.background.a));
    }
    out_.put("\"/>\n");
}

void SvgWriter::open_layer(std::string_view name, std::string_view attributes) {
    out_.put(fmt::format("<g id=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\"{1}>\n",
                         name, attributes));
}

std::string SvgWriter::pen(double width) const {
    return fmt::format(
        " stroke-width=\"{:.6g}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"", width);
}

std::string SvgWriter::dashes() const {
    return fmt::format(" stroke-dasharray=\"{:.6g} {:.6g}\"", kDash * options_.stroke,
                       kGap * options_.stroke);
}

// -- what paths are made of -----------------------------------------------------------------------

void SvgWriter::put_object(std::uint32_t object) {
    out_.put("<path data-object=\"");
    if (object < labels_.size() && !labels_[object].empty()) {
        out_.put(labels_[object]);
    } else {
        out_.put_integer(object);
    }
}

/// Parts of a path, the last of which is kNone.
void SvgWriter::put_sources(std::span<const std::uint32_t> parts) {
    out_.put("\" data-source=\"");
    if (drawing_.lines.polygons[parts.front()].x == kNone) return;
    if (drawing_.lines.kind[parts.front()] >= EdgeKind::upper) parts = parts.first(2);
    for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
        if (k > 0) out_.put(' ');
        const glm::uvec2 polygons = drawing_.lines.polygons[parts[k]];
        out_.put_integer(polygons.x);
        if (polygons.y == kNone) continue;
        out_.put(',');
        out_.put_integer(polygons.y);
    }
}

/// Points in pixels of the camera.
void SvgWriter::put_subpath(std::span<const glm::dvec2> points, Repeats repeats) {
    const int decimals = grid_.decimals();
    GridPoint last = rounded(on_page(layout_, points.front()));
    out_.put('M');
    out_.put_decimal(last.x, decimals);
    out_.put_next_decimal(last.y, decimals);
    bool begun = false;
    for (const glm::dvec2 point : points.subspan(1)) {
        const GridPoint next = rounded(on_page(layout_, point));
        if (repeats == Repeats::drop && next == last) continue;
        if (!begun) {
            out_.put('l');
            out_.put_decimal(next.x - last.x, decimals);
        } else {
            out_.put_next_decimal(next.x - last.x, decimals);
        }
        out_.put_next_decimal(next.y - last.y, decimals);
        begun = true;
        last = next;
    }
}

// -- layers ---------------------------------------------------------------------------------------

void SvgWriter::put_regions() {
    open_layer("fill", fmt::format(" fill-rule=\"evenodd\" stroke-width=\"{:.6g}\" "
                                   "stroke-linejoin=\"round\"",
                                   kHairline * layout_.scale));
    const std::vector<ColoredRegion> order = by_color(drawing_.regions);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::uint32_t color = order[i].color;
        if (i == 0 || color != order[i - 1].color) {
            if (i > 0) out_.put("</g>\n");
            out_.put(fmt::format("<g fill=\"#{0:06x}\" stroke=\"#{0:06x}\">\n", color));
        }
        put_region(order[i].region);
    }
    if (!order.empty()) out_.put("</g>\n");
    out_.put("</g>\n");
}

void SvgWriter::put_region(std::uint32_t region) {
    const DrawnRegions& regions = drawing_.regions;
    const std::span<const glm::dvec2> points(regions.points);
    put_object(regions.object[region]);
    out_.put("\" data-source=\"");
    out_.put_integer(regions.polygon[region]);
    out_.put("\" d=\"");
    for (std::uint32_t l = regions.first_loop[region]; l < regions.first_loop[region + 1]; ++l) {
        const std::uint32_t begin = regions.first_point[l], end = regions.first_point[l + 1];
        if (begin == end) continue;
        put_subpath(points.subspan(begin, end - begin), Repeats::drop);
        out_.put('z');
    }
    out_.put("\"/>\n");
}

/// What differs from the other lines.
std::string look_attributes(const Look& look, double width) {
    std::string out;
    if (look.color != Rgb8{0, 0, 0}) out += fmt::format(" stroke=\"{}\"", hex(look.color));
    if (look.width != 1) out += fmt::format(" stroke-width=\"{:.6g}\"", look.width * width);
    return out;
}

/// The visible ones, or the hidden ones. Precondition: each stand together, by kind.
void SvgWriter::put_lines(const Paths& paths, std::uint8_t visible) {
    const double width = options_.stroke * (visible != 0 ? 1 : kHiddenWidth);
    const bool dashed = visible == 0 && options_.dashed_hidden;
    open_layer(visible != 0 ? "visible" : "hidden",
               " fill=\"none\" stroke=\"#000\"" + pen(width) + (dashed ? dashes() : ""));
    const auto count = static_cast<std::uint32_t>(paths.size());
    for (std::uint32_t p = 0; p < count;) {
        if (paths.visible[p] != visible) {
            ++p;
            continue;
        }
        const EdgeKind kind = paths.kind[p];
        out_.put(fmt::format(
            "<g class=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\"{1}>\n",
            name_of(kind), look_attributes(look_of(kind), width)));
        for (; p < count && paths.visible[p] == visible && paths.kind[p] == kind; ++p) {
            put_path(paths, p);
        }
        out_.put("</g>\n");
    }
    out_.put("</g>\n");
}

void SvgWriter::put_path(const Paths& paths, std::uint32_t path) {
    const std::uint32_t begin = paths.first_point[path];
    const std::uint32_t count = paths.first_point[path + 1] - begin;
    const auto points = std::span(paths.points).subspan(begin, count);
    // A loop of two segments would be there and back, which chain() does not make of one line.
    const bool closed = count > 2 && points.front() == points.back();
    put_object(paths.object[path]);
    put_sources(std::span(paths.part).subspan(begin, count));
    out_.put("\" d=\"");
    put_subpath(closed ? points.first(count - 1) : points, Repeats::keep);
    out_.put(closed ? "z\"/>\n" : "\"/>\n");
}

void SvgWriter::put_guides() {
    open_layer("construction", " fill=\"none\"" + pen(kGuideWidth * options_.stroke) + dashes());
    for (const GuideLine& guide : drawing_.guides) {
        const auto part = clipped(guide, layout_);
        if (!part) continue;
        const GridPoint from = rounded((*part)[0]), to = rounded((*part)[1]);
        out_.put("<path class=\"");
        out_.put("xyz"[guide.axis]);
        out_.put("\" stroke=\"" + hex(kGuideColors[guide.axis]) + "\" d=\"M");
        out_.put_decimal(from.x, grid_.decimals());
        out_.put_next_decimal(from.y, grid_.decimals());
        out_.put('L');
        out_.put_decimal(to.x, grid_.decimals());
        out_.put_next_decimal(to.y, grid_.decimals());
        out_.put("\"/>\n");
    }
    out_.put("</g>\n");
}

void SvgWriter::put_labels() {
    open_layer("labels", fmt::format(" font-family=\"sans-serif\" font-size=\"{:.6g}\"",
                                     kTextHeight * layout_.scale));
    for (const Label& label : drawing_.labels) {
        const glm::dvec2 place = on_page(layout_, label.position);
        const GridPoint at =
            rounded({place.x, place.y + baseline_of(label) * kTextHeight * layout_.scale});
        out_.put("<text x=\"");
        out_.put_decimal(at.x, grid_.decimals());
        out_.put("\" y=\"");
        out_.put_decimal(at.y, grid_.decimals());
        if (label.away.x <= 0)
            out_.put(label.away.x < 0 ? "\" text-anchor=\"end" : "\" text-anchor=\"middle");
        out_.put("\">" + xml_text(label.text) + "</text>\n");
    }
    out_.put("</g>\n");
}

}  // namespace

Status write_svg(const std::string& path, const Drawing& drawing, const Paths& paths,
                 const VectorOptions& options) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    SvgWriter(*file, drawing, options).write(paths);
    return file->commit();
}

}  // namespace sightline
