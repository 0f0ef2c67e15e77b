// Suggestions by edit distance.
// Source: F. J. Damerau, "A technique for computer detection and correction of spelling errors",
// 1964, as the optimal string alignment distance (no letter is edited twice).
#include "suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace sightline::cli {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Three rows of the table: i - 2, i - 1 and i.
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

std::optional<std::string_view> closest(std::string_view word,
                                        std::span<const std::string_view> candidates) {
    std::optional<std::string_view> best;
    std::size_t best_distance = std::max<std::size_t>(word.size() / 3, 1) + 1;
    for (const std::string_view candidate : candidates) {
        if (candidate.empty()) continue;  // what has no name
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    if (best || word.size() < 3) return best;
    // A word cut short, or with the dashes forgotten.
    const auto contains = std::find_if(candidates.begin(), candidates.end(), [&](auto candidate) {
        return candidate.find(word) != std::string_view::npos;
    });
    return contains == candidates.end() ? best : *contains;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates,
                         std::string_view otherwise) {
    const auto best = closest(word, candidates);
    return best ? fmt::format("did you mean '{}'?", *best) : std::string(otherwise);
}

std::string join(std::span<const std::string_view> words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace sightline::cli
