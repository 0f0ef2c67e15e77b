// One reader for the three forms, over a source of values. Counts are believed only as far as the
// rest of the file has room for them.
#include "scene/load/ply_reader.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/load/ply_header.hpp"
#include "scene/load/ply_values.hpp"
#include "scene/load/ply_vertex.hpp"
#include "scene/load/text.hpp"
#include "scene/load/texture_names.hpp"

namespace sightline::load {
namespace {

constexpr std::uint64_t kRecordsBetweenChecks = 65536;  // of time and memory
constexpr std::uint64_t kNegativeLength = ~std::uint64_t{0};

std::uint64_t memory_of(const SoupMesh& mesh) {
    return mesh.positions.size() * sizeof(glm::vec3) +
           mesh.precise_positions.size() * sizeof(glm::dvec3) +
           mesh.normals.size() * sizeof(glm::vec3) + mesh.colors.size() * sizeof(glm::vec4) +
           (mesh.corners.capacity() + mesh.polygon_sizes.capacity()) * sizeof(std::uint32_t);
}

template <class Values>
class PlyReader {
public:
    PlyReader(const PlyHeader& header, std::string_view file, std::string_view body,
              const ReadContext& context)
        : header_(header), file_(file), body_(body), values_(body), context_(context) {}

    [[nodiscard]] Result<Soup> read();

private:
    [[nodiscard]] Status read_element(const PlyElement& element);
    [[nodiscard]] Status read_vertices(const PlyElement& element);
    [[nodiscard]] Status read_faces(const PlyElement& element, bool strips);
    [[nodiscard]] Status skip_element(const PlyElement& element);
    [[nodiscard]] Status check_room(const PlyElement& element) const;
    bool skip_list(Values& values, const PlyProperty& property);
    bool read_vertex(Values& values, const PlyVertexPlan& plan, std::size_t index);
    bool read_length(const PlyProperty& property, std::uint64_t& length);
    void end_face(std::size_t first_corner);
    void append_strips();

    /// An error about face `index`: its line in a text, its number in a binary file.
    [[nodiscard]] Error fault(const PlyElement& element, std::uint64_t index,
                              std::string_view what) const;
    /// The error about a line that doesn't hold what the header says.
    [[nodiscard]] Error wrong_line(const PlyElement& element, std::uint64_t index) const {
        return fault(element, index, "is not the line of values that the header describes");
    }
    /// Why a value could not be read.
    [[nodiscard]] Error failure(const PlyElement& element, std::uint64_t index);
    [[nodiscard]] std::optional<Error> check_indices(const PlyElement& element, std::uint64_t index,
                                                     std::size_t first_corner) const;

