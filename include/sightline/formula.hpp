// Formulas that people type: functions y = f(x, z) and equations in x, y and z.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "sightline/error.hpp"

namespace sightline {

/// A function of x, y and z, parsed once. Copies are independent of each other; one of them must
/// not be evaluated by two threads at a time, so each thread makes its own.
///
/// It knows + - * / ^, comparisons, && and ||, a ? b : c, the constants pi and e, and the functions
/// sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp ln log (natural) log2
/// log10 sqrt abs sign rint floor ceil mod hypot min max sum avg.
class Expression {
public:
    /// Errors (bad_option): what is wrong and where, for people who see the text.
    [[nodiscard]] static Result<Expression> parse(std::string_view text);

    Expression(const Expression& other);
    Expression& operator=(const Expression& other);
    Expression(Expression&&) noexcept;
    Expression& operator=(Expression&&) noexcept;
    ~Expression();

    /// The value there; NaN or infinite where there is none. About 0.1 microseconds.
    [[nodiscard]] double operator()(glm::dvec3 at);
    /// Whether a variable ('x', 'y' or 'z') occurs.
    [[nodiscard]] bool uses(char variable) const;

private:
    struct State;
    explicit Expression(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// What a text says: a surface.
struct Formula {
    enum class Kind {
        function,  ///< y = value(x, z)
        implicit,  ///< value(x, y, z) = 0
    };
    Kind kind;
    Expression value;
    std::string text;  ///< as it was typed
};

/// "y = f(x, z)", or f(x, z) alone: a function. Any other equation in x, y and z: an implicit
/// surface, left side minus right side. Errors (bad_option): as Expression::parse(); more than one
/// '='; an expression without '=' in which y occurs.
[[nodiscard]] Result<Formula> parse_formula(std::string_view text);

}  // namespace sightline
