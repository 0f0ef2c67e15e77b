// J. Ziv, A. Lempel, "A universal algorithm for sequential data compression", 1977, in the format
// of P. Deutsch, RFC 1951, 1996: matches and literals of a band of rows in one block with Huffman
// codes of its own, then an empty stored block, which ends on a whole byte.
//
// We differ from zlib and libdeflate in that matches are looked for at pixels instead of at bytes,
// first at the neighbour on the left and then at the last place with the same hash, and never
// across rows. Filtered rows of rendered pictures are mostly repeats of one pixel, which are
// skipped at the speed of memory. docs/dependencies.md has the measurements.
#include "image/deflate.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "image/huffman.hpp"

namespace sightline {
namespace {

using Token = Deflater::Token;

constexpr std::size_t kLongestMatch = 258, kShortestMatch = 4;
constexpr std::size_t kWindow = 32'768;
constexpr std::size_t kEndOfBlock = 256;
constexpr std::size_t kLiteralCodes = 286, kDistanceCodes = 30;
constexpr int kHashBits = 13;
constexpr std::size_t kMostStored = 65'535;  // bytes in a stored block
constexpr std::uint32_t kNowhere = 0xFFFFFFFFu;

static_assert(std::endian::native == std::endian::little);

template <class T>
T load(const std::uint8_t* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

// -- matches --------------------------------------------------------------------------------------

/// How many bytes at a and b agree, up to `most`; reads up to 7 bytes past that.
std::size_t common_length(const std::uint8_t* a, const std::uint8_t* b, std::size_t most) {
    for (std::size_t n = 0; n < most; n += 8) {
        const std::uint64_t difference = load<std::uint64_t>(a + n) ^ load<std::uint64_t>(b + n);
        if (difference != 0) {
            return std::min(most, n + static_cast<std::size_t>(std::countr_zero(difference)) / 8);
        }
    }
    return most;
}

/// Cuts rows into tokens, row by row.
class Tokenizer {
public:
    Tokenizer(const FilteredRows& rows, std::vector<std::uint32_t>& last, std::vector<Token>& out)
        : begin_(rows.bytes.data()),
          unit_(rows.bytes_per_pixel),
          longest_(kLongestMatch - kLongestMatch % unit_),
          last_(last),
          out_(out) {}

    /// A row with its filter byte at offset `at`.
    void row(std::size_t at, std::size_t bytes_per_row) {
        literals_ = 1;
        const std::size_t end = at + 1 + bytes_per_row;
        for (std::size_t p = at + 1; p < end;) p += repeat_or_step(p, end);
        flush_literals();
    }

private:
    /// Takes what stands at p; how many bytes that is.
    std::size_t repeat_or_step(std::size_t p, std::size_t end) {
        std::size_t left = end - p;
        if (p >= unit_ + 1 && left >= kShortestMatch) {
            const std::size_t run = whole_pixels(p, p - unit_, left);
            if (run >= kShortestMatch) {
                add_run(run);
                return run;
            }
            const std::uint32_t key = load<std::uint32_t>(begin_ + p);
            std::uint32_t& slot = last_[(key * 0x9E3779B1u) >> (32 - kHashBits)];
            const std::size_t candidate = slot;
            slot = static_cast<std::uint32_t>(p);
            if (candidate != kNowhere && p - candidate <= kWindow &&
                load<std::uint32_t>(begin_ + candidate) == key) {
                const std::size_t length = whole_pixels(p, candidate, std::min(left, longest_));
                if (length >= kShortestMatch) {
                    add_match(length, p - candidate);
                    return length;
                }
            }
        }
        const std::size_t step = std::min(unit_, left);
        literals_ += step;
        return step;
    }

    [[nodiscard]] std::size_t whole_pixels(std::size_t p, std::size_t from,
                                           std::size_t most) const {
        const std::size_t n = common_length(begin_ + p, begin_ + from, most);
        return n - n % unit_;
    }

    void add_match(std::size_t length, std::size_t distance) {
        flush_literals();
        out_.push_back({static_cast<std::uint16_t>(length), static_cast<std::uint16_t>(distance)});
    }

    /// A pixel that repeats, so that a match may end within one; a rest that is too short for a
    /// match becomes literals.
    void add_run(std::size_t length) {
        for (; length >= kShortestMatch; length -= std::min(length, kLongestMatch)) {
            add_match(std::min(length, kLongestMatch), unit_);
        }
        literals_ += length;
    }

    void flush_literals() {
        constexpr std::size_t kMost = 65'535;
        for (; literals_ > 0; literals_ -= std::min(literals_, kMost)) {
            out_.push_back({static_cast<std::uint16_t>(std::min(literals_, kMost)), 0});
        }
    }

    const std::uint8_t* begin_;
    std::size_t unit_, longest_, literals_ = 0;
    std::vector<std::uint32_t>& last_;
    std::vector<Token>& out_;
};

// -- codes ----------------------------------------------------------------------------------------

/// A length or distance as deflate writes it: a symbol and some more bits.
struct Symbol {
    std::uint16_t code = 0;
    std::uint8_t extra_bits = 0;
    std::uint16_t extra = 0;
};

/// RFC 1951, section 3.2.5: four lengths, or two distances, share each number of extra bits.
Symbol split(std::uint32_t value, int codes_bits) {
    const std::uint32_t first = 2u << codes_bits;
    if (value < first) return {static_cast<std::uint16_t>(value), 0, 0};
    const int extra = static_cast<int>(std::bit_width(value)) - 1 - codes_bits;
    const std::uint32_t code = (static_cast<std::uint32_t>(extra) << codes_bits) + (value >> extra);
    return {static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(extra),
            static_cast<std::uint16_t>(value & ((1u << extra) - 1))};
}

Symbol distance_symbol(std::uint32_t distance) { return split(distance - 1, 1); }

Symbol make_length_symbol(std::uint32_t length) {
    if (length == kLongestMatch) return {285, 0, 0};
    Symbol symbol = split(length - 3, 2);
    symbol.code = static_cast<std::uint16_t>(symbol.code + 257);
    return symbol;
}

const Symbol& length_symbol(std::uint32_t length) {
    static const auto kSymbols = [] {
        std::array<Symbol, kLongestMatch + 1> all{};
        for (std::uint32_t n = 3; n <= kLongestMatch; ++n) all[n] = make_length_symbol(n);
        return all;
    }();
    return kSymbols[length];
}

struct Counts {
    std::array<std::uint32_t, kLiteralCodes> literals{};
    std::array<std::uint32_t, kDistanceCodes> distances{};
    std::uint64_t extra_bits = 0;
};

Counts count(std::span<const Token> tokens, const std::uint8_t* bytes) {
    Counts counts;
    for (const Token& token : tokens) {
        if (token.distance == 0) {
            for (std::size_t i = 0; i < token.length; ++i) ++counts.literals[bytes[i]];
        } else {
            const Symbol& length = length_symbol(token.length);
            const Symbol distance = distance_symbol(token.distance);
            ++counts.literals[length.code];
            ++counts.distances[distance.code];
            counts.extra_bits += length.extra_bits + distance.extra_bits;
        }
        bytes += token.length;
    }
    counts.literals[kEndOfBlock] = 1;
    return counts;
}

struct Codes {
    std::array<CodeWord, kLiteralCodes> literals;
    std::array<CodeWord, kDistanceCodes> distances;
};

std::uint64_t size_in_bits(std::span<const std::uint32_t> counts, std::span<const CodeWord> words) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i)
        sum += std::uint64_t{counts[i]} * words[i].length;
    return sum;
}

// -- bits -----------------------------------------------------------------------------------------

/// Appends bits, the lowest first, to memory that has room for them and 8 bytes more.
class BitWriter {
public:
    explicit BitWriter(std::uint8_t* out) : out_(out) {}

