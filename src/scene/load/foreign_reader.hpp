// Foreign formats: read by assimp in a child process, and what comes back is not believed.
#pragma once

#include "scene/load/assimp_reader.hpp"
#include "scene/load/soup.hpp"
#include "sightline/error.hpp"
#include "sightline/load.hpp"

namespace sightline::load {

/// Reads a model of a format that assimp knows. Errors: see run_contained(); bad_input also when
/// the file can't be read, or when a second reading gives something else.
[[nodiscard]] Result<Soup> read_foreign(const Source& source, const LoadOptions& options);

}  // namespace sightline::load
