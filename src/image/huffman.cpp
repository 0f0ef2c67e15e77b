// D. A. Huffman, "A method for the construction of minimum-redundancy codes", 1952, with the two
// queues of J. van Leeuwen, "On the construction of Huffman trees", 1976: the leaves sorted by
// count, the inner nodes in the order in which they are made, so that no heap is needed.
//
// Lengths beyond the limit are cut, and the shortest words of the others grow until the code is
// complete again: not always the optimum that package-merge finds, but within a few bits of it.
#include "image/huffman.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace sightline {
namespace {

constexpr std::size_t kMostSymbols = 512;
constexpr std::size_t kDeepest = 64;  // counts sum to less than 2^32: Fibonacci's numbers bound it

struct Leaf {
    std::uint32_t count;
    std::uint16_t symbol;
};

/// How many words have each length: by building the tree over the leaves, in ascending order.
using LengthCounts = std::array<std::uint32_t, kDeepest>;

LengthCounts tree_depths(std::span<const Leaf> leaves) {
    const std::size_t n = leaves.size();
    std::array<std::uint32_t, 2 * kMostSymbols> weight{};  // leaves, then inner nodes
    std::array<std::uint16_t, 2 * kMostSymbols> parent{};
    for (std::size_t i = 0; i < n; ++i) weight[i] = leaves[i].count;
    std::size_t leaf = 0, inner = n;
    for (std::size_t made = n; made < 2 * n - 1; ++made) {
        for (int child = 0; child < 2; ++child) {
            const bool take_leaf = leaf < n && (inner == made || weight[leaf] <= weight[inner]);
            const std::size_t taken = take_leaf ? leaf++ : inner++;
            weight[made] += weight[taken];
            parent[taken] = static_cast<std::uint16_t>(made);
        }
    }
    std::array<std::uint8_t, 2 * kMostSymbols> depth{};
    LengthCounts lengths{};
    for (std::size_t i = 2 * n - 1; i-- > 0;) {
        if (i != 2 * n - 2) depth[i] = static_cast<std::uint8_t>(depth[parent[i]] + 1);
        if (i < n) ++lengths[depth[i]];
    }
    return lengths;
}

/// Makes all lengths at most `longest` and keeps the sum of 2^-length at 1.
void limit_lengths(LengthCounts& lengths, std::size_t longest) {
    std::uint64_t used = 0;  // in units of 2^-longest
    for (std::size_t length = kDeepest - 1; length > longest; --length) {
        lengths[longest] += lengths[length];
        lengths[length] = 0;
    }
    for (std::size_t length = 1; length <= longest; ++length) {
        used += std::uint64_t{lengths[length]} << (longest - length);
    }
    for (; used > std::uint64_t{1} << longest; --used) {
        // One of the longest words becomes the sibling of a shorter one, which grows by a bit.
        std::size_t length = longest - 1;
        while (lengths[length] == 0) --length;
        --lengths[length];
        lengths[length + 1] += 2;
        --lengths[longest];
    }
}

std::uint16_t reversed(std::uint32_t bits, int length) {
    std::uint32_t out = 0;
    for (int i = 0; i < length; ++i) out |= (bits >> i & 1u) << (length - 1 - i);
    return static_cast<std::uint16_t>(out);
}

/// The bits that go with the lengths (RFC 1951, section 3.2.2).
void assign_bits(std::span<CodeWord> words) {
    std::array<std::uint32_t, 17> next{}, count{};
    for (const CodeWord& word : words) ++count[word.length];
    count[0] = 0;
    for (std::size_t length = 1; length < next.size(); ++length) {
        next[length] = (next[length - 1] + count[length - 1]) << 1;
    }
    for (CodeWord& word : words) {
        if (word.length > 0) word.bits = reversed(next[word.length]++, word.length);
    }
}

}  // namespace

void make_huffman_code(std::span<const std::uint32_t> counts, int longest,
                       std::span<CodeWord> words) {
    assert(counts.size() == words.size() && counts.size() <= kMostSymbols);
    std::array<Leaf, kMostSymbols> storage;
    std::size_t n = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        words[i] = {};
        if (counts[i] > 0) storage[n++] = {counts[i], static_cast<std::uint16_t>(i)};
    }
    if (n == 0) return;
    const std::span<Leaf> leaves(storage.data(), n);
    std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
        return a.count != b.count ? a.count < b.count : a.symbol < b.symbol;
    });
    LengthCounts lengths{};
    if (n == 1) {
        lengths[1] = 1;
    } else {
        lengths = tree_depths(leaves);
        limit_lengths(lengths, static_cast<std::size_t>(longest));
    }
    auto leaf = leaves.rbegin();  // the most frequent symbols get the shortest words
    for (std::size_t length = 1; length <= static_cast<std::size_t>(longest); ++length) {
        for (std::uint32_t i = 0; i < lengths[length]; ++i, ++leaf) {
            words[leaf->symbol].length = static_cast<std::uint8_t>(length);
        }
    }
    assign_bits(words);
}

}  // namespace sightline