    const PlyHeader& header_;
    std::string_view file_, body_;
    Values values_;
    const ReadContext& context_;
    Soup soup_;
    SoupMesh mesh_;
    std::uint64_t vertices_ = 0;       ///< as stated
    std::vector<std::int64_t> strip_;  ///< the list at hand
};

template <class Values>
Error PlyReader<Values>::fault(const PlyElement& element, std::uint64_t index,
                               std::string_view what) const {
    if constexpr (Values::kBinary) {
        return context_.unreadable("ply", fmt::format("{} {} {}", element.name, index, what));
    } else {
        const auto offset = static_cast<std::size_t>(values_.position() - body_.data());
        return context_.at_line(file_, header_.size + offset,
                                fmt::format("{} {}", element.name, what));
    }
}

template <class Values>
Error PlyReader<Values>::failure(const PlyElement& element, std::uint64_t index) {
    if constexpr (!Values::kBinary) {
        const bool at_value = values_.skip_space();
        const char* const p = values_.position();
        double number = 0;
        if (at_value && scan_real(p, number) != skip_word(p)) {
            const std::string word = one_line({p, static_cast<std::size_t>(skip_word(p) - p)});
            return context_.at_line(file_,
                                    header_.size + static_cast<std::size_t>(p - body_.data()),
                                    fmt::format("'{}' is not a number that can stand here", word));
        }
    }
    return context_.unreadable("ply", fmt::format("it ends within element '{}', after {} of {}",
                                                  one_line(element.name), index, element.count));
}

/// Every value of every record takes a byte at least (in text also one between them).
template <class Values>
Status PlyReader<Values>::check_room(const PlyElement& element) const {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties) {
        least += Values::kBinary ? size_of(p.count_type.value_or(p.type)) : 1;
    }
    if (element.count < kNone &&
        (least == 0 || values_.has_room(element.count * least, PlyType::uint8))) {
        return success();
    }
    return context_.unreadable(
        "ply", fmt::format("{} of element '{}' do not fit the file, which is too short",
                           element.count, one_line(element.name)));
}

template <class Values>
bool PlyReader<Values>::skip_list(Values& values, const PlyProperty& property) {
    std::int64_t length = 0;
    return values.integer(*property.count_type, length) && length >= 0 &&
           values.skip(property.type, static_cast<std::uint64_t>(length));
}

template <class Values>
Status PlyReader<Values>::skip_element(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        values_.begin_record();
        for (const PlyProperty& property : element.properties) {
            const bool skipped =
                property.count_type ? skip_list(values_, property) : values_.skip(property.type, 1);
            if (!skipped) return failure(element, i);
        }
        if (!values_.ends_record()) return wrong_line(element, i);
    }
    return success();
}

template <class Values>
bool PlyReader<Values>::read_vertex(Values& values, const PlyVertexPlan& plan, std::size_t index) {
    using enum PlyVertexPlan::Slot;
    glm::dvec3 position(0);
    PlyVertexPlan::Numbers n{};
    n[kAlpha] = 1;
    for (const auto& [property, slot, divisor] : plan.entries) {
        if (property->count_type) {
            if (!skip_list(values, *property)) return false;
            continue;
        }
        if (slot <= kZ) {
            if (!values.real(property->type, position[static_cast<int>(slot)])) return false;
            continue;
        }
        float value = 0;
        if (!values.real(property->type, value)) return false;
        n[slot] = divisor == 1 ? value : value / divisor;
    }
    if (mesh_.positions.empty()) {
        mesh_.precise_positions[index] = position;
    } else {
        mesh_.positions[index] = position;
    }
    if (!mesh_.normals.empty()) mesh_.normals[index] = {n[kNx], n[kNy], n[kNz]};
    if (!mesh_.colors.empty()) mesh_.colors[index] = {n[kRed], n[kGreen], n[kBlue], n[kAlpha]};
    return true;
}

template <class Values>
Status PlyReader<Values>::read_vertices(const PlyElement& element) {
    using enum PlyVertexPlan::Slot;
    const PlyVertexPlan plan(element);
    if (mesh_.position_count() > 0)
        return context_.unreadable("ply", "it has two elements 'vertex'");
    if (!plan.has_all(kX, kZ)) {
        return context_.unreadable("ply", "its element 'vertex' has no x, y and z");
    }
    const bool normals = plan.has_all(kNx, kNz), colors = plan.has_all(kRed, kBlue);
    const std::size_t count = element.count;
    const bool precise = plan.precise || !Values::kBinary;  // a text is as precise as its digits
    Status fits = context_.check(count * ((precise ? sizeof(glm::dvec3) : sizeof(glm::vec3)) +
                                          (normals ? sizeof(glm::vec3) : 0) +
                                          (colors ? sizeof(glm::vec4) : 0)));
    if (!fits) return fits;
    if (precise) {
        mesh_.precise_positions.resize(count);
    } else {
        mesh_.positions.resize(count);
    }
    if (normals) mesh_.normals.resize(count);
    if (colors) mesh_.colors.resize(count);
    if constexpr (Values::kBinary) {
        if (plan.stride) {
            const char* const start = values_.position();
            const std::uint64_t stride = *plan.stride;
            if (!values_.skip_bytes(count * stride)) return failure(element, 0);
            using Range = tbb::blocked_range<std::size_t>;
            tbb::parallel_for(Range(0, count, 4096), [&](const Range& range) {
                Values values({start + range.begin() * stride, range.size() * stride});
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    (void)read_vertex(values, plan, i);  // there is room
                }
            });
            return success();
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        values_.begin_record();
        if (!read_vertex(values_, plan, i)) return failure(element, i);
        if (!values_.ends_record()) return wrong_line(element, i);
    }
    return success();
}

