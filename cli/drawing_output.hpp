// What commands that make drawings say of lines, paper and the file.
#pragma once

#include <span>
#include <string>

#include "options.hpp"
#include "outputs.hpp"
#include "sightline/vector.hpp"

namespace sightline::cli {

struct DrawingOutput {
    bool hidden = false, dashed = true;  ///< hidden lines are kept; and dashed, else solid
    double stroke = 1;
    glm::u8vec4 background{0, 0, 0, 0};
    bool sorted = false;
    PageOptions page;
    VectorOutput file;
};

extern const std::span<const Option> kDrawingOutputOptions;
extern const Option kHiddenOption;  ///< --hidden, for a group of its own

[[nodiscard]] DrawingOutput read_drawing_output(OptionReader& reader, Resolution resolution,
                                                const CommonOptions& common,
                                                std::span<const std::string> inputs);

/// Without names of objects, title and counts.
[[nodiscard]] VectorOptions vector_options(const DrawingOutput& output, const PageLayout& layout);

}  // namespace sightline::cli
