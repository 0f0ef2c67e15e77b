// PDF, EPS and PNG through Cairo.
//
// The surface's unit is a point (1/72 inch) for PDF and EPS and a pixel for PNG; a transformation
// lets us draw in units of the page. A pixel of a page is that of CSS, 1/96 inch; a page in
// millimetres becomes a picture of 300 pixels an inch.
//
// Cairo rounds PDF and EPS coordinates to 1/256 point (1.4 micrometres). It would note the time of
// day in both, so PDF is given a fixed date and the line is cut from EPS: bytes depend on the
// drawing alone. PNG files are compressed by our own writer.
#include <cairo-pdf.h>
#include <cairo-ps.h>
#include <cairo.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "image/atomic_file.hpp"
#include "image/png_writer.hpp"
#include "sightline/image.hpp"
#include "vector/text.hpp"
#include "vector/writers.hpp"

namespace sightline {
namespace {

constexpr double kPointsPerInch = 72, kCssPixelsPerInch = 96, kPngPixelsPerInch = 300,
                 kMillimetresPerInch = 25.4;
constexpr double kLongestPngSide = 32'767;  // of a Cairo image
constexpr double kMostPngPixels = 1u << 28;

struct Release {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, Release>;
using Context = std::unique_ptr<cairo_t, Release>;

// -- drawing --------------------------------------------------------------------------------------

void set_color(cairo_t* to, Rgb8 c, double alpha = 1) {
    cairo_set_source_rgba(to, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0, alpha);
}

void trace_points(cairo_t* to, const PageLayout& layout, std::span<const glm::dvec2> points) {
    for (const glm::dvec2 point : points) {
        const glm::dvec2 page = on_page(layout, point);
        cairo_line_to(to, page.x, page.y);  // the first one moves
    }
}

void set_pen(cairo_t* to, double stroke, double share, bool dashed) {
    const std::array<double, 2> pattern = {kDash * stroke, kGap * stroke};
    cairo_set_dash(to, pattern.data(), dashed ? 2 : 0, 0);
    cairo_set_line_width(to, share * stroke);
}

void draw_background(cairo_t* to, glm::vec4 color, bool opaque) {
    if (!(color.a > 0)) return;
    if (opaque) {  // as it looks on white paper
        color = glm::vec4(glm::mix(glm::vec3(1), glm::vec3(color), color.a), 1);
    }
    set_color(to, rgb8(glm::vec3(color)), std::min(1.0, double{color.a}));
    cairo_paint(to);
}

/// So many points are collected before they are painted: Cairo takes longer over many small
/// operations than over few large ones, but must not take forever over one.
constexpr std::size_t kPointsAtOnce = 4096;

void trace_region(cairo_t* to, const DrawnRegions& regions, std::uint32_t region,
                  const PageLayout& layout) {
    const std::span<const glm::dvec2> points(regions.points);
    for (std::uint32_t l = regions.first_loop[region]; l < regions.first_loop[region + 1]; ++l) {
        const std::uint32_t begin = regions.first_point[l], end = regions.first_point[l + 1];
        cairo_new_sub_path(to);
        trace_points(to, layout, points.subspan(begin, end - begin));
        cairo_close_path(to);
    }
}

/// Regions do not overlap, so those of one colour are filled at once.
void draw_regions(cairo_t* to, const DrawnRegions& regions, const PageLayout& layout) {
    cairo_set_fill_rule(to, CAIRO_FILL_RULE_EVEN_ODD);
    set_pen(to, layout.scale, kHairline, false);
    const std::vector<ColoredRegion> order = by_color(regions);
    std::size_t traced = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto [color, region] = order[i];
        trace_region(to, regions, region, layout);
        const std::uint32_t first = regions.first_loop[region],
                            last = regions.first_loop[region + 1];
        traced += regions.first_point[last] - regions.first_point[first];
        const bool go_on = i + 1 < order.size() && order[i + 1].color == color;
        if (go_on && traced < kPointsAtOnce) continue;
        set_color(to, {static_cast<std::uint8_t>(color >> 16),
                       static_cast<std::uint8_t>(color >> 8), static_cast<std::uint8_t>(color)});
        cairo_fill_preserve(to);
        cairo_stroke(to);
        traced = 0;
    }
}

void draw_lines(cairo_t* to, const Paths& paths, const VectorOptions& options) {
    std::size_t traced = 0;
    for (std::size_t p = 0; p < paths.size(); ++p) {
        const std::uint32_t begin = paths.first_point[p], end = paths.first_point[p + 1];
        const auto points = std::span(paths.points).subspan(begin, end - begin);
        const bool closed = points.size() > 2 && points.front() == points.back();
        cairo_new_sub_path(to);
        trace_points(to, options.layout, closed ? points.first(points.size() - 1) : points);
        if (closed) cairo_close_path(to);
        traced += points.size();
        const bool visible = paths.visible[p] != 0;
        const Look look = look_of(paths.kind[p]);
        const bool go_on = p + 1 < paths.size() && paths.visible[p + 1] == paths.visible[p] &&
                           look_of(paths.kind[p + 1]) == look;
        if (go_on && traced < kPointsAtOnce) continue;
        set_color(to, look.color);
        set_pen(to, options.stroke, look.width * (visible ? 1 : kHiddenWidth),
                !visible && options.dashed_hidden);
        cairo_stroke(to);
        traced = 0;
    }
}

void draw_guides(cairo_t* to, const Drawing& drawing, const VectorOptions& options) {
    set_pen(to, options.stroke, kGuideWidth, true);
    for (const GuideLine& guide : drawing.guides) {
        const auto part = clipped(guide, options.layout);
        if (!part) continue;
        set_color(to, kGuideColors[guide.axis]);
        cairo_move_to(to, (*part)[0].x, (*part)[0].y);
        cairo_line_to(to, (*part)[1].x, (*part)[1].y);
        cairo_stroke(to);
    }
}

/// In a font of the system's: the only thing on a page that depends on the machine.
void draw_labels(cairo_t* to, const Drawing& drawing, const PageLayout& layout) {
    const double height = kTextHeight * layout.scale;
    cairo_select_font_face(to, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(to, height);
    set_color(to, {0, 0, 0});
    for (const Label& label : drawing.labels) {
        const std::string text = clean_utf8(label.text);
        cairo_text_extents_t extents;
        cairo_text_extents(to, text.c_str(), &extents);
        const glm::dvec2 place = on_page(layout, label.position);
        cairo_move_to(to, place.x - 0.5 * (1 - label.away.x) * extents.x_advance,
                      place.y + baseline_of(label) * height);
        cairo_show_text(to, text.c_str());
    }
}

/// Draws everything on one page whose unit is `scale` units of the surface.
cairo_status_t draw(cairo_surface_t* surface, double scale, bool opaque, const Drawing& drawing,
                    const Paths& paths, const VectorOptions& options) {
    const Context context(cairo_create(surface));
    cairo_t* to = context.get();
    cairo_scale(to, scale, scale);
    cairo_set_line_cap(to, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(to, CAIRO_LINE_JOIN_ROUND);
    draw_background(to, options.background, opaque);
    draw_regions(to, drawing.regions, options.layout);
    draw_lines(to, paths, options);
    draw_guides(to, drawing, options);
    if (!drawing.labels.empty()) draw_labels(to, drawing, options.layout);
    cairo_show_page(to);
    return cairo_status(to);
}

Error cairo_error(const std::string& path, cairo_status_t status) {
    return {ErrorKind::io, fmt::format("cannot write '{}': {}; write another format, such as SVG",
                                       path, cairo_status_to_string(status))};
}

// -- PDF and EPS ----------------------------------------------------------------------------------

/// Takes what Cairo writes; without the line of a head that says when.
class Stream {
public:
    Stream(AtomicFile& file, bool has_date_line) : file_(&file), in_head_(has_date_line) {}

    static cairo_status_t write(void* self, const unsigned char* data, unsigned length) {
        return static_cast<Stream*>(self)->take(
                   {reinterpret_cast<const char*>(data), std::size_t{length}})
                   ? CAIRO_STATUS_SUCCESS
                   : CAIRO_STATUS_WRITE_ERROR;
    }

private:
    static constexpr std::string_view kDate = "%%CreationDate:", kHeadEnd = "%%EndComments\n";

    bool take(std::string_view bytes) {
        if (!in_head_) return file_->write(bytes.data(), bytes.size()).ok();
        head_ += bytes;
        if (head_.find(kHeadEnd) == std::string::npos) return true;
        in_head_ = false;
        const std::size_t date = head_.find(kDate);
        if (date < head_.find(kHeadEnd)) head_.erase(date, head_.find('\n', date) + 1 - date);
        return file_->write(head_.data(), head_.size()).ok();
    }

    AtomicFile* file_;
    bool in_head_;
    std::string head_;
};

/// A title in a comment of PostScript, where ASCII is safe and 255 characters are the limit.
std::string title_comment(const std::string& title) {
    std::string out = "%%Title: ";
    for (const char c : title.substr(0, 200)) out += c >= ' ' && c < 0x7F ? c : '?';
    return out;
}

Surface eps_surface(Stream& stream, glm::dvec2 size, const VectorOptions& options) {
    Surface surface(cairo_ps_surface_create_for_stream(Stream::write, &stream, size.x, size.y));
    cairo_ps_surface_set_eps(surface.get(), 1);
    if (!options.title.empty()) {
        cairo_ps_surface_dsc_comment(surface.get(), title_comment(options.title).c_str());
    }
    // The page and not, as Cairo would have it, what is drawn on it.
    const std::string box =
        fmt::format("%%BoundingBox: 0 0 {} {}", std::ceil(size.x - 1e-6), std::ceil(size.y - 1e-6));
    cairo_ps_surface_dsc_comment(surface.get(), box.c_str());
    const std::string exact = fmt::format("%%HiResBoundingBox: 0 0 {:.6f} {:.6f}", size.x, size.y);
    cairo_ps_surface_dsc_comment(surface.get(), exact.c_str());
    return surface;
}

Surface pdf_surface(Stream& stream, glm::dvec2 size, const VectorOptions& options) {
    Surface surface(cairo_pdf_surface_create_for_stream(Stream::write, &stream, size.x, size.y));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                   "1970-01-01T00:00:00Z");
    if (!options.title.empty()) {
        cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                       clean_utf8(options.title).c_str());
    }
    return surface;
}

Status write_pages(const std::string& path, bool eps, const Drawing& drawing, const Paths& paths,
                   const VectorOptions& options) {
    Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
    if (!file) return file.error();
    const PageLayout& layout = options.layout;
    const double points =
        kPointsPerInch / (layout.millimetres ? kMillimetresPerInch : kCssPixelsPerInch);
    const glm::dvec2 size = points * glm::dvec2(layout.width, layout.height);
    Stream stream(*file, eps);
    const Surface surface =
        eps ? eps_surface(stream, size, options) : pdf_surface(stream, size, options);
    cairo_status_t status = draw(surface.get(), points, eps, drawing, paths, options);
    cairo_surface_finish(surface.get());
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface.get());
    if (Status written = file->status(); !written) return written;
    if (status != CAIRO_STATUS_SUCCESS) return cairo_error(path, status);
    return file->commit();
}

// -- PNG ------------------------------------------------------------------------------------------

/// Cairo's premultiplied 0xAARRGGBB to straight R, G, B, A.
void pixel_to_rgba8(std::uint32_t pixel, std::uint8_t* out) {
    const std::uint32_t alpha = pixel >> 24;
    for (unsigned k = 0; k < 3; ++k) {
        const std::uint32_t c = pixel >> (16 - 8 * k) & 0xFFu;
        out[k] = static_cast<std::uint8_t>(alpha == 0 ? 0 : (c * 255 + alpha / 2) / alpha);
    }
    out[3] = static_cast<std::uint8_t>(alpha);
}

Status write_pixels(const std::string& path, cairo_surface_t* surface) {
    const auto width = static_cast<std::uint32_t>(cairo_image_surface_get_width(surface));
    const auto height = static_cast<std::uint32_t>(cairo_image_surface_get_height(surface));
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface)) / 4;
    const auto* pixels =
        reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(surface));
    Result<PngWriter> writer =
        PngWriter::create(path, width, height, PngLayout::rgba8, PngContent::color);
    if (!writer) return writer.error();
    const auto source = [&](std::uint32_t first, std::uint32_t count, std::uint8_t* out) {
        for (std::uint32_t y = first; y < first + count; ++y) {
            for (std::uint32_t x = 0; x < width; ++x, out += 4) {
                pixel_to_rgba8(pixels[y * stride + x], out);
            }
        }
    };
    if (Status written = writer->write_rows(source, height, 0); !written) return written;
    return writer->finish();
}

