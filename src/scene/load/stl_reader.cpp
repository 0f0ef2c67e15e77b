// Both kinds are read in pieces side by side: binary files by facets, ascii files cut before lines
// that begin with "facet", each piece on its own.
#include "scene/load/stl_reader.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/load/scan.hpp"
#include "scene/load/sniff.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is copied as it is");

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50, kFacetFloatBytes = 48;
constexpr std::size_t kChunkBytes = std::size_t{1} << 18;
constexpr std::size_t kMostFacets = 0xFFFFFFFEu / 3;  // their corners are counted with 32 bits

struct Solid {
    std::size_t polygon;    ///< number of polygons before it
    std::string_view name;  ///< in the text
};

struct Fault {
    const char* where;
    std::string what;
};

/// A piece of an ascii file. Polygons have vertices of their own and one normal each.
struct Chunk {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<std::uint32_t> polygon_sizes;
    std::vector<Solid> solids;
    std::uint64_t ignored = 0;
    std::uint64_t false_normals = 0;  ///< see contradicts()
    std::optional<Fault> fault;
};

/// Whether a facet's normal is more than 45 degrees off the facet, whose corners are these. Nothing
/// is said of facets so narrow that the rounding of coordinates may have turned them.
bool contradicts(const glm::dvec3& normal, std::span<const glm::dvec3> corners) {
    constexpr double kRounding = 1e-5, kCosineSquared = 0.5;
    glm::dvec3 area(0);
    double longest = 0, largest = 0;
    for (std::size_t k = 1; k < corners.size(); ++k) {
        const glm::dvec3 side = corners[k] - corners[0];
        if (k > 1) area += glm::cross(corners[k - 1] - corners[0], side);
        longest = std::max(longest, glm::dot(side, side));
        largest = std::max(largest, glm::dot(corners[k], corners[k]));
    }
    const double size = glm::dot(area, area);
    if (!(size > kRounding * kRounding * longest * largest)) return false;
    const double length = glm::dot(normal, normal), along = glm::dot(normal, area);
    return length > 0 && (along < 0 || along * along < kCosineSquared * length * size);
}

/// Judges the facet normals of a file of which so many contradict their facets, and are none
/// already: if these are more than one in a hundred, the others mean nothing either.
void drop_false_normals(Soup& soup, std::uint64_t contradicting) {
    constexpr std::uint64_t kMostParts = 100;
    if (contradicting == 0) return;
    std::uint64_t facets = 0;
    for (const SoupMesh& mesh : soup.meshes) facets += mesh.polygon_sizes.size();
    const bool all = contradicting * kMostParts > facets;
    if (all) {
        for (SoupMesh& mesh : soup.meshes) mesh.normals = {}, mesh.has_polygon_normals = false;
    }
    soup.notes.push_back(fmt::format("{} of {} facet normals contradict their facets; {} not used",
                                     contradicting, facets, all ? "all are" : "these are"));
}

class ChunkParser {
public:
    explicit ChunkParser(std::string_view text)
        : p_(text.data()), end_(text.data() + text.size()) {}

    Chunk parse() {
        for (skip(); p_ < end_ && !chunk_.fault; skip()) parse_statement();
        if (facet_ && !chunk_.fault) fail("a facet that does not end");
        return std::move(chunk_);
    }

private:
    void skip() {
        while (p_ < end_ && (is_blank(*p_) || is_line_end(*p_))) ++p_;
    }
    void fail(const char* what) { chunk_.fault = Fault{facet_ ? facet_start_ : p_, what}; }
    /// Three numbers; false when they are not there.
    template <class Vector>
    bool scan(Vector& numbers) {
        for (int axis = 0; axis < 3; ++axis) {
            skip();
            const char* const end = p_ < end_ ? scan_real(p_, numbers[axis]) : nullptr;
            if (end == nullptr || !(is_blank(*end) || is_line_end(*end))) return false;
            p_ = end;
        }
        return true;
    }
    void parse_statement();
    void begin_facet();
    void end_facet();

    const char* p_;
    const char* end_;
    Chunk chunk_;
    bool facet_ = false;
    const char* facet_start_ = nullptr;
    std::size_t facet_corners_ = 0;
};

void ChunkParser::parse_statement() {
    if (starts_with_word(p_, "vertex")) {
        if (!facet_) return fail("a vertex outside a facet");
        p_ += 6;
        glm::dvec3 position;
        if (!scan(position)) return fail("a facet with a vertex that is not three numbers");
        chunk_.positions.push_back(position);
        ++facet_corners_;
    } else if (starts_with_word(p_, "facet")) {
        begin_facet();
    } else if (starts_with_word(p_, "endfacet")) {
        end_facet();
        p_ += 8;
    } else if (starts_with_word(p_, "solid")) {
        if (facet_) return fail("a facet that does not end");
        chunk_.solids.push_back({chunk_.polygon_sizes.size(), rest_of_line(p_ + 5)});
        p_ = skip_to_line_end(p_);
    } else if (starts_with_word(p_, "endsolid")) {
        p_ = skip_to_line_end(p_);
    } else {
        p_ = skip_word(p_);  // outer loop, endloop, and what nobody knows
    }
}

