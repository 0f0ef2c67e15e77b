// Scalar fields: what a surface F(x, y, z) = 0 is made of.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <utility>

#include "sightline/formula.hpp"

namespace sightline {

/// The value at a point; NaN or infinite where there is none.
using Evaluator = std::function<double(glm::dvec3)>;

/// A function of space that several threads evaluate. Evaluators of one field always agree.
struct Field {
    std::function<Evaluator()> make;  ///< one for each thread; may be called by any of them
    std::string name;                 ///< for messages
};

/// The field of an expression.
[[nodiscard]] inline Field field_of(const Expression& expression, std::string name) {
    return {[expression]() -> Evaluator {
                return [own = expression](glm::dvec3 at) mutable { return own(at); };
            },
            std::move(name)};
}

/// Evaluators by thread.
class Evaluators {
public:
    explicit Evaluators(const Field& field) : local_(field.make) {}
    [[nodiscard]] Evaluator& local() { return local_.local(); }

private:
    tbb::enumerable_thread_specific<Evaluator> local_;
};

}  // namespace sightline