    /// At most 56 bits.
    void put(std::uint64_t bits, int n) {
        buffer_ |= bits << filled_;
        filled_ += n;
        std::memcpy(out_, &buffer_, sizeof buffer_);
        out_ += filled_ >> 3;
        buffer_ >>= filled_ & 56;
        filled_ &= 7;
    }
    void put(CodeWord word) { put(word.bits, word.length); }
    void fill_byte() { put(0, (8 - filled_) & 7); }
    [[nodiscard]] std::uint8_t* end() const { return out_; }

private:
    std::uint8_t* out_;
    std::uint64_t buffer_ = 0;
    int filled_ = 0;
};

// -- the description of the codes -----------------------------------------------------------------

/// RFC 1951, section 3.2.7: the lengths of the words, themselves run-length and Huffman coded.
struct Description {
    struct Item {
        std::uint8_t symbol, extra_bits, extra;
    };
    static constexpr std::size_t kSymbols = 19;
    static constexpr std::array<std::uint8_t, kSymbols> kOrder = {
        16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};

    explicit Description(const Codes& codes) {
        literal_words = used(codes.literals, 257);
        distance_words = used(codes.distances, 1);
        std::vector<std::uint8_t> lengths;
        for (std::size_t i = 0; i < literal_words; ++i) lengths.push_back(codes.literals[i].length);
        for (std::size_t i = 0; i < distance_words; ++i) {
            lengths.push_back(codes.distances[i].length);
        }
        for (std::size_t i = 0; i < lengths.size();) i += add_run(lengths, i);
        std::array<std::uint32_t, kSymbols> counts{};
        for (const Item& item : items) ++counts[item.symbol];
        make_huffman_code(counts, 7, words);
        while (order_words > 4 && words[kOrder[order_words - 1]].length == 0) --order_words;
    }

