#include "scene/load/obj_chunk.hpp"

#include <fmt/format.h>

#include <array>

#include "scene/load/scan.hpp"
#include "scene/load/text.hpp"
#include "sightline/scene.hpp"

namespace sightline::load {
namespace {

constexpr std::int64_t kLargestIndex = 0x7fffffff;

class ChunkParser {
public:
    ChunkParser(std::string_view text, const ObjCounts* counts)
        : p_(text.data()), end_(text.data() + text.size()), counts_(counts) {
        // Typical lines; what is too much is never touched.
        chunk_.positions.reserve(text.size() / 64);
        chunk_.polygon_sizes.reserve(text.size() / 40);
        chunk_.corners.values.reserve(text.size() / 12);
    }

    ObjChunk parse() {
        while (p_ < end_ && !chunk_.fault) {
            skip();
            parse_line();
            p_ = skip_to_line_end(p_) + 1;
        }
        return std::move(chunk_);
    }

private:
    /// Skips blanks, and line ends after a backslash.
    void skip() {
        while (true) {
            p_ = skip_blanks(p_);
            if (*p_ != '\\') return;
            const char* q = p_ + 1;
            if (*q == '\r') ++q;
            if (*q != '\n') return;
            p_ = q + 1 < end_ ? q + 1 : q;
        }
    }
    [[nodiscard]] bool at_end_of_line() const { return is_line_end(*p_) || *p_ == '#'; }
    /// Whether the word of this length at p_ ends there.
    [[nodiscard]] bool word_ends(std::size_t length) const {
        const char c = p_[length];
        return is_blank(c) || is_line_end(c) || c == '\\';
    }
    void fail(std::string what) { chunk_.fault = ObjFault{p_, std::move(what)}; }
    [[nodiscard]] std::string word() const {
        return one_line({p_, static_cast<std::size_t>(skip_word(p_) - p_)});
    }

    void parse_line();
    void parse_normal();
    void parse_position();
    void parse_face();
    void add_event(ObjEvent::Kind kind, std::size_t keyword);
    template <class Real>
    std::size_t parse_numbers(std::array<Real, 7>& numbers);
    bool parse_reference(bool& has_normal);
    bool add_vertex(std::int64_t index);
    static void add_index(ObjIndices& indices, std::int64_t index, std::size_t here);
    [[nodiscard]] std::uint64_t count_words();

