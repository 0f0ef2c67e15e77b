// The text is cut at line ends into pieces of a fixed size, which are parsed side by side; so the
// result, errors included, does not depend on the number of threads. Then indices are resolved and
// checked, the pieces joined, and the polygons dealt out to meshes.
#include "scene/load/obj_reader.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "scene/load/obj_chunk.hpp"
#include "scene/load/obj_materials.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 18;
constexpr std::size_t kMostVertices = 0x7fffffff;

/// Bytes of memory that a chunk holds.
std::uint64_t memory_of(const ObjChunk& chunk) {
    const auto bytes = [](const auto&... all) {
        return ((std::uint64_t{all.capacity()} * sizeof(all[0])) + ...);
    };
    return bytes(chunk.positions, chunk.normals, chunk.colors, chunk.polygon_sizes,
                 chunk.corners.values, chunk.corners.relative, chunk.normal_corners.values,
                 chunk.normal_corners.relative, chunk.events);
}

/// Whether a chunk may begin after this line end: not within a continued line.
bool ends_statement(std::string_view text, std::size_t line_end) {
    std::size_t before = line_end;
    if (before > 0 && text[before - 1] == '\r') --before;
    return before == 0 || text[before - 1] != '\\';
}

std::vector<std::string_view> cut(std::string_view text) {
    std::vector<std::string_view> pieces;
    while (!text.empty()) {
        std::size_t end = text.find('\n', std::min(kChunkBytes, text.size() - 1));
        while (!ends_statement(text, end) && end + 1 < text.size()) end = text.find('\n', end + 1);
        pieces.push_back(text.substr(0, end + 1));
        text.remove_prefix(end + 1);
    }
    return pieces;
}

/// Makes indices count from the start of the file; how many are out of range. These become
/// kOutOfRange, whatever they were.
std::size_t resolve(ObjIndices& indices, std::size_t before, std::size_t count) {
    for (const std::size_t place : indices.relative) {
        std::uint32_t& index = indices.values[place];
        index += static_cast<std::uint32_t>(before);
        if (index >= count) index = kObjOutOfRange;
    }
    std::size_t wrong = 0;
    for (std::uint32_t& index : indices.values) {
        if (index < count || index == kNone) continue;
        index = kObjOutOfRange;
        ++wrong;
    }
    return wrong;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
    std::vector<T>().swap(from);
}

/// Polygons of one object and material that follow one another.
struct Run {
    std::size_t first_polygon, end_polygon;
    std::string_view object;
    std::uint32_t material;
    bool first_of_object;
};

class ObjReader {
public:
    ObjReader(std::string_view text, const ReadContext& context)
        : text_(text), context_(context), materials_(context) {}

    [[nodiscard]] Result<Soup> read();

private:
    [[nodiscard]] Status parse();
    [[nodiscard]] Status resolve_indices();
    [[nodiscard]] Error fault_at(const ObjFault& fault) const;
    void join_chunks();
    [[nodiscard]] Status find_runs();
    void make_meshes();
    [[nodiscard]] SoupMesh part(const Run& run, std::size_t first_corner);

    std::string_view text_;
    const ReadContext& context_;
    ObjMaterials materials_;
    std::vector<std::string_view> pieces_;
    std::vector<ObjChunk> chunks_;
    std::vector<ObjCounts> counts_;  ///< of each chunk
    SoupMesh all_;                   ///< the whole file
    std::vector<Run> runs_;
    std::vector<std::uint32_t> part_positions_, part_normals_;  ///< see part(); else all kNone
    Soup soup_;
};

Error ObjReader::fault_at(const ObjFault& fault) const {
    return context_.at_line(text_, static_cast<std::size_t>(fault.where - text_.data()),
                            fault.what);
}

Status ObjReader::parse() {
    pieces_ = cut(text_);
    chunks_.resize(pieces_.size());
    std::atomic<std::uint64_t> memory{0};
    tbb::parallel_for(std::size_t{0}, pieces_.size(), [&](std::size_t i) {
        if (!context_.check(memory)) return;
        chunks_[i] = parse_obj_chunk(pieces_[i]);
        memory += memory_of(chunks_[i]);
    });
    if (Status within_limits = context_.check(memory); !within_limits) return within_limits;
    for (const ObjChunk& chunk : chunks_) {
        if (chunk.fault) return fault_at(*chunk.fault);
    }
    return success();
}