    void write(BitWriter& out) const {
        out.put(literal_words - 257, 5);
        out.put(distance_words - 1, 5);
        out.put(order_words - 4, 4);
        for (std::size_t i = 0; i < order_words; ++i) out.put(words[kOrder[i]].length, 3);
        for (const Item& item : items) {
            out.put(words[item.symbol]);
            out.put(item.extra, item.extra_bits);
        }
    }

    std::size_t literal_words, distance_words, order_words = kSymbols;
    std::vector<Item> items;
    std::array<CodeWord, kSymbols> words;

private:
    static std::size_t used(std::span<const CodeWord> all, std::size_t least) {
        std::size_t n = all.size();
        while (n > least && all[n - 1].length == 0) --n;
        return n;
    }

    /// Describes the equal lengths from i on; how many that is.
    std::size_t add_run(std::span<const std::uint8_t> lengths, std::size_t i) {
        const std::uint8_t length = lengths[i];
        std::size_t run = 1;
        while (i + run < lengths.size() && lengths[i + run] == length) ++run;
        if (length == 0 && run >= 11) {
            run = std::min<std::size_t>(run, 138);
            items.push_back({18, 7, static_cast<std::uint8_t>(run - 11)});
        } else if (length == 0 && run >= 3) {
            items.push_back({17, 3, static_cast<std::uint8_t>(run - 3)});
        } else if (length != 0 && run >= 4) {
            run = std::min<std::size_t>(run, 7);
            items.push_back({length, 0, 0});
            items.push_back({16, 2, static_cast<std::uint8_t>(run - 4)});
        } else {
            run = 1;
            items.push_back({length, 0, 0});
        }
        return run;
    }
};

constexpr std::size_t kLongestDescription = 400;  // 14 + 19 * 3 + 316 * 7 bits and some

// -- blocks ---------------------------------------------------------------------------------------

void put_tokens(std::span<const Token> tokens, const std::uint8_t* bytes, const Codes& codes,
                BitWriter& out) {
    for (const Token& token : tokens) {
        if (token.distance == 0) {
            for (std::size_t i = 0; i < token.length; ++i) out.put(codes.literals[bytes[i]]);
        } else {
            const Symbol& length = length_symbol(token.length);
            const Symbol distance = distance_symbol(token.distance);
            const CodeWord first = codes.literals[length.code];
            const CodeWord second = codes.distances[distance.code];
            out.put(first.bits | std::uint32_t{length.extra} << first.length,
                    first.length + length.extra_bits);
            out.put(second.bits | std::uint32_t{distance.extra} << second.length,
                    second.length + distance.extra_bits);
        }
        bytes += token.length;
    }
    out.put(codes.literals[kEndOfBlock]);
}

void append_stored(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out) {
    do {
        const std::size_t n = std::min(bytes.size(), kMostStored);
        const auto low = static_cast<std::uint8_t>(n & 255),
                   high = static_cast<std::uint8_t>(n >> 8);
        out.insert(out.end(), {0, low, high, static_cast<std::uint8_t>(~low),
                               static_cast<std::uint8_t>(~high)});
        out.insert(out.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
        bytes = bytes.subspan(n);
    } while (!bytes.empty());
}

}  // namespace

void Deflater::append(const FilteredRows& rows, std::vector<std::uint8_t>& out) {
    assert(rows.bytes.size() % (rows.bytes_per_row + 1) == 0);
    tokens_.clear();
    last_.assign(std::size_t{1} << kHashBits, kNowhere);
    Tokenizer tokenizer(rows, last_, tokens_);
    for (std::size_t at = 0; at < rows.bytes.size(); at += rows.bytes_per_row + 1) {
        tokenizer.row(at, rows.bytes_per_row);
    }
    const Counts counts = count(tokens_, rows.bytes.data());
    Codes codes;
    make_huffman_code(counts.literals, 15, codes.literals);
    make_huffman_code(counts.distances, 15, codes.distances);
    const std::uint64_t bits = size_in_bits(counts.literals, codes.literals) +
                               size_in_bits(counts.distances, codes.distances) + counts.extra_bits;
    if (bits / 8 >= rows.bytes.size()) return append_stored(rows.bytes, out);

    const std::size_t before = out.size();
    out.resize(before + bits / 8 + kLongestDescription);
    BitWriter writer(out.data() + before);
    writer.put(0b100, 3);  // not the last block; codes of its own
    Description(codes).write(writer);
    put_tokens(tokens_, rows.bytes.data(), codes, writer);
    writer.put(0b000, 3);  // an empty stored block
    writer.fill_byte();
    writer.put(0xFFFF'0000u, 32);
    out.resize(static_cast<std::size_t>(writer.end() - out.data()));
}

}  // namespace sightline