Status write_png(const std::string& path, const Drawing& drawing, const Paths& paths,
                 const VectorOptions& options) {
    const PageLayout& layout = options.layout;
    const double scale = layout.millimetres ? kPngPixelsPerInch / kMillimetresPerInch : 1;
    const double width = std::max(1.0, std::round(scale * layout.width));
    const double height = std::max(1.0, std::round(scale * layout.height));
    if (std::max(width, height) > kLongestPngSide || width * height > kMostPngPixels) {
        return Error{ErrorKind::bad_option,
                     fmt::format("cannot write '{}': a picture of {:.0f} x {:.0f} pixels is larger "
                                 "than {} a side or {} in all; choose a smaller page or another "
                                 "format",
                                 path, width, height, kLongestPngSide, kMostPngPixels)};
    }
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(width),
                                                     static_cast<int>(height)));
    cairo_status_t status = draw(surface.get(), scale, false, drawing, paths, options);
    cairo_surface_flush(surface.get());
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface.get());
    if (status != CAIRO_STATUS_SUCCESS) return cairo_error(path, status);
    return write_pixels(path, surface.get());
}

}  // namespace

Status write_with_cairo(const std::string& path, VectorFormat format, const Drawing& drawing,
                        const Paths& paths, const VectorOptions& options) {
    if (format == VectorFormat::png) return write_png(path, drawing, paths, options);
    return write_pages(path, format == VectorFormat::eps, drawing, paths, options);
}

}  // namespace sightline
