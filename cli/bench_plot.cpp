// The picture of `sightline bench --table`: a log-log plot of the times with a label at the end of
// every line, and the table under it. Measured algorithms are solid lines in colours that the
// colour-blind tell apart (M. Okabe, K. Ito, Color Universal Design, 2008) with markers of
// different shapes; the historical estimates are grey and dashed. Lengths are pixels, y down.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "bench_table.hpp"

namespace sightline::cli {
namespace {

constexpr double kWidth = 1000, kLeft = 90, kRight = 770, kTop = 92, kBottom = 500;
constexpr double kLabelX = kRight + 26, kLabelStep = 17;
constexpr double kTableTop = 588, kRowHeight = 22, kNameWidth = 170;
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                "#e69f00", "#56b4e9", "#000000"};
constexpr std::array kDashes = {"8 4", "2 3", "8 3 2 3"};
constexpr const char* kHistoricalColor = "#767676";

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '&')
            result += "&amp;";
        else
            result += c;
    }
    return result;
}

/// Whole decades that hold all values: 10^low .. 10^high.
struct Decades {
    int low = 0, high = 1;

    explicit Decades(const std::vector<double>& values) {
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        low = static_cast<int>(std::floor(std::log10(*least)));
        high = std::max(static_cast<int>(std::ceil(std::log10(*most))), low + 1);
    }
    /// 0 at the lower end, 1 at the upper one.
    [[nodiscard]] double place(double value) const {
        return (std::log10(value) - low) / (high - low);
    }
};

std::string decade_name(int exponent) {
    const double value = std::pow(10.0, exponent);
    return exponent < 3 ? fmt::format("{:g}", value) : grouped(static_cast<std::uint64_t>(value));
}

struct Mark {
    double x, y;
};

/// A row of the table as a line of the plot.
struct Curve {
    std::string name, color;
    std::vector<Mark> marks;
    bool historical = false;
    std::size_t number = 0;  ///< among those of its kind: chooses marker and dashes
    double label_y = 0;
};

class Picture {
public:
    explicit Picture(const Table& table) : table_(table), x_(triangles()), y_(ratios()) {}

    std::string draw() {
        std::vector<Curve> curves = make_curves();
        place_labels(curves);
        heading();
        axes();
        for (const Curve& curve : curves) draw_curve(curve);
        const double height = draw_table() + 24;
        return fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1:.0f}\" width=\"{0}\" "
            "height=\"{1:.0f}\" role=\"img\" font-family=\"Helvetica, Arial, sans-serif\" "
            "font-size=\"13\" fill=\"#222\">\n<title>{2}</title>\n<desc>{3}</desc>\n"
            "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{4}</svg>\n",
            kWidth, height, escaped(table_.title), escaped(table_.caption), body_);
    }

