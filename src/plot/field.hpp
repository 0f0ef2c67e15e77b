// Scalar fields as several threads use them.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include "sightline/sections.hpp"

namespace sightline {

/// Evaluators by thread.
class Evaluators {
public:
    explicit Evaluators(const Field& field) : local_(field.make) {}
    [[nodiscard]] Evaluator& local() { return local_.local(); }

private:
    tbb::enumerable_thread_specific<Evaluator> local_;
};

}  // namespace sightline