void ChunkParser::begin_facet() {
    if (facet_) return fail("a facet that does not end");
    facet_ = true;
    facet_start_ = p_;
    facet_corners_ = 0;
    p_ += 5;
    glm::vec3 normal(0);
    skip();
    if (p_ < end_ && starts_with_word(p_, "normal")) {
        p_ += 6;
        if (!scan(normal)) return fail("a facet with a normal that is not three numbers");
    }
    chunk_.normals.push_back(normal);
}

void ChunkParser::end_facet() {
    if (!facet_) return fail("an endfacet without a facet");
    facet_ = false;
    if (facet_corners_ >= 3) {
        const auto corners = std::span(chunk_.positions).last(facet_corners_);
        if (contradicts(chunk_.normals.back(), corners)) {
            chunk_.normals.back() = glm::vec3(0);
            ++chunk_.false_normals;
        }
        chunk_.polygon_sizes.push_back(static_cast<std::uint32_t>(facet_corners_));
        return;
    }
    ++chunk_.ignored;
    chunk_.normals.pop_back();
    chunk_.positions.resize(chunk_.positions.size() - facet_corners_);
}

/// Cuts before lines that begin with "facet".
std::vector<std::string_view> cut(std::string_view text) {
    std::vector<std::string_view> pieces;
    const char* const last = text.data() + text.size();
    while (!text.empty()) {
        const char* p = text.data() + std::min(kChunkBytes, text.size());
        while (p < last) {
            p = skip_to_line_end(p) + 1;
            if (p < last && starts_with_word(skip_blanks(p), "facet")) break;
        }
        const auto size = static_cast<std::size_t>(p - text.data());
        pieces.push_back(text.substr(0, size));
        text.remove_prefix(size);
    }
    return pieces;
}

/// Appends polygons first .. end - 1 of a chunk, whose positions begin at `position`.
void append(const Chunk& chunk, std::size_t first, std::size_t end, std::size_t& position,
            SoupMesh& mesh) {
    for (std::size_t polygon = first; polygon < end; ++polygon) {
        const std::uint32_t size = chunk.polygon_sizes[polygon];
        mesh.polygon_sizes.push_back(size);
        mesh.has_polygon_normals = true;
        mesh.normals.push_back(chunk.normals[polygon]);
        for (std::uint32_t k = 0; k < size; ++k) {
            mesh.corners.push_back(static_cast<std::uint32_t>(mesh.precise_positions.size()));
            mesh.precise_positions.push_back(chunk.positions[position++]);
        }
    }
}

void append_object(Soup& soup, SoupMesh& mesh) {
    if (mesh.polygon_sizes.empty()) return;
    const auto number = static_cast<std::uint32_t>(soup.meshes.size());
    soup.objects.push_back({mesh.name, number, glm::dmat4(1.0)});
    soup.meshes.push_back(std::move(mesh));
}

Soup join(std::vector<Chunk>& chunks) {
    Soup soup;
    SoupMesh mesh;
    std::uint64_t false_normals = 0;
    for (Chunk& chunk : chunks) {
        std::size_t polygon = 0, position = 0;
        for (const Solid& solid : chunk.solids) {
            append(chunk, polygon, solid.polygon, position, mesh);
            polygon = solid.polygon;
            append_object(soup, mesh);
            mesh = {};
            mesh.name = solid.name;
        }
        append(chunk, polygon, chunk.polygon_sizes.size(), position, mesh);
        soup.ignored_primitives += chunk.ignored;
        false_normals += chunk.false_normals;
        chunk = {};
    }
    append_object(soup, mesh);
    drop_false_normals(soup, false_normals);
    return soup;
}

Result<Soup> read_ascii(std::string_view text, const ReadContext& context) {
    const std::vector<std::string_view> pieces = cut(text);
    std::vector<Chunk> chunks(pieces.size());
    std::atomic<std::uint64_t> memory{0};
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
        if (!context.check(memory)) return;
        Chunk& chunk = chunks[i] = ChunkParser(pieces[i]).parse();
        memory += chunk.positions.capacity() * sizeof(glm::dvec3) +
                  chunk.normals.capacity() * (sizeof(glm::vec3) + sizeof(std::uint32_t)) +
                  chunk.solids.capacity() * sizeof(Solid);
    });
    if (Status within_limits = context.check(memory); !within_limits) return within_limits.error();
    std::size_t corners = 0;
    for (const Chunk& chunk : chunks) {
        if (chunk.fault) {
            return context.at_line(text, static_cast<std::size_t>(chunk.fault->where - text.data()),
                                   chunk.fault->what);
        }
        corners += chunk.positions.size();
    }
    if (corners >= kNone) return context.unreadable("stl", "more than 1,431,655,764 facets");
    return join(chunks);
}