Status ObjReader::resolve_indices() {
    ObjCounts counts;
    for (const ObjChunk& chunk : chunks_) {
        counts_.push_back(counts);
        counts.positions_before += chunk.positions.size();
        counts.normals_before += chunk.normals.size();
    }
    if (std::max(counts.positions_before, counts.normals_before) > kMostVertices) {
        return context_.unreadable("obj", "more than 2,147,483,647 vertices or normals");
    }
    std::vector<std::uint8_t> wrong(chunks_.size());
    std::atomic<std::size_t> missing_normals{0};
    tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
        counts_[i].positions = counts.positions_before;
        ObjChunk& chunk = chunks_[i];
        wrong[i] =
            resolve(chunk.corners, counts_[i].positions_before, counts_[i].positions) > 0 ? 1 : 0;
        const std::size_t missing =
            resolve(chunk.normal_corners, counts_[i].normals_before, counts.normals_before);
        if (missing == 0) return;
        missing_normals += missing;
        std::ranges::replace(chunk.normal_corners.values, kObjOutOfRange, kNone);
    });
    if (missing_normals > 0) {
        soup_.notes.push_back(
            fmt::format("faces refer to normals that are not in the file; their corners have none: "
                        "{}",
                        missing_normals.load()));
    }
    const auto first = std::ranges::find(wrong, std::uint8_t{1});
    if (first == wrong.end()) return success();
    const auto i = static_cast<std::size_t>(first - wrong.begin());
    return fault_at(parse_obj_chunk(pieces_[i], &counts_[i]).fault.value());
}

void ObjReader::join_chunks() {
    std::size_t polygons = 0, corners = 0;
    bool colors = false, normals = false;
    for (const ObjChunk& chunk : chunks_) {
        polygons += chunk.polygon_sizes.size();
        corners += chunk.corners.values.size();
        colors = colors || !chunk.colors.empty();
        normals = normals || !chunk.normal_corners.values.empty();
    }
    all_.precise_positions.reserve(counts_.empty() ? 0 : counts_[0].positions);
    all_.polygon_sizes.reserve(polygons);
    all_.corners.reserve(corners);
    for (ObjChunk& chunk : chunks_) {
        append(all_.precise_positions, chunk.positions);
        append(all_.polygon_sizes, chunk.polygon_sizes);
        append(all_.corners, chunk.corners.values);
        if (normals) {
            append(all_.normals, chunk.normals);
            append(all_.normal_corners, chunk.normal_corners.values);
            all_.normal_corners.resize(all_.corners.size(), kNone);
        }
        if (colors) {
            append(all_.colors, chunk.colors);
            all_.colors.resize(all_.precise_positions.size(), glm::vec4(1));
        }
        soup_.ignored_primitives += chunk.ignored;
    }
}

/// Follows the lines o, g, usemtl and mtllib. A name that is current already begins nothing new.
Status ObjReader::find_runs() {
    Run run{0, 0, {}, kNone, true};
    std::string_view group;
    const auto end_run = [&](std::size_t polygon) {
        run.end_polygon = polygon;
        if (run.end_polygon > run.first_polygon) {
            runs_.push_back(run);
            run.first_of_object = false;
        }
        run.first_polygon = polygon;
    };
    const auto begin_object = [&](std::size_t polygon, std::string_view name) {
        end_run(polygon);
        run.object = name;
        run.first_of_object = true;
    };
    std::size_t before = 0;
    for (const ObjChunk& chunk : chunks_) {
        for (const auto& [kind, polygon, name] : chunk.events) {
            if (kind == ObjEvent::Kind::material_file) {
                if (Status within_limits = materials_.load(name); !within_limits) {
                    return within_limits;
                }
            } else if (kind == ObjEvent::Kind::use_material) {
                const std::uint32_t material = materials_.use(name);
                if (material == run.material) continue;
                end_run(before + polygon);
                run.material = material;
            } else if (kind == ObjEvent::Kind::group) {
                if (name == group) continue;
                group = name;
                begin_object(before + polygon, name);
            } else if (name != run.object) {
                begin_object(before + polygon, name);
            }
        }
        before += chunk.polygon_sizes.size();
    }
    end_run(before);
    return success();
}

