// "Did you mean ...?" for mistyped commands, options, algorithms, names and values.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sightline::cli {

/// Number of single-letter insertions, deletions, replacements and exchanges of neighbours that
/// turn one word into the other (optimal string alignment). O(|a| |b|).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate closest to a mistyped word, or nothing when none is close.
[[nodiscard]] std::optional<std::string_view> closest(std::string_view word,
                                                      std::span<const std::string_view> candidates);

/// "did you mean 'X'?" when a candidate is close, `otherwise` when none is.
[[nodiscard]] std::string did_you_mean(std::string_view word,
                                       std::span<const std::string_view> candidates,
                                       std::string_view otherwise);

/// "a, b, c".
[[nodiscard]] std::string join(std::span<const std::string_view> words);

}  // namespace sightline::cli