template <class Values>
bool PlyReader<Values>::read_length(const PlyProperty& property, std::uint64_t& length) {
    std::int64_t stated = 0;
    if (!values_.integer(*property.count_type, stated)) return false;
    length = stated < 0 ? kNegativeLength : static_cast<std::uint64_t>(stated);
    return values_.has_room(length, property.type);
}

/// A face of which all corners after `first_corner` are there.
template <class Values>
void PlyReader<Values>::end_face(std::size_t first_corner) {
    const std::size_t size = mesh_.corners.size() - first_corner;
    if (size >= 3) {
        mesh_.polygon_sizes.push_back(static_cast<std::uint32_t>(size));
    } else {
        mesh_.corners.resize(first_corner);
        ++soup_.ignored_primitives;
    }
}

/// Triangles of the strips in `strip_`: every second one is turned over, so that all face alike.
template <class Values>
void PlyReader<Values>::append_strips() {
    const auto index = [&](std::size_t i) {
        const std::int64_t value = strip_[i];
        return value >= 0 && value < kNone ? static_cast<std::uint32_t>(value) : kNone;
    };
    std::size_t start = 0;
    for (std::size_t i = 0; i < strip_.size(); ++i) {
        if (strip_[i] == -1) {
            start = i + 1;
        } else if (i >= start + 2) {
            const std::size_t odd = (i - start) % 2;
            mesh_.corners.insert(mesh_.corners.end(),
                                 {index(i - 2 + odd), index(i - 1 - odd), index(i)});
            mesh_.polygon_sizes.push_back(3);
        }
    }
}

template <class Values>
std::optional<Error> PlyReader<Values>::check_indices(const PlyElement& element,
                                                      std::uint64_t index,
                                                      std::size_t first_corner) const {
    for (std::size_t i = first_corner; i < mesh_.corners.size(); ++i) {
        if (mesh_.corners[i] >= vertices_) {
            const std::string vertex = mesh_.corners[i] == kNone
                                           ? "a vertex out of range"
                                           : fmt::format("vertex {}", mesh_.corners[i]);
            return fault(element, index,
                         fmt::format("refers to {}, but there are {}", vertex, vertices_));
        }
    }
    return std::nullopt;
}

