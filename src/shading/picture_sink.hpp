// Files that get a picture row by row.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "shading/antialiased_rows.hpp"
#include "shading/picture_rows.hpp"
#include "sightline/shading.hpp"

namespace sightline {

/// What a sink makes its rows of.
struct SinkSource {
    PictureRows& rows;
    AntialiasedRows* deep = nullptr;  ///< of a deep file
    Resolution resolution;            ///< of the whole picture
    double near, far;                 ///< of a depth PNG
    int threads = 0;                  ///< 0 = all cores
    std::function<void(DrawStage)> on_stage;
};

/// A file under way. It appears under its name when finish() succeeds.
class PictureSink {
public:
    virtual ~PictureSink() = default;
    /// Appends the `count` rows that the source holds; the first of them is row `first` of the
    /// picture.
    virtual Status append(std::uint32_t first, std::uint32_t count) = 0;
    /// Precondition: all rows are appended.
    virtual Status finish() = 0;
};

/// The source must outlive the sink. Errors: as of the writer's create(); bad_option for content
/// that the format can't hold.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> open_sink(const PictureFile& file,
                                                             const SinkSource& source);

}  // namespace sightline
