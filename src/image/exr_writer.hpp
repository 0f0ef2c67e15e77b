// OpenEXR files, block of rows by block of rows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <string>

#include "sightline/error.hpp"
#include "sightline/image.hpp"

namespace sightline {

/// Which channels a file has; see ExrLayers.
struct ExrChannels {
    bool color = false, depth = false, normals = false, objects = false, triangles = false;
};

/// Some whole rows of the channels that the file has, row by row; the others are null.
struct ExrRows {
    const glm::vec4* color = nullptr;
    const float* depth = nullptr;
    const glm::vec3* normals = nullptr;
    const std::uint32_t* objects = nullptr;
    const std::uint32_t* triangles = nullptr;
};

/// Writes one scan-line EXR as its rows come, from the top. The file appears under its name when
/// finish() succeeds. The bytes depend on the pixels only.
class ExrWriter {
public:
    /// Errors: io for the file; bad_option for a picture without pixels or channels.
    [[nodiscard]] static Result<ExrWriter> create(const std::string& path, std::uint32_t width,
                                                  std::uint32_t height, ExrChannels channels,
                                                  const Placement& placement = {});
    ExrWriter(ExrWriter&&) noexcept;
    ExrWriter& operator=(ExrWriter&&) noexcept;
    ~ExrWriter();

    /// Appends `count` rows.
    Status write_rows(const ExrRows& rows, std::uint32_t count);
    /// Precondition: all rows are written.
    Status finish();

private:
    struct State;
    explicit ExrWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace sightline
