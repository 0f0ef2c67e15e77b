// Formulas, through muParser.
#include "sightline/formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <cmath>
#include <limits>
#include <utility>

#include "scene/load/text.hpp"

namespace sightline {
namespace {

Error wrong(std::string message) { return {ErrorKind::bad_option, std::move(message)}; }

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

/// What muParser says, with the place counted from 1; at the end of the text something is missing.
std::string complaint(const mu::ParserError& error, std::string_view text) {
    std::string what = error.GetMsg();
    for (const std::string_view tail : {" found at position", " at position"}) {
        const std::size_t at = what.find(tail);
        if (at != std::string::npos) what.resize(at);
    }
    while (!what.empty() && (what.back() == '.' || what.back() == ' ')) what.pop_back();
    what = load::shortened(what);
    if (error.GetCode() == mu::ecUNASSIGNABLE_TOKEN) {
        what = fmt::format("'{}' is unknown (variables are x, y and z)",
                           load::shortened(error.GetToken()));
    }
    return fmt::format("{}, at character {} of '{}'", what, error.GetPos() + 1,
                       load::shortened(text));
}

double floor_of(double x) { return std::floor(x); }
double ceil_of(double x) { return std::ceil(x); }
double mod_of(double x, double m) { return x - m * std::floor(x / m); }
double hypot_of(double x, double y) { return std::sqrt(x * x + y * y); }

}  // namespace

struct Expression::State {
    std::string text;
    mu::Parser parser;
    double x = 0, y = 0, z = 0;

    explicit State(std::string source) : text(std::move(source)) {
        parser.DefineVar("x", &x);
        parser.DefineVar("y", &y);
        parser.DefineVar("z", &z);
        parser.DefineConst("pi", 3.14159265358979323846);
        parser.DefineConst("e", 2.71828182845904523536);
        parser.DefineFun("floor", floor_of);
        parser.DefineFun("ceil", ceil_of);
        parser.DefineFun("mod", mod_of);
        parser.DefineFun("hypot", hypot_of);
        parser.SetExpr(text);
    }
};

Expression::Expression(std::unique_ptr<State> state) : state_(std::move(state)) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

/// The parser is bound to the variables of its own state, so a copy is parsed anew.
Expression::Expression(const Expression& other)
    : state_(std::make_unique<State>(other.state_->text)) {}

Expression& Expression::operator=(const Expression& other) {
    if (this != &other) state_ = std::make_unique<State>(other.state_->text);
    return *this;
}

Result<Expression> Expression::parse(std::string_view text) {
    try {
        auto state = std::make_unique<State>(std::string(text));
        state->parser.Eval();
        // A list of values is one to the parser, whose last value counts.
        if (state->parser.GetNumResults() != 1) {
            return wrong(fmt::format("'{}' has a comma between values; write decimals with a point",
                                     load::shortened(text)));
        }
        return Expression(std::move(state));
    } catch (const mu::ParserError& error) {
        return wrong(complaint(error, text));
    }
}

double Expression::operator()(glm::dvec3 at) {
    state_->x = at.x;
    state_->y = at.y;
    state_->z = at.z;
    try {
        return state_->parser.Eval();
    } catch (const mu::ParserError&) {  // an argument that a function refuses
        return std::numeric_limits<double>::quiet_NaN();
    }
}

bool Expression::uses(char variable) const {
    return state_->parser.GetUsedVar().contains(std::string(1, variable));
}

namespace {

/// Places of '=' that are no part of ==, <=, >= or !=.
std::vector<std::size_t> equals_signs(std::string_view text) {
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] != '=') continue;
        if (k + 1 < text.size() && text[k + 1] == '=') {
            ++k;
            continue;
        }
        if (k > 0 && (text[k - 1] == '<' || text[k - 1] == '>' || text[k - 1] == '!')) continue;
        out.push_back(k);
    }
    return out;
}

Result<Formula> function_of(std::string_view right, std::string_view text) {
    Result<Expression> value = Expression::parse(right);
    if (!value) return value.error();
    return Formula{Formula::Kind::function, std::move(*value), std::string(text)};
}

}  // namespace

Result<Formula> parse_formula(std::string_view text) {
    text = trimmed(text);
    if (text.empty()) return wrong("an empty formula; give one such as \"y = sin(x) * z\"");
    const std::vector<std::size_t> signs = equals_signs(text);
    if (signs.size() > 1) {
        return wrong(fmt::format("'{}' has {} equals signs; an equation has one",
                                 load::shortened(text), signs.size()));
    }
    if (signs.empty()) {
        Result<Formula> alone = function_of(text, text);
        if (alone && alone->value.uses('y')) {
            return wrong(
                fmt::format("'{0}' has y in it but no equals sign; write \"{0} = 0\" for a surface",
                            load::shortened(text)));
        }
        return alone;
    }
    const std::string_view left = trimmed(text.substr(0, signs[0])),
                           right = trimmed(text.substr(signs[0] + 1));
    for (const std::string_view side : {left, right}) {  // for errors that show one side
        const Result<Expression> checked = Expression::parse(side);
        if (!checked) return checked.error();
        if (side == right && left == "y" && !checked->uses('y')) return function_of(right, text);
        if (side == left && right == "y" && !checked->uses('y')) return function_of(left, text);
    }
    Result<Expression> difference = Expression::parse(fmt::format("({}) - ({})", left, right));
    if (!difference) return difference.error();
    if (!difference->uses('x') && !difference->uses('y') && !difference->uses('z')) {
        return wrong(fmt::format("'{}' has neither x, y nor z in it", load::shortened(text)));
    }
    return Formula{Formula::Kind::implicit, std::move(*difference), std::string(text)};
}

}  // namespace sightline
