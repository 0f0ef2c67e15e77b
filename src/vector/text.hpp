// Text for files of drawings: a buffer before a file, decimals, and names that may hold any bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "image/atomic_file.hpp"

namespace sightline {

/// Collects text and hands it to the file in large pieces. The first failure sticks to the file.
class TextSink {
public:
    /// Longest text of one number.
    static constexpr std::size_t kLongestNumber = 24;

    explicit TextSink(AtomicFile& file) : file_(&file), buffer_(kSize) {}

    void put(std::string_view text);
    void put(char c) {
        *room(1) = c;
        ++used_;
    }
    void put_integer(std::uint32_t n);
    /// n / 10^decimals, without zeros that say nothing: ".5", "-3", "0".
    void put_decimal(std::int64_t n, int decimals);
    /// The same with a blank before it, unless its sign parts it from what stands there.
    void put_next_decimal(std::int64_t n, int decimals) {
        if (n >= 0) put(' ');
        put_decimal(n, decimals);
    }
    void flush();

private:
    static constexpr std::size_t kSize = std::size_t{1} << 18;

    /// Where the next `count` <= kSize characters go.
    char* room(std::size_t count) {
        if (used_ + count > kSize) flush();
        return buffer_.data() + used_;
    }

    AtomicFile* file_;
    std::vector<char> buffer_;
    std::size_t used_ = 0;
};

/// Decimals of the page: a number of them, and lengths as multiples of the last one.
class DecimalGrid {
public:
    explicit DecimalGrid(int decimals);
    [[nodiscard]] int decimals() const { return decimals_; }
    /// The nearest multiple; what is beyond 10^14 of them is put there.
    [[nodiscard]] std::int64_t round(double length) const;

private:
    int decimals_;
    double factor_ = 1;
};

/// The same text in valid UTF-8 of characters that XML allows and that stay in one line: what is
/// neither becomes U+FFFD.
[[nodiscard]] std::string clean_utf8(std::string_view text);
/// clean_utf8() with & < > " escaped: fit for an attribute and for the text of an element.
[[nodiscard]] std::string xml_text(std::string_view text);

}  // namespace sightline
