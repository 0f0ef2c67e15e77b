#include "drawing_output.hpp"

#include <array>
#include <cmath>

#include "errors.hpp"
#include "sightline/image.hpp"

namespace sightline::cli {
namespace {

constexpr std::array kFormats = {VectorFormat::svg, VectorFormat::pdf, VectorFormat::eps,
                                 VectorFormat::dxf, VectorFormat::png};

/// "a4", "letter" or "WxHmm"; a4 and letter lie or stand as the picture does.
std::optional<glm::dvec2> parse_page(std::string_view text, Resolution resolution) {
    const auto turned = [&](double small, double large) {
        return resolution.width > resolution.height ? glm::dvec2(large, small)
                                                    : glm::dvec2(small, large);
    };
    if (text == "a4") return turned(210, 297);
    if (text == "letter") return turned(215.9, 279.4);
    const std::size_t x = text.find('x');
    if (!text.ends_with("mm") || x == std::string_view::npos) return std::nullopt;
    text.remove_suffix(2);
    const auto width = parse_number(text.substr(0, x)), height = parse_number(text.substr(x + 1));
    if (!width || !height || !(*width > 0 && *height > 0 && *width <= 1e5 && *height <= 1e5))
        return std::nullopt;
    return glm::dvec2(*width, *height);
}

/// "1:50" or "20:1".
std::optional<double> parse_scale(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto paper = parse_number(text.substr(0, colon)),
               scene = parse_number(text.substr(colon + 1));
    if (!paper || !scene || !(*paper > 0 && *scene > 0)) return std::nullopt;
    const double scale = *paper / *scene;
    return std::isfinite(scale) && scale > 0 ? std::optional(scale) : std::nullopt;
}

PageOptions read_page(OptionReader& reader, Resolution resolution) {
    PageOptions page;
    const Arguments& arguments = reader.arguments();
    if (const auto text = arguments.value("--page")) {
        page.size = parse_page(*text, resolution);
        if (!page.size) {
            reader.fail(
                wrong_use("--page: '{}' is no page; give a4, letter or a size up to 100 m as in "
                          "--page 420x297mm",
                          *text));
        }
    }
    if (const auto text = arguments.value("--scale")) {
        page.scale = parse_scale(*text);
        if (!page.scale) {
            reader.fail(wrong_use("--scale: '{}' is no scale, as in --scale 1:50", *text));
        }
    }
    const auto margin = reader.number("--margin", {0, 1e5}, "a number of millimetres from 0 on");
    page.margin = margin.value_or(page.margin);
    if (margin && !page.size) {
        reader.fail(wrong_use("--margin needs a page, as in --page a4"));
    }
    return page;
}

VectorOutput read_file(OptionReader& reader, const CommonOptions& common,
                       std::span<const std::string> inputs) {
    auto output = read_output<VectorFormat>(reader, "--output", kFormats);
    if (!output) {
        reader.fail(wrong_use("nothing to write; name a file, as in -o drawing.svg"));
        return {};
    }
    check_output(reader, *output, inputs);
    if (output->path == "-" && common.json) {
        reader.fail(
            wrong_use("--json would mix with the drawing on standard output; write the drawing to "
                      "a file"));
    }
    return std::move(*output);
}

constexpr std::array kOutputRows = {
    Option{"--output", "FILE",
           "the drawing: .svg, .pdf, .eps, .dxf or .png; '-' is standard output", "-o"},
    Option{"--output-format", "NAME",
           "svg, pdf, eps, dxf or png, whatever the extension; needed for '-'"},
    Option{"--page", "SIZE",
           "a4, letter or WxHmm (default: one unit of the drawing is one pixel of --resolution)"},
    Option{"--margin", "MM", "kept free around the drawing on its page (default: 10)"},
    Option{"--scale", "A:B",
           "A mm on paper for B units of the scene; parallel projections (default: fill the page)"},
    Option{"--stroke", "WIDTH", "of the lines, in units of the drawing: mm on a page (default: 1)"},
    Option{"--background", "COLOUR", "R,G,B[,A] in 0..255, '#rrggbb[aa]' or none (default: none)"},
    Option{"--sort", "", "put lines in an order that is short for a plotter's pen"},
};

}  // namespace

constinit const std::span<const Option> kDrawingOutputOptions = kOutputRows;

constinit const Option kHiddenOption = {"--hidden", "none|dashed|solid",
                                        "how hidden lines are drawn (default: none)"};

DrawingOutput read_drawing_output(OptionReader& reader, Resolution resolution,
                                  const CommonOptions& common,
                                  std::span<const std::string> inputs) {
    constexpr std::array<std::string_view, 3> kHidden = {"none", "dashed", "solid"};
    DrawingOutput out;
    if (const auto hidden = reader.choice("--hidden", kHidden)) {
        out.hidden = *hidden != 0;
        out.dashed = *hidden == 1;
    }
    out.stroke = reader.number("--stroke", {0, 1e6, true}, "a width above 0").value_or(1);
    out.background = reader.color("--background").value_or(out.background);
    out.sorted = reader.arguments().has("--sort");
    out.page = read_page(reader, resolution);
    out.file = read_file(reader, common, inputs);
    return out;
}

VectorOptions vector_options(const DrawingOutput& output, const PageLayout& layout) {
    VectorOptions vector;
    vector.layout = layout;
    vector.stroke = output.stroke;
    vector.dashed_hidden = output.dashed;
    vector.sorted = output.sorted;
    const glm::u8vec4 b = output.background;
    vector.background = {from_srgb8(b.r), from_srgb8(b.g), from_srgb8(b.b),
                         static_cast<float>(b.a) / 255.0f};
    return vector;
}

}  // namespace sightline::cli
