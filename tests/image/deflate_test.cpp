// Deflate: pieces are inflated by zlib and compared; Huffman codes are complete and short.
#include "image/deflate.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "image/huffman.hpp"
#include "image/png_band.hpp"

namespace {

using namespace sightline;

/// Filtered rows with room behind them.
struct Rows {
    std::vector<std::uint8_t> bytes;
    std::size_t bytes_per_row, bytes_per_pixel;

    [[nodiscard]] FilteredRows view() const {
        return {{bytes.data(), bytes.size() - kReadPast}, bytes_per_row, bytes_per_pixel};
    }
};

template <class Next>
Rows rows_of(std::size_t count, std::size_t width, std::size_t bytes_per_pixel, const Next& next) {
    Rows rows{{}, width * bytes_per_pixel, bytes_per_pixel};
    rows.bytes.resize(count * (rows.bytes_per_row + 1));
    for (std::uint8_t& byte : rows.bytes) byte = static_cast<std::uint8_t>(next());
    rows.bytes.resize(rows.bytes.size() + kReadPast, 0xAB);
    return rows;
}

std::vector<std::uint8_t> inflated(std::vector<std::uint8_t> stream, std::size_t size) {
    stream.insert(stream.end(), kLastBlock.begin(), kLastBlock.end());
    std::vector<std::uint8_t> out(size + 1);
    z_stream z{};
    EXPECT_EQ(inflateInit2(&z, -15), Z_OK);
    z.next_in = stream.data();
    z.avail_in = static_cast<uInt>(stream.size());
    z.next_out = out.data();
    z.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END) << (z.msg != nullptr ? z.msg : "");
    EXPECT_EQ(z.avail_in, 0u);
    out.resize(z.total_out);
    inflateEnd(&z);
    return out;
}

/// Bytes of the stream.
std::size_t expect_round_trip(const Rows& rows) {
    const auto view = rows.view().bytes;
    Deflater deflater;
    std::vector<std::uint8_t> stream;
    deflater.append(rows.view(), stream);
    const std::size_t size = stream.size();
    deflater.append(rows.view(), stream);  // a second piece says nothing of the first
    EXPECT_EQ(stream.size(), 2 * size);
    std::vector<std::uint8_t> expected(view.begin(), view.end());
    expected.insert(expected.end(), view.begin(), view.end());
    EXPECT_EQ(inflated(stream, expected.size()), expected);
    return size;
}

TEST(Deflate, EveryKindOfRowSurvives) {
    std::mt19937 random(1);
    const auto draw = [&random](unsigned n) { return static_cast<unsigned>(random() % n); };
    for (const std::size_t pixel : {1u, 2u, 3u, 4u}) {
        for (const std::size_t width : {1u, 2u, 3u, 7u, 64u, 65u, 300u, 5'000u}) {
            for (const unsigned values : {1u, 2u, 3u, 17u, 256u}) {
                expect_round_trip(rows_of(3, width, pixel, [&] { return random() % values; }));
            }
            // Runs of all lengths, and rows that come back.
            unsigned left = 0, value = 0, at = 0;
            expect_round_trip(rows_of(9, width, pixel, [&] {
                if (left-- == 0) left = draw(900), value = draw(256);
                return value;
            }));
            expect_round_trip(rows_of(9, width, pixel, [&] { return ++at, at * at % 251; }));
        }
    }
}

TEST(Deflate, NoiseIsStoredAndBlankRowsVanish) {
    std::mt19937 random(2);
    const Rows noise = rows_of(50, 1'000, 4, [&] { return random(); });
    EXPECT_LE(expect_round_trip(noise), noise.bytes.size() + 64);
    const Rows blank = rows_of(50, 1'000, 4, [] { return 0; });
    EXPECT_LE(expect_round_trip(blank), blank.bytes.size() / 400);
}

TEST(Deflate, FarMatchesStayWithinTheWindow) {
    // A pixel that comes back after 2^15 bytes, one less, one more.
    for (const std::size_t width : {8'191u, 8'192u, 8'193u}) {
        std::uint32_t n = 0;
        Rows rows = rows_of(3, width, 4, [&] { return n++ * 2'654'435'761u >> 24; });
        std::memset(rows.bytes.data() + 1, 9, 4);
        std::memset(rows.bytes.data() + 1 + 32'768, 9, 4);
        expect_round_trip(rows);
    }
}

void expect_complete(const std::vector<std::uint32_t>& counts, int longest) {
    std::vector<CodeWord> words(counts.size());
    make_huffman_code(counts, longest, words);
    double kraft = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        EXPECT_EQ(words[i].length > 0, counts[i] > 0);
        EXPECT_LE(words[i].length, longest);
        if (counts[i] == 0) continue;
        ++used;
        kraft += std::ldexp(1.0, -words[i].length);
        for (std::size_t k = 0; k < counts.size(); ++k) {
            if (counts[k] > counts[i]) {
                EXPECT_LE(words[k].length, words[i].length);
            }
        }
    }
    EXPECT_EQ(kraft, used > 1 ? 1.0 : 0.5 * static_cast<double>(used));
}

TEST(Huffman, CodesAreCompleteAndOfLimitedLength) {
    expect_complete({0, 0, 0}, 15);
    expect_complete({0, 5, 0}, 15);
    expect_complete({1, 1}, 15);
    std::vector<std::uint32_t> fibonacci = {1, 1};  // the deepest tree there is
    while (fibonacci.size() < 40) fibonacci.push_back(fibonacci.end()[-1] + fibonacci.end()[-2]);
    expect_complete(fibonacci, 15);
    expect_complete({fibonacci.begin(), fibonacci.begin() + 19}, 7);
    std::mt19937 random(3);
    for (int i = 0; i < 200; ++i) {
        std::vector<std::uint32_t> counts(1 + random() % 286);
        for (std::uint32_t& count : counts)
            count = static_cast<std::uint32_t>(random()) >> random() % 32;
        for (std::uint32_t& count : counts) count >>= 9;  // their sum must stay below 2^32
        expect_complete(counts, 15);
    }
}

TEST(Huffman, KnownCode) {
    const std::vector<std::uint32_t> counts = {5, 1, 2, 9};
    std::vector<CodeWord> words(4);
    make_huffman_code(counts, 15, words);
    const int lengths[] = {2, 3, 3, 1};
    const int bits[] = {0b01, 0b011, 0b111, 0b0};  // 10, 110, 111, 0, the last bit first
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(words[i].length, lengths[i]);
        EXPECT_EQ(words[i].bits, bits[i]);
    }
}

TEST(Adler, EqualsZlibs) {
    std::mt19937 random(4);
    for (const std::size_t size : {0u, 1u, 7u, 8u, 65'535u, 65'536u, 300'001u}) {
        for (const unsigned zeros : {0u, 90u}) {
            std::vector<std::uint8_t> bytes(size);
            for (auto& byte : bytes) {
                byte = static_cast<std::uint8_t>(random() % 100 < zeros ? 0 : random() | 0xF0);
            }
            EXPECT_EQ(adler32_of(bytes), adler32(1, bytes.data(), static_cast<uInt>(size)));
        }
    }
}

}  // namespace
