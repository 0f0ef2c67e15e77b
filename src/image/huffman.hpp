// Huffman codes as deflate wants them: canonical, of limited length.
#pragma once

#include <cstdint>
#include <span>

namespace sightline {

/// A code word as it is written: its bits from the lowest, and how many there are (0: not used).
struct CodeWord {
    std::uint16_t bits = 0;
    std::uint8_t length = 0;
};

/// Code words for the symbols that occur, of at most `longest` bits each; optimal unless that limit
/// binds. The same counts give the same code. Precondition: as many words as counts, at most 2^9
/// and at most 2^longest, and the sum of the counts below 2^32. O(n log n).
void make_huffman_code(std::span<const std::uint32_t> counts, int longest,
                       std::span<CodeWord> words);

}  // namespace sightline