    const char* p_;
    const char* end_;
    const ObjCounts* counts_;
    ObjChunk chunk_;
};

void ChunkParser::parse_line() {
    using enum ObjEvent::Kind;
    switch (*p_) {
        case 'v':
            if (word_ends(1)) {
                parse_position();
            } else if (p_[1] == 'n' && word_ends(2)) {
                parse_normal();
            }
            return;
        case 'f':
            if (word_ends(1)) parse_face();
            return;
        case 'l':
        case 'p': {
            if (!word_ends(1)) return;
            const bool line = *p_ == 'l';
            const std::uint64_t words = count_words();
            chunk_.ignored += words - (line && words > 0 ? 1 : 0);
            return;
        }
        case 'o':
        case 'g':
            if (word_ends(1)) add_event(*p_ == 'o' ? object : group, 1);
            return;
        case 'u':
            if (starts_with_word(p_, "usemtl")) add_event(use_material, 6);
            return;
        case 'm':
            if (starts_with_word(p_, "mtllib")) add_event(material_file, 6);
            return;
        default:
            return;
    }
}

void ChunkParser::add_event(ObjEvent::Kind kind, std::size_t keyword) {
    chunk_.events.push_back({kind, chunk_.polygon_sizes.size(), rest_of_line(p_ + keyword)});
}

std::uint64_t ChunkParser::count_words() {
    std::uint64_t words = 0;
    ++p_;
    for (skip(); !at_end_of_line(); skip()) {
        p_ = skip_word(p_);
        ++words;
    }
    return words;
}

/// The line's numbers after the keyword; how many (those beyond the seventh are not kept).
template <class Real>
std::size_t ChunkParser::parse_numbers(std::array<Real, 7>& numbers) {
    std::size_t count = 0;
    for (skip(); !at_end_of_line(); skip()) {
        Real number = 0;
        const char* const end = scan_real(p_, number);
        if (end == nullptr || !(is_blank(*end) || is_line_end(*end) || *end == '\\')) {
            fail(fmt::format("'{}' is not a number", word()));
            return 0;
        }
        p_ = end;
        if (count < numbers.size()) numbers[count++] = number;
    }
    return count;
}

void ChunkParser::parse_position() {
    std::array<double, 7> n{};
    const char* const line = p_++;
    const std::size_t count = parse_numbers(n);
    if (chunk_.fault) return;
    if (count < 3) {
        p_ = line;
        return fail(fmt::format("a vertex of {} numbers, where 3 are needed", count));
    }
    if (count == 4 && n[3] != 1) {  // the weight of homogeneous coordinates
        for (std::size_t i = 0; i < 3; ++i) n[i] /= n[3];
    }
    // Vertices without a colour are white where others have one.
    if (count >= 6) chunk_.colors.resize(chunk_.positions.size(), glm::vec4(1));
    chunk_.positions.emplace_back(n[0], n[1], n[2]);
    if (count >= 6) {
        chunk_.colors.emplace_back(n[3], n[4], n[5], 1.0f);
    } else if (!chunk_.colors.empty()) {
        chunk_.colors.emplace_back(1.0f);
    }
}

void ChunkParser::parse_normal() {
    std::array<float, 7> n{};
    const char* const line = p_;
    p_ += 2;
    const std::size_t count = parse_numbers(n);
    if (chunk_.fault) return;
    if (count < 3) {
        p_ = line;
        return fail(fmt::format("a normal of {} numbers, where 3 are needed", count));
    }
    chunk_.normals.emplace_back(n[0], n[1], n[2]);
}

/// Appends an index, where `here` vertices or normals of this chunk stand before it.
void ChunkParser::add_index(ObjIndices& indices, std::int64_t index, std::size_t here) {
    if (index > kLargestIndex || index < -kLargestIndex || index == 0) {
        indices.values.push_back(kObjOutOfRange);
    } else if (index > 0) {
        indices.values.push_back(static_cast<std::uint32_t>(index - 1));
    } else {
        indices.relative.push_back(indices.values.size());
        indices.values.push_back(
            static_cast<std::uint32_t>(static_cast<std::int64_t>(here) + index));
    }
}

/// Appends the vertex of a corner; false and a fault when it is certainly wrong.
bool ChunkParser::add_vertex(std::int64_t index) {
    if (index == 0) {
        fail("face refers to vertex 0, but they are counted from 1");
        return false;
    }
    if (counts_ != nullptr) {
        const std::size_t before = counts_->positions_before + chunk_.positions.size();
        const std::size_t all = counts_->positions;
        if (index > 0 ? static_cast<std::uint64_t>(index) > all
                      : static_cast<std::uint64_t>(-index) > before) {
            fail(fmt::format("face refers to vertex {}, but there are {}{}", index,
                             index > 0 ? all : before, index > 0 ? "" : " before it"));
            return false;
        }
    }
    add_index(chunk_.corners, index, chunk_.positions.size());
    return true;
}

/// A corner: v, v/vt, v//vn or v/vt/vn.
bool ChunkParser::parse_reference(bool& has_normal) {
    std::int64_t vertex = 0, texture = 0, normal = 0;
    const char* p = scan_integer(p_, vertex);
    if (p != nullptr && *p == '/') {
        const char* const after = scan_integer(++p, texture);
        if (after != nullptr) p = after;
        if (*p == '/') {
            const char* const last = scan_integer(++p, normal);
            has_normal = last != nullptr;
            if (has_normal) p = last;
        }
    }
    if (p == nullptr || !(is_blank(*p) || is_line_end(*p) || *p == '#' || *p == '\\')) {
        fail(fmt::format("'{}' is not a corner of a face", word()));
        return false;
    }
    if (!add_vertex(vertex)) return false;
    if (has_normal) {
        chunk_.normal_corners.values.resize(chunk_.corners.values.size() - 1, kNone);
        add_index(chunk_.normal_corners, normal, chunk_.normals.size());
    } else if (!chunk_.normal_corners.values.empty()) {
        chunk_.normal_corners.values.push_back(kNone);
    }
    p_ = p;
    return true;
}

void ChunkParser::parse_face() {
    ++p_;
    const std::size_t before = chunk_.corners.values.size();
    for (skip(); !at_end_of_line(); skip()) {
        bool has_normal = false;
        if (!parse_reference(has_normal)) return;
    }
    const std::size_t size = chunk_.corners.values.size() - before;
    if (size >= 3) {
        chunk_.polygon_sizes.push_back(static_cast<std::uint32_t>(size));
        return;
    }
    ++chunk_.ignored;
    const auto drop = [&](ObjIndices& indices) {
        if (indices.values.size() > before) indices.values.resize(before);
        while (!indices.relative.empty() && indices.relative.back() >= before) {
            indices.relative.pop_back();
        }
    };
    drop(chunk_.corners);
    drop(chunk_.normal_corners);
}

}  // namespace

ObjChunk parse_obj_chunk(std::string_view text, const ObjCounts* counts) {
    return ChunkParser(text, counts).parse();
}

}  // namespace sightline::load
