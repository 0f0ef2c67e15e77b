// Where the colours of a picture's rows come from when they are not those of one visible triangle
// a sample.
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>

#include "sightline/image.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// Colours of rows of pixels, made in groups of whole bands.
class ColorRows {
public:
    virtual ~ColorRows() = default;

    /// Rows of pixels of which resolve() takes a multiple.
    [[nodiscard]] virtual std::uint32_t unit() const = 0;

    /// Holds rows of pixels from now on, on all cores. Precondition: `first` is a multiple of
    /// unit(), and so is `count` unless the rows are the last ones.
    virtual void resolve(std::uint32_t first, std::uint32_t count,
                         const ResolveOptions& options) = 0;

    /// Row y of those held: linear, premultiplied.
    [[nodiscard]] virtual const glm::vec4* row(std::uint32_t y) const = 0;

    /// Whether a surface covers something of the rows that were held so far.
    [[nodiscard]] bool anything_seen() const { return anything_seen_; }

    /// Appends what was counted so far to the counters of the options.
    virtual void report() = 0;

protected:
    std::atomic<bool> anything_seen_{false};  // several threads note it
};

}  // namespace sightline