/// The polygons of a run on vertices of their own, in order of their first use.
SoupMesh ObjReader::part(const Run& run, std::size_t first_corner) {
    SoupMesh mesh;
    mesh.polygon_sizes.assign(
        all_.polygon_sizes.begin() + static_cast<std::ptrdiff_t>(run.first_polygon),
        all_.polygon_sizes.begin() + static_cast<std::ptrdiff_t>(run.end_polygon));
    std::size_t corners = 0;
    for (const std::uint32_t size : mesh.polygon_sizes) corners += size;
    const auto renumber = [&](const std::vector<std::uint32_t>& indices,
                              std::vector<std::uint32_t>& numbers,
                              std::vector<std::uint32_t>& renumbered, const auto& take) {
        const auto mine = std::span(indices).subspan(first_corner, corners);
        std::uint32_t next = 0;
        for (const std::uint32_t index : mine) {
            if (index != kNone && numbers[index] == kNone) {
                take(index);
                numbers[index] = next++;
            }
            renumbered.push_back(index == kNone ? kNone : numbers[index]);
        }
        for (const std::uint32_t index : mine) {
            if (index != kNone) numbers[index] = kNone;
        }
    };
    mesh.corners.reserve(corners);
    renumber(all_.corners, part_positions_, mesh.corners, [&](std::uint32_t index) {
        mesh.precise_positions.push_back(all_.precise_positions[index]);
        if (!all_.colors.empty()) mesh.colors.push_back(all_.colors[index]);
    });
    if (!all_.normal_corners.empty()) {
        renumber(all_.normal_corners, part_normals_, mesh.normal_corners,
                 [&](std::uint32_t index) { mesh.normals.push_back(all_.normals[index]); });
        if (mesh.normals.empty()) std::vector<std::uint32_t>().swap(mesh.normal_corners);
    }
    return mesh;
}

void ObjReader::make_meshes() {
    if (runs_.size() > 1) {
        part_positions_.assign(all_.precise_positions.size(), kNone);
        part_normals_.assign(all_.normals.size(), kNone);
    }
    std::size_t first_corner = 0;
    for (const Run& run : runs_) {
        SoupMesh mesh = runs_.size() == 1 ? std::move(all_) : part(run, first_corner);
        first_corner += mesh.corners.size();
        mesh.material = run.material;
        // An object of several materials: its parts after the first are called after theirs.
        const bool by_material = !run.first_of_object && run.material != kNone;
        mesh.name = by_material ? materials_.name(run.material) : run.object;
        soup_.objects.push_back(
            {mesh.name, static_cast<std::uint32_t>(soup_.meshes.size()), glm::dmat4(1.0)});
        soup_.meshes.push_back(std::move(mesh));
    }
}

Result<Soup> ObjReader::read() {
    if (Status parsed = parse(); !parsed) return parsed.error();
    if (Status resolved = resolve_indices(); !resolved) return resolved.error();
    if (Status found = find_runs(); !found) return found.error();
    join_chunks();
    make_meshes();
    soup_.materials = materials_.take();
    const std::vector<std::string> notes = materials_.notes();
    soup_.notes.insert(soup_.notes.end(), notes.begin(), notes.end());
    soup_.files = materials_.files();
    if (Status in_time = context_.check(0); !in_time) return in_time.error();
    return std::move(soup_);
}

}  // namespace

Result<Soup> read_obj(std::string_view text, const ReadContext& context) {
    text = without_mark(text);
    if (text.ends_with('\n')) return ObjReader(text, context).read();
    const std::string ended = std::string(text) + '\n';  // every scan ends at a line end
    return ObjReader(ended, context).read();
}

}  // namespace sightline::load