private:
    std::vector<double> triangles() const {
        std::vector<double> values;
        for (const TableScene& scene : table_.scenes) values.push_back(scene.triangles);
        return values;
    }
    std::vector<double> ratios() const {
        std::vector<double> values = {1};  // the unit
        for (const TableRow& row : table_.rows) {
            for (const auto& ratio : row.ratios) {
                if (ratio) values.push_back(*ratio);
            }
        }
        return values;
    }
    double x_of(double triangles) const { return kLeft + (kRight - kLeft) * x_.place(triangles); }
    double y_of(double ratio) const { return kBottom - (kBottom - kTop) * y_.place(ratio); }

    template <class... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(body_), format, std::forward<Args>(args)...);
        body_ += '\n';
    }
    void text(double x, double y, std::string_view attributes, std::string_view words) {
        add("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>", x, y, attributes, escaped(words));
    }
    void line(Mark from, Mark to, std::string_view attributes) {
        add("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>", from.x, from.y,
            to.x, to.y, attributes);
    }

    std::vector<Curve> make_curves() const {
        std::vector<Curve> curves;
        std::array<std::size_t, 2> numbers{};
        for (const TableRow& row : table_.rows) {
            Curve curve{row.name, kHistoricalColor, {}, row.historical};
            curve.number = numbers[row.historical ? 1 : 0]++;
            if (!row.historical) curve.color = kColors[curve.number % kColors.size()];
            for (std::size_t i = 0; i < row.ratios.size(); ++i) {
                if (!row.ratios[i]) continue;
                curve.marks.push_back({x_of(table_.scenes[i].triangles), y_of(*row.ratios[i])});
            }
            if (!curve.marks.empty()) curves.push_back(std::move(curve));
        }
        return curves;
    }

    /// Beside the ends of the curves, from the top down, pushed apart where they would overlap.
    static void place_labels(std::vector<Curve>& curves) {
        std::stable_sort(curves.begin(), curves.end(), [](const Curve& a, const Curve& b) {
            return a.marks.back().y < b.marks.back().y;
        });
        double least = kTop;
        for (Curve& curve : curves) {
            curve.label_y = std::max(curve.marks.back().y, least);
            least = curve.label_y + kLabelStep;
        }
        double most = kBottom;
        for (std::size_t i = curves.size(); i-- > 0;) {
            curves[i].label_y = std::min(curves[i].label_y, most);
            most = curves[i].label_y - kLabelStep;
        }
    }

    void heading() {
        text(kLeft, 40, "font-size=\"20\" font-weight=\"bold\"", table_.title);
        text(kLeft, 64, "fill=\"#555\"", table_.caption);
    }

    void axes() {
        for (int e = x_.low; e <= x_.high; ++e) {
            const double x = x_of(std::pow(10.0, e));
            line({x, kTop}, {x, kBottom}, "stroke=\"#ddd\"");
            line({x, kBottom}, {x, kBottom + 6}, "stroke=\"#444\"");
            text(x, kBottom + 22, "text-anchor=\"middle\"", decade_name(e));
            for (int k = 2; k < 10 && e < x_.high; ++k) {
                const double minor = x_of(k * std::pow(10.0, e));
                line({minor, kBottom}, {minor, kBottom + 3}, "stroke=\"#444\"");
            }
        }
        for (int e = y_.low; e <= y_.high; ++e) {
            const double y = y_of(std::pow(10.0, e));
            line({kLeft, y}, {kRight, y}, "stroke=\"#ddd\"");
            line({kLeft - 6, y}, {kLeft, y}, "stroke=\"#444\"");
            text(kLeft - 10, y + 4.5, "text-anchor=\"end\"", decade_name(e));
            for (int k = 2; k < 10 && e < y_.high; ++k) {
                const double minor = y_of(k * std::pow(10.0, e));
                line({kLeft - 3, minor}, {kLeft, minor}, "stroke=\"#444\"");
            }
        }
        add("<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"#444\"/>", kLeft, kTop, kBottom,
            kRight);
        text(0.5 * (kLeft + kRight), kBottom + 46, "text-anchor=\"middle\"", "triangles");
        const double middle = 0.5 * (kTop + kBottom);
        text(26, middle,
             fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 26 {:.1f})\"", middle),
             "relative time");
    }

    void marker(const Curve& curve, Mark at) {
        const std::string place = fmt::format("transform=\"translate({:.1f} {:.1f})\" fill=\"{}\"",
                                              at.x, at.y, curve.color);
        constexpr std::array kShapes = {"<circle r=\"4\" {}/>", "<path d=\"M-4-4H4V4H-4Z\" {}/>",
                                        "<path d=\"M0-5L5 4H-5Z\" {}/>",
                                        "<path d=\"M0-5.5L5.5 0L0 5.5L-5.5 0Z\" {}/>"};
        add(fmt::runtime(kShapes[curve.number % kShapes.size()]), place);
    }

    void draw_curve(const Curve& curve) {
        std::string points;
        for (const Mark& mark : curve.marks) {
            points += fmt::format("{:.1f},{:.1f} ", mark.x, mark.y);
        }
        const std::string style = curve.historical
                                      ? fmt::format("stroke-width=\"1.5\" stroke-dasharray=\"{}\"",
                                                    kDashes[curve.number % kDashes.size()])
                                      : "stroke-width=\"2\"";
        add("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" {}/>", points, curve.color, style);
        if (!curve.historical) {
            for (const Mark& mark : curve.marks) marker(curve, mark);
        }
        const Mark end = curve.marks.back();
        const double start = end.x + 7;
        add("<polyline points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\" fill=\"none\" "
            "stroke=\"{}\" stroke-width=\"0.6\" opacity=\"0.6\"/>",
            start, end.y, std::max(start, kRight + 4), end.y, kLabelX - 4, curve.label_y,
            curve.color);
        // Dark words: a light colour is hard to read. The marker says whose they are.
        if (!curve.historical) marker(curve, {kLabelX + 4, curve.label_y});
        text(kLabelX + 14, curve.label_y + 4.5,
             curve.historical ? fmt::format("fill=\"{}\"", kHistoricalColor) : "", curve.name);
    }

    /// Returns the y of what comes below it.
    double draw_table() {
        const std::size_t columns = table_.scenes.size() + 1;
        const double step = (kWidth - 2 * kLeft - kNameWidth) / static_cast<double>(columns);
        const auto cell = [&](std::size_t column, double y, std::string_view attributes,
                              std::string_view words) {
            const double x = kLeft + kNameWidth + step * static_cast<double>(column + 1);
            text(x, y, fmt::format("text-anchor=\"end\" {}", attributes), words);
        };
        double y = kTableTop;
        constexpr std::string_view kBold = "font-weight=\"bold\"";
        text(kLeft, y, kBold, "triangles");
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            cell(i, y, kBold, grouped(table_.scenes[i].triangles));
        }
        cell(columns - 1, y, kBold, "growth");
        line({kLeft, y + 7}, {kWidth - kLeft, y + 7}, "stroke=\"#444\"");
        for (const TableRow& row : table_.rows) {
            y += kRowHeight;
            const std::string color =
                row.historical ? fmt::format("fill=\"{}\"", kHistoricalColor) : "";
            text(kLeft, y, color, row.name);
            for (std::size_t i = 0; i < row.ratios.size(); ++i) {
                cell(i, y, color, three_digits(row.ratios[i]));
            }
            cell(columns - 1, y, color, row.growth ? fmt::format("{:.2f}", *row.growth) : "-");
        }
        line({kLeft, y + 7}, {kWidth - kLeft, y + 7}, "stroke=\"#444\"");
        y += 8;
        for (const std::string& note : footnotes(table_)) {
            y += 18;
            text(kLeft, y, "font-size=\"12\" fill=\"#555\"", note);
        }
        return y;
    }

    const Table& table_;
    Decades x_, y_;
    std::string body_;
};

}  // namespace

std::string table_as_svg(const Table& table) { return Picture(table).draw(); }

}  // namespace sightline::cli