/// Whether the beginning holds nothing but text.
bool looks_like_text(std::string_view bytes) {
    constexpr std::size_t kLooked = 512;
    return std::ranges::all_of(bytes.substr(0, kLooked), [](char c) {
        return static_cast<unsigned char>(c) >= 0x20 || is_blank(c) || is_line_end(c);
    });
}

/// Begins with "solid", and then there is text: many binary files begin with "solid" as well.
bool looks_like_solid(std::string_view bytes) {
    constexpr std::size_t kLooked = 512;
    const std::string beginning = std::string(bytes.substr(0, kLooked)) + '\n';
    const char* p = beginning.data();
    const char* const end = p + beginning.size() - 1;
    while (p < end && (is_blank(*p) || is_line_end(*p))) ++p;
    return starts_with_word(p, "solid") && looks_like_text(bytes);
}

/// How many facets a binary file holds that states another number than fits its size.
Result<std::uint32_t> count_facets(std::string_view bytes, std::uint32_t stated,
                                   const ReadContext& context) {
    const std::size_t size = bytes.size() - kHeaderBytes, complete = size / kFacetBytes;
    // Some programs don't go back to fill the number in. Others append data of their own.
    constexpr std::uint32_t kNotFilledIn = 0xFFFFFFFF;
    const bool lies = stated == 0 || stated == kNotFilledIn || size % kFacetBytes == 0;
    const bool other = looks_like_text(bytes) || !sniff_format(bytes, bytes.size()).empty();
    if (stated > complete && (!lies || complete == 0 || other)) {
        return context.unreadable("stl",
                                  fmt::format("it ends after {} of {} facets", complete, stated));
    }
    if (!lies || other) return stated;
    return static_cast<std::uint32_t>(std::min<std::size_t>(complete, kMostFacets + 1));
}

Result<Soup> read_binary(std::string_view bytes, std::uint32_t stated, const ReadContext& context) {
    const Result<std::uint32_t> counted = count_facets(bytes, stated, context);
    if (!counted) return counted.error();
    const std::uint32_t facets = *counted;
    if (facets > kMostFacets) return context.unreadable("stl", "more than 1,431,655,764 facets");
    constexpr std::uint64_t kMemoryPerFacet = 4 * sizeof(glm::vec3) + 4 * sizeof(std::uint32_t);
    if (Status fits = context.check(facets * kMemoryPerFacet); !fits) return fits.error();
    Soup soup;
    if (facets == 0) return soup;
    if (facets != stated) {
        soup.notes.push_back(
            fmt::format("its header states {} facets, but there are {}; all that "
                        "are there are read",
                        stated, facets));
    }
    std::atomic<std::uint64_t> false_normals{0};
    SoupMesh& mesh = soup.meshes.emplace_back();
    mesh.positions.resize(std::size_t{3} * facets);
    mesh.normals.resize(facets);
    mesh.polygon_sizes.assign(facets, 3);
    mesh.corners.resize(std::size_t{3} * facets);
    mesh.has_polygon_normals = true;
    const char* const data = bytes.data() + kHeaderBytes;
    using Range = tbb::blocked_range<std::uint32_t>;
    tbb::parallel_for(Range(0, facets, 4096), [&](const Range& range) {
        for (std::uint32_t f = range.begin(); f != range.end(); ++f) {
            std::array<glm::vec3, 4> vectors;  // the normal, then the corners
            static_assert(sizeof vectors == kFacetFloatBytes);
            std::memcpy(vectors.data(), data + kFacetBytes * f, kFacetFloatBytes);
            const std::array<glm::dvec3, 3> corners = {vectors[1], vectors[2], vectors[3]};
            const bool is_false = contradicts(vectors[0], corners);
            if (is_false) ++false_normals;
            mesh.normals[f] = is_false ? glm::vec3(0) : vectors[0];
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = 3 * f + k;
                mesh.positions[corner] = vectors[k + 1];
                mesh.corners[corner] = corner;
            }
        }
    });
    soup.objects.push_back({"", 0, glm::dmat4(1.0)});
    drop_false_normals(soup, false_normals);
    return soup;
}

}  // namespace

Result<Soup> read_stl(std::string_view bytes, const ReadContext& context) {
    std::uint32_t facets = 0;
    const bool has_header = bytes.size() >= kHeaderBytes;
    if (has_header)
        std::memcpy(&facets, bytes.data() + kHeaderBytes - sizeof facets, sizeof facets);
    const bool exact =
        has_header && bytes.size() == kHeaderBytes + kFacetBytes * std::size_t{facets};
    const std::string_view text = without_mark(bytes);
    if (!exact && looks_like_solid(text)) {
        if (text.ends_with('\n')) return read_ascii(text, context);
        return read_ascii(std::string(text) + '\n', context);
    }
    if (!has_header) return context.unreadable("stl", "it ends within its header of 84 bytes");
    return read_binary(bytes, facets, context);
}

}  // namespace sightline::load
