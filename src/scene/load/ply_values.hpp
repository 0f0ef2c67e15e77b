// The values of a PLY file's elements one after another: as text, or binary of either byte order.
//
// Every function answers false, and reads nothing beyond the end, when the file ends too early or
// (text only) what stands there is no number. Binary values are never wrong.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include "scene/load/ply_header.hpp"
#include "scene/load/scan.hpp"

namespace sightline::load {

/// An integer stored as a real number; one that is out of reach becomes the smallest there is.
inline std::int64_t integer_of(double value) {
    return std::abs(value) < 1e18 ? static_cast<std::int64_t>(value)
                                  : std::numeric_limits<std::int64_t>::min();
}

class PlyText {
public:
    static constexpr bool kBinary = false;

    /// Precondition: empty, or ends with '\n'.
    explicit PlyText(std::string_view text) : p_(text.data()), end_(p_ + text.size()) {}

    [[nodiscard]] const char* position() const { return p_; }
    /// The body holds so many records. If it has as many lines at least, each stands in one.
    void expect_records(std::uint64_t records) {
        std::uint64_t lines = 0;
        for (const char* p = p_; p < end_; ++lines) {
            while (p < end_ && (is_blank(*p) || is_line_end(*p))) ++p;
            if (p == end_) break;
            p = skip_to_line_end(p);
        }
        by_lines_ = lines >= records;
    }
    void begin_record() {
        if (!by_lines_ || !skip_space()) return;
        record_ = p_;
        line_end_ = skip_to_line_end(p_);
    }
    /// Whether the record just read is all that stands in its line; if not, back to its start.
    [[nodiscard]] bool ends_record() {
        if (!by_lines_ || skip_blanks(p_) == line_end_) return true;
        p_ = record_;
        return false;
    }
    /// Moves on to the next value; false when there is none.
    bool skip_space() {
        while (p_ < end_ && (is_blank(*p_) || is_line_end(*p_))) ++p_;
        return p_ < end_;
    }
    /// Whether so many values can be left.
    [[nodiscard]] bool has_room(std::uint64_t values, PlyType) const {
        return values <= static_cast<std::uint64_t>(end_ - p_) / 2 + 1;
    }
    template <class Real>
    bool real(PlyType, Real& value) {
        return skip_space() && accept(scan_real(p_, value));
    }
    bool integer(PlyType, std::int64_t& value) {
        if (!skip_space()) return false;
        const char* const end = scan_integer(p_, value);
        if (accept(end)) return true;
        double number = 0;  // such as 3.0
        if (!accept(scan_real(p_, number))) return false;
        value = integer_of(number);
        return true;
    }
    /// Calls take(value) for each of `count` integers.
    template <class Take>
    bool integers(PlyType type, std::uint64_t count, const Take& take) {
        std::int64_t value = 0;
        for (; count > 0; --count) {
            if (!integer(type, value)) return false;
            take(value);
        }
        return true;
    }
    bool skip(PlyType, std::uint64_t count) {
        for (; count > 0; --count) {
            if (!skip_space()) return false;
            p_ = skip_word(p_);
        }
        return true;
    }

private:
    bool accept(const char* end) {
        if (end == nullptr || !(is_blank(*end) || is_line_end(*end))) return false;
        p_ = end;
        return true;
    }
    const char* p_;
    const char* end_;
    const char* record_ = nullptr;  ///< the one at hand
    const char* line_end_ = nullptr;
    bool by_lines_ = false;
};

/// `kSwap`: the file's byte order is not the machine's.
template <bool kSwap>
class PlyBinary {
public:
    static constexpr bool kBinary = true;

    explicit PlyBinary(std::string_view bytes) : p_(bytes.data()), end_(p_ + bytes.size()) {}

    [[nodiscard]] const char* position() const { return p_; }
    // See PlyText.
    static void expect_records(std::uint64_t) {}
    static void begin_record() {}
    [[nodiscard]] static bool ends_record() { return true; }
    [[nodiscard]] bool has_room(std::uint64_t values, PlyType type) const {
        return values <= static_cast<std::uint64_t>(end_ - p_) / size_of(type);
    }
    bool skip_bytes(std::uint64_t count) {
        if (count > static_cast<std::uint64_t>(end_ - p_)) return false;
        p_ += count;
        return true;
    }
    bool skip(PlyType type, std::uint64_t count) {
        return has_room(count, type) && skip_bytes(count * size_of(type));
    }
    template <class Real>
    bool real(PlyType type, Real& value) {
        if (!has_room(1, type)) return false;
        with_type(type, [&](auto stored) { value = static_cast<Real>(get<decltype(stored)>()); });
        return true;
    }
    bool integer(PlyType type, std::int64_t& value) {
        return integers(type, 1, [&](std::int64_t read) { value = read; });
    }
    template <class Take>
    bool integers(PlyType type, std::uint64_t count, const Take& take) {
        if (!has_room(count, type)) return false;
        with_type(type, [&](auto stored) {
            using T = decltype(stored);
            for (; count > 0; --count) {
                if constexpr (std::is_floating_point_v<T>) {
                    take(integer_of(get<T>()));
                } else {
                    take(static_cast<std::int64_t>(get<T>()));
                }
            }
        });
        return true;
    }

private:
    template <class T>
    T get() {
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), p_, sizeof(T));
        p_ += sizeof(T);
        if constexpr (kSwap) std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }
    template <class Body>
    static void with_type(PlyType type, const Body& body) {
        switch (type) {
            case PlyType::int8:
                return body(std::int8_t{});
            case PlyType::uint8:
                return body(std::uint8_t{});
            case PlyType::int16:
                return body(std::int16_t{});
            case PlyType::uint16:
                return body(std::uint16_t{});
            case PlyType::int32:
                return body(std::int32_t{});
            case PlyType::uint32:
                return body(std::uint32_t{});
            case PlyType::float32:
                return body(float{});
            case PlyType::float64:
                return body(double{});
        }
    }
    const char* p_;
    const char* end_;
};

}  // namespace sightline::load