template <class Values>
Status PlyReader<Values>::read_faces(const PlyElement& element, bool strips) {
    const auto list = std::ranges::find_if(element.properties, [](const PlyProperty& p) {
        return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    });
    if (list == element.properties.end()) {
        return context_.unreadable("ply", fmt::format("its element '{}' has no list vertex_indices",
                                                      one_line(element.name)));
    }
    const bool colored = std::ranges::any_of(
        element.properties, [](const PlyProperty& p) { return !p.count_type && p.name == "red"; });
    if (colored) soup_.notes.emplace_back(kNoFaceColors);
    if (!strips) mesh_.polygon_sizes.reserve(mesh_.polygon_sizes.size() + element.count);
    const auto add_corner = [&](std::int64_t index) {
        mesh_.corners.push_back(index >= 0 && index < kNone ? static_cast<std::uint32_t>(index)
                                                            : kNone);
    };
    const auto add_to_strip = [&](std::int64_t index) { strip_.push_back(index); };
    for (std::uint64_t i = 0; i < element.count; ++i) {
        const std::size_t first_corner = mesh_.corners.size();
        values_.begin_record();
        for (auto property = element.properties.begin(); property != element.properties.end();
             ++property) {
            std::uint64_t length = 0;
            bool read = true;
            if (property != list) {
                read = property->count_type ? skip_list(values_, *property)
                                            : values_.skip(property->type, 1);
            } else {
                strip_.clear();
                read = read_length(*property, length);
                if (length == kNegativeLength) {
                    return context_.unreadable(
                        "ply", fmt::format("a list of negative length in {} {}", element.name, i));
                }
                if (length >= kRecordsBetweenChecks) {
                    constexpr std::uint64_t kMemoryPerIndex =
                        sizeof(std::int64_t) + 4 * sizeof(std::uint32_t);
                    Status fits = context_.check(memory_of(mesh_) + length * kMemoryPerIndex);
                    if (read && !fits) return fits;
                }
                read = read && (strips ? values_.integers(property->type, length, add_to_strip)
                                       : values_.integers(property->type, length, add_corner));
            }
            if (!read) return failure(element, i);
        }
        if (!values_.ends_record()) return wrong_line(element, i);
        if (strips) {
            append_strips();
        } else {
            end_face(first_corner);
        }
        if (auto wrong = check_indices(element, i, first_corner)) return *std::move(wrong);
        if (i % kRecordsBetweenChecks == 0) {
            if (Status fits = context_.check(memory_of(mesh_)); !fits) return fits;
        }
    }
    return success();
}

template <class Values>
Status PlyReader<Values>::read_element(const PlyElement& element) {
    if (element.count == 0) return success();
    if (Status room = check_room(element); !room) return room;
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_faces(element, false);
    if (element.name == "tristrips") return read_faces(element, true);
    return skip_element(element);
}

template <class Values>
Result<Soup> PlyReader<Values>::read() {
    bool drawn = false;
    std::uint64_t records = 0;
    for (const PlyElement& element : header_.elements) {
        if (!element.properties.empty()) records += std::min<std::uint64_t>(element.count, kNone);
        if (element.name == "vertex") vertices_ = element.count;
        drawn = drawn || element.name == "face" || element.name == "tristrips";
    }
    values_.expect_records(records);
    for (const PlyElement& element : header_.elements) {
        if (Status read = read_element(element); !read) return read.error();
    }
    if (Status fits = context_.check(memory_of(mesh_)); !fits) return fits.error();
    TextureNames textures = textures_in(header_.textures, context_.path());
    if (!textures.names.empty()) soup_.notes.push_back(note_of_textures(textures.names));
    soup_.files = std::move(textures.places);
    if (!drawn) soup_.ignored_primitives += vertices_;  // a cloud of points
    if (!mesh_.polygon_sizes.empty()) {
        soup_.meshes.push_back(std::move(mesh_));
        soup_.objects.push_back({"", 0, glm::dmat4(1.0)});
    }
    return std::move(soup_);
}

}  // namespace

Result<Soup> read_ply(std::string_view bytes, const ReadContext& context) {
    bytes = without_mark(bytes);
    const Result<PlyHeader> header = parse_ply_header(bytes, context);
    if (!header) return header.error();
    const std::string_view body = bytes.substr(header->size);
    if (header->format == PlyHeader::Format::ascii) {
        if (body.ends_with('\n')) return PlyReader<PlyText>(*header, bytes, body, context).read();
        const std::string ended = std::string(body) + '\n';  // every scan ends at a line end
        return PlyReader<PlyText>(*header, bytes, ended, context).read();
    }
    constexpr bool kLittle = std::endian::native == std::endian::little;
    if ((header->format == PlyHeader::Format::binary_little_endian) == kLittle) {
        return PlyReader<PlyBinary<false>>(*header, bytes, body, context).read();
    }
    return PlyReader<PlyBinary<true>>(*header, bytes, body, context).read();
}

}  // namespace sightline::load
