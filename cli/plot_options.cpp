#include "plot_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "errors.hpp"
#include "trace_options.hpp"

namespace sightline::cli {
namespace {

constexpr double kPanoramaFov = 50;
constexpr std::uint64_t kMostCurves = 100'000;

constexpr std::array kLookRows = {
    Option{"--lines", "z|x|both", "curves of constant z, of constant x, or both (default: z)"},
    Option{"--count", "N", "curves of either family, two or more (default: 40)"},
    Option{"--hatch", "", "more curves where the surface turns away from the light"},
    Option{"--sides", "both|upper|lower",
           "which sides of surfaces are drawn; lower ones are grey (default: both)"},
    Option{"--style", "surface|ridges",
           "ridges: each curve hides what is behind it down to the ground (default: surface)"},
    Option{"--hidden", "none|dashed|solid", "how hidden lines are drawn (default: none)"},
    Option{"--axes", "box|none",
           "a box with ticks and numbers (default: box; none for ridges and with --from)"},
    Option{"--no-outline", "", "implicit surfaces without the lines where they turn away"},
    Option{"--tolerance", "T",
           "how far curves may be off, in units of the drawing (default: 0.05)"},
    Option{"--image-space", "",
           "the textbook's version with one height a column of pixels, to compare"},
};

constexpr std::array kDomainRows = {
    Option{"--x", "A:B", "range of x (default: -10:10, or that of the map)"},
    Option{"--z", "A:B", "range of z (default: that of x, or of the map)"},
    Option{"--y", "A:B", "heights outside of it are left out (default: all; poles are cut off)"},
    Option{"--stretch", "F|auto",
           "heights are drawn F times as tall; auto: so that it looks well (default: 1)"},
};

constexpr std::array kMapRows = {
    Option{"--cell", "W[,D]",
           "distance of columns and of rows (default: what the file says, or 1)"},
    Option{"--height-scale", "F", "heights are multiplied by it (default: 1)"},
    Option{"--no-data", "V", "this height means that there is none"},
};

constexpr std::array kCameraRows = {
    Option{"--from", "X,Y,Z", "a panorama from this point, in the map's coordinates"},
    Option{"--eye", "X,Y,Z", "where the camera stands"},
    Option{"--target", "X,Y,Z", "the point it looks at (default: the middle)"},
    Option{"--up", "X,Y,Z", "what is upwards (default: 0,1,0)"},
    Option{"--direction", "X,Y,Z", "direction of gaze, from the eye into the scene"},
    Option{"--view", "NAME",
           "front, back, left, right, top, bottom, isometric (default), dimetric, trimetric"},
    Option{"--projection", "NAME", "perspective (default), orthographic, cavalier, cabinet"},
    Option{"--fov", "DEG", "vertical field of view of a perspective (default: 40; --from: 50)"},
    Option{"--ortho-height", "H", "height of a parallel view, in the scene's unit"},
    Option{"--oblique-angle", "DEG", "of cavalier and cabinet (default: 45)"},
    Option{"--zoom", "F", "enlarge about the centre (default: 1)"},
    Option{"--resolution", "WxH", "size of the drawing in pixels (default: 1024x768)"},
};

/// "A:B" with A < B.
std::optional<glm::dvec2> read_range(OptionReader& reader, std::string_view option) {
    const auto text = reader.arguments().value(option);
    if (!text) return std::nullopt;
    const std::size_t colon = text->find(':');
    if (colon != std::string::npos) {
        const auto low = parse_number(std::string_view(*text).substr(0, colon)),
                   high = parse_number(std::string_view(*text).substr(colon + 1));
        if (low && high && *low < *high && std::isfinite(*high - *low))
            return glm::dvec2(*low, *high);
        if (low && high) {
            reader.fail(
                wrong_use("{}: the range '{}' is empty; give the lower end first, as in "
                          "{} -5:5",
                          option, *text, option));
            return std::nullopt;
        }
    }
    reader.fail(wrong_use("{}: '{}' is no range, as in {} -5:5", option, *text, option));
    return std::nullopt;
}

/// A text that no file has the name of is a formula, unless it looks like a path.
void read_item(OptionReader& reader, const std::string& text, PlotCommandOptions& options) {
    std::error_code ignored;
    if (std::filesystem::exists(text, ignored)) {
        options.items.push_back({text, std::nullopt});
        return;
    }
    Result<Formula> formula = parse_formula(text);
    if (formula) {
        options.items.push_back({text, std::move(*formula)});
        return;
    }
    const bool path_like =
        text.find_first_of("=()^*+ ") == std::string::npos &&
        (text.find('.') != std::string::npos || text.find('/') != std::string::npos);
    reader.fail(path_like
                    ? failure("{}: there is no such file; give a height map, or a formula such "
                              "as \"y = sin(x) * z\"",
                              text)
                    : wrong_use("{}", formula.error().message));
}

void read_curves(OptionReader& reader, PlotCommandOptions& options) {
    constexpr std::array<std::string_view, 3> kLines = {"z", "x", "both"};
    constexpr std::array<std::string_view, 3> kSides = {"both", "upper", "lower"};
    constexpr std::array<std::string_view, 2> kStyles = {"surface", "ridges"};
    constexpr std::array<std::string_view, 2> kAxes = {"box", "none"};
    const Arguments& arguments = reader.arguments();
    const auto lines = reader.choice("--lines", kLines).value_or(0);
    options.curves.along_x = lines != 1;
    options.curves.along_z = lines != 0;
    options.curves.count = static_cast<std::uint32_t>(
        reader.count("--count", 2, kMostCurves, "a number from 2 to 100000").value_or(40));
    options.curves.hatch = arguments.has("--hatch");
    options.plot.ridges = reader.choice("--style", kStyles).value_or(0) == 1;
    if (options.plot.ridges && lines != 0) {
        reader.fail(wrong_use("--style ridges draws curves of constant z: leave --lines out"));
    }
    const auto sides = reader.choice("--sides", kSides);
    if (sides && options.plot.ridges) {
        reader.fail(wrong_use("--style ridges hides all below a curve: leave --sides out"));
    }
    options.plot.sides =
        options.plot.ridges ? PlotSides::upper : static_cast<PlotSides>(sides.value_or(0));
    options.axes = reader.choice("--axes", kAxes)
                       .value_or(options.plot.ridges || arguments.has("--from") ? 1 : 0) == 0;
    options.plot.tolerance =
        reader.number("--tolerance", {0, 100, true}, "a number above 0, up to 100").value_or(0.05);
    options.image_space = arguments.has("--image-space");
    if (options.image_space) {
        options.axes = false;  // it can't tell what hides them
        if (lines != 0)
            reader.fail(wrong_use(
                "--image-space draws the curves across the view only: leave --lines out"));
        if (arguments.has("--hatch")) reader.fail(wrong_use("--image-space draws no --hatch"));
    }
    options.outline = !arguments.has("--no-outline");
}

void read_domain(OptionReader& reader, PlotCommandOptions& options) {
    options.x = read_range(reader, "--x");
    options.z = read_range(reader, "--z");
    options.y = read_range(reader, "--y");
    options.stretch = 1;
    if (reader.arguments().value("--stretch") == "auto") {
        options.stretch.reset();
    } else {
        options.stretch =
            reader.number("--stretch", {0, 1e9, true}, "a factor above 0, or auto").value_or(1);
    }
}

void read_map(OptionReader& reader, PlotCommandOptions& options) {
    const Arguments& arguments = reader.arguments();
    if (const auto text = arguments.value("--cell")) {
        const std::vector<std::string_view> parts = split_list(*text);
        const auto width = parts.empty() ? std::nullopt : parse_number(parts.front()),
                   depth = parts.size() == 2 ? parse_number(parts.back()) : width;
        if (parts.size() > 2 || !width || !depth || !(*width > 0 && *depth > 0)) {
            reader.fail(
                wrong_use("--cell: '{}' is no size of a cell, as in --cell 30 or --cell "
                          "30,25",
                          *text));
        } else {
            options.map.cell = glm::dvec2(*width, *depth);
        }
    }
    options.map.height_scale = reader.number("--height-scale", {-1e9, 1e9}, "a number").value_or(1);
    options.map.no_data = reader.number("--no-data", {-1e300, 1e300}, "a height");
    for (const char* const option : {"--cell", "--height-scale", "--no-data"}) {
        if (arguments.has(option) && !options.has_map())
            reader.fail(wrong_use("{} is for height maps, but none is given", option));
    }
}

void read_view(OptionReader& reader, PlotCommandOptions& options) {
    options.camera = read_camera(reader);
    options.resolution = read_resolution(reader, Resolution{}, kAnyNumberOfPixels);
    options.from = reader.point("--from");
    if (!options.from) return;
    for (const char* const option : {"--eye", "--projection"}) {
        if (reader.arguments().has(option))
            reader.fail(
                wrong_use("--from says where the eye is, in perspective: leave {} out", option));
    }
    if (!options.camera.fov) options.camera.fov = kPanoramaFov;
}

/// What does not go together with implicit surfaces, whose curves are found another way.
void check_implicit(OptionReader& reader, const PlotCommandOptions& options) {
    if (!options.has_implicit()) return;
    for (const char* const option :
         {"--hatch", "--sides", "--style", "--image-space", "--stretch"}) {
        if (reader.arguments().has(option))
            reader.fail(
                wrong_use("{} is for functions and maps, not for implicit surfaces", option));
    }
}

}  // namespace

constinit const std::span<const Option> kPlotLookOptions = kLookRows;
constinit const std::span<const Option> kPlotDomainOptions = kDomainRows;
constinit const std::span<const Option> kPlotMapOptions = kMapRows;
constinit const std::span<const Option> kPlotCameraOptions = kCameraRows;

bool PlotCommandOptions::has_implicit() const {
    return std::ranges::any_of(items, [](const PlotItem& item) {
        return item.formula && item.formula->kind == Formula::Kind::implicit;
    });
}

bool PlotCommandOptions::has_map() const {
    return std::ranges::any_of(items, [](const PlotItem& item) { return !item.formula; });
}

Result<PlotCommandOptions> read_plot_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    PlotCommandOptions options;
    if (arguments.models().empty()) {
        return wrong_use(
            "nothing to plot; give a formula such as \"y = sin(x) * z\" or a height map");
    }
    for (const std::string& text : arguments.models()) read_item(reader, text, options);
    read_curves(reader, options);
    read_domain(reader, options);
    read_map(reader, options);
    read_view(reader, options);
    check_implicit(reader, options);
    options.common = read_common(reader);
    options.plot.threads = options.common.threads;
    std::vector<std::string> maps;
    for (const PlotItem& item : options.items)
        if (!item.formula) maps.push_back(item.text);
    options.drawing = read_drawing_output(reader, options.resolution, options.common, maps);
    options.plot.hidden = options.drawing.hidden;
    if (reader.error()) return *reader.error();
    return options;
}

}  // namespace sightline::cli
