// Files of BSP trees.
//
// Format, all little-endian: the mark, a version, the scene's fingerprint, the counts, the grid,
// then the nodes, their planes, the parts, the cuts, the marks of what moves, and last a checksum
// of all that precedes it (FNV-1a; G. Fowler, L. Noll, K. Vo, 1991).
//
// A file may come from a stranger who also made its checksum right. So its size has to be what the
// counts say before anything is allocated, every number is checked before it is used as an index,
// and what is walked must be trees: children after their parents and of one parent only, and every
// side of every cut used exactly once.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <utility>

#include "image/atomic_file.hpp"
#include "visibility/bsp_tree.hpp"

namespace sightline {

namespace bsp {

namespace {

constexpr std::array<char, 8> kMark{'S', 'L', 'B', 'S', 'P', '\r', '\n', '\x1a'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint64_t kHeaderSize = 8 + 4 + 8 + 5 * 4 + 4 * 8;
constexpr std::uint64_t kNodeSize = 3 * 4 + 4 * 8, kPartSize = 3 * 4, kCutSize = 2 * 4;
constexpr std::uint64_t kChecksumSize = 8;
// Cuts on the chains of all parts together, which is what ordering takes time and memory for: in
// trees of models about one a part, and 30 where a thousand polygons cross in one point.
constexpr std::uint64_t kMostChained = std::uint64_t{1} << 20;
constexpr std::uint64_t kMostChainedOfPart = 256;

class Checksum {
public:
    void take(const char* data, std::size_t size) {
        for (std::size_t k = 0; k < size; ++k)
            value_ = (value_ ^ static_cast<unsigned char>(data[k])) * 0x100000001B3u;
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xCBF29CE484222325u;
};

// -- writing ----------------------------------------------------------------------------------

class Writer {
public:
    explicit Writer(AtomicFile& file) : file_(file) {}

    void u8(std::uint8_t value) { put(value, 1); }
    void u32(std::uint32_t value) { put(value, 4); }
    void u64(std::uint64_t value) { put(value, 8); }
    void f64(double value) { put(std::bit_cast<std::uint64_t>(value), 8); }
    void vector(const glm::dvec3& v) {
        for (int k = 0; k < 3; ++k) f64(v[k]);
    }

    Status finish() {
        flush();
        u64(checksum_.value());
        flush();
        return file_.commit();
    }

private:
    void put(std::uint64_t value, int bytes) {
        for (int k = 0; k < bytes; ++k) buffer_.push_back(static_cast<char>(value >> (8 * k)));
        if (buffer_.size() > kFull) flush();
    }
    void flush() {
        checksum_.take(buffer_.data(), buffer_.size());
        // The first failure sticks and comes back from commit().
        (void)file_.write(buffer_.data(), buffer_.size());
        buffer_.clear();
    }

    static constexpr std::size_t kFull = 1 << 16;
    AtomicFile& file_;
    std::vector<char> buffer_;
    Checksum checksum_;
};

void write_tree(const Tree& tree, Writer& out) {
    for (const char c : kMark) out.u8(static_cast<std::uint8_t>(c));
    out.u32(kVersion);
    out.u64(tree.fingerprint);
    out.u32(tree.triangles);
    out.u32(static_cast<std::uint32_t>(tree.moving.size()));
    out.u32(tree.node_count());
    out.u32(static_cast<std::uint32_t>(tree.parts.size()));
    out.u32(static_cast<std::uint32_t>(tree.cuts.size()));
    out.vector(tree.grid.origin);
    out.f64(tree.grid.step);
    for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
        out.u32(tree.nodes[i].front);
        out.u32(tree.nodes[i].back);
        out.u32(tree.nodes[i].first_part);
        out.vector(tree.planes[i].normal);
        out.f64(tree.planes[i].offset);
    }
    for (const Part& part : tree.parts) {
        out.u32(part.triangle);
        out.u32(part.cut);
        out.u32(part.reversed);
    }
    for (const Cut& cut : tree.cuts) {
        out.u32(cut.node);
        out.u32(cut.parent);
    }
    for (const std::uint8_t mark : tree.moving) out.u8(mark);
}

// -- reading ----------------------------------------------------------------------------------

/// Numbers of a file whose size is known to suffice.
class Reader {
public:
    explicit Reader(std::span<const char> bytes) : bytes_(bytes) {}

    std::uint8_t u8() { return static_cast<std::uint8_t>(get(1)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(get(4)); }
    std::uint64_t u64() { return get(8); }
    double f64() { return std::bit_cast<double>(get(8)); }
    glm::dvec3 vector() {
        const double x = f64(), y = f64();
        return {x, y, f64()};
    }

private:
    std::uint64_t get(int bytes) {
        std::uint64_t value = 0;
        for (int k = 0; k < bytes; ++k)
            value |= std::uint64_t{static_cast<unsigned char>(bytes_[at_++])} << (8 * k);
        return value;
    }

    std::span<const char> bytes_;
    std::size_t at_ = 0;
};

struct Counts {
    std::uint32_t moving = 0, nodes = 0, parts = 0, cuts = 0;

    [[nodiscard]] std::uint64_t file_size() const {
        return kHeaderSize + nodes * kNodeSize + parts * kPartSize + cuts * kCutSize + moving +
               kChecksumSize;
    }
};

void read_arrays(Reader& in, const Counts& counts, Tree& tree) {
    tree.nodes.resize(std::size_t{counts.nodes} + 1);
    tree.planes.resize(counts.nodes);
    for (std::uint32_t i = 0; i < counts.nodes; ++i) {
        const std::uint32_t front = in.u32(), back = in.u32();
        tree.nodes[i] = {front, back, in.u32()};
        const glm::dvec3 normal = in.vector();
        tree.planes[i] = {normal, in.f64()};
    }
    tree.nodes.back().first_part = counts.parts;
    tree.parts.resize(counts.parts);
    for (Part& part : tree.parts) {
        const std::uint32_t triangle = in.u32(), cut = in.u32();
        part = {triangle, cut, in.u32()};
    }
    tree.cuts.resize(counts.cuts);
    for (Cut& cut : tree.cuts) {
        const std::uint32_t node = in.u32();
        cut = {node, in.u32()};
    }
    tree.moving.resize(counts.moving);
    for (std::uint8_t& mark : tree.moving) mark = in.u8();
}

// -- what a tree must be to be walked without harm ----------------------------------------------

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool planes_are_sound(const Tree& tree) {
    return finite(tree.grid.origin) && std::isfinite(tree.grid.step) && tree.grid.step > 0 &&
           std::ranges::all_of(tree.planes, [](const TreePlane& plane) {
               const double length2 = glm::dot(plane.normal, plane.normal);
               return finite(plane.normal) && length2 > 0.5 && length2 < 2 &&
                      std::abs(plane.offset) < 0x1p30;
           });
}

/// Children come after their parent and have one only, so nothing is met twice.
bool nodes_are_a_tree(const Tree& tree) {
    std::vector<std::uint8_t> met(tree.node_count(), 0);
    for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
        if (i > 0 && met[i] == 0) return false;
        for (const std::uint32_t child : {tree.nodes[i].front, tree.nodes[i].back}) {
            if (child == kNone) continue;
            if (child <= i || child >= tree.node_count() || met[child] != 0) return false;
            met[child] = 1;
        }
        if (tree.nodes[i].first_part > tree.nodes[i + 1].first_part) return false;
    }
    return tree.nodes.front().first_part == 0;
}

bool parts_are_sound(const Tree& tree) {
    for (const Part& part : tree.parts)
        if (part.triangle >= tree.triangles || part.reversed > 1 ||
            (!tree.moving.empty() && tree.moving[part.triangle] != 0))
            return false;
    for (std::uint32_t i = 0; i < tree.node_count(); ++i)
        if (!std::ranges::is_sorted(tree.parts_of(i), std::greater<>(), &Part::triangle))
            return false;
    return true;
}

/// Every side of a cut is cut again or is a part, once.
bool cuts_are_trees(const Tree& tree) {
    std::vector<std::uint8_t> used(2 * tree.cuts.size(), 0);
    std::vector<std::uint32_t> length(tree.cuts.size(), 1);  // of the chain that ends with a cut
    for (std::size_t k = 0; k < tree.cuts.size(); ++k) {
        const Cut& cut = tree.cuts[k];
        if (cut.node >= tree.node_count()) return false;
        if (cut.parent == kNone) continue;
        if (cut.parent >> 1 >= k || std::exchange(used[cut.parent], std::uint8_t{1}) != 0)
            return false;
        length[k] = length[cut.parent >> 1] + 1;
    }
    std::uint64_t chained = 0;
    for (const Part& part : tree.parts) {
        if (part.cut == kNone) continue;
        if (part.cut >= used.size() || std::exchange(used[part.cut], std::uint8_t{1}) != 0)
            return false;
        chained += length[part.cut >> 1];
    }
    return chained <= kMostChained + kMostChainedOfPart * tree.parts.size() &&
           std::ranges::find(used, 0) == used.end();
}

bool is_sound(const Tree& tree) {
    return planes_are_sound(tree) && nodes_are_a_tree(tree) && parts_are_sound(tree) &&
           cuts_are_trees(tree);
}

// -- the whole --------------------------------------------------------------------------------

Error damaged(const std::string& path, const char* cause) {
    return {ErrorKind::bad_input, path + ": " + cause + "; save the tree of the scene again"};
}

Result<std::vector<char>> read_bytes(const std::string& path) {
    const Error refused{ErrorKind::io,
                        path + ": can't be read; check that it is a file and its permissions"};
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return refused;
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    if (failed) return refused;
    // Far more than the tree of a scene that fits into memory.
    if (size > (std::uint64_t{1} << 34)) return damaged(path, "is too large for a BSP tree");
    std::ifstream file(path, std::ios::binary);
    std::vector<char> bytes(size);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return refused;
    return bytes;
}

Result<Tree> parse(const std::string& path, std::span<const char> bytes, const Scene& scene) {
    if (bytes.size() < kHeaderSize + kChecksumSize ||
        !std::equal(kMark.begin(), kMark.end(), bytes.begin()))
        return damaged(path, "is no file of a BSP tree, or cut off at its beginning");
    Reader in(bytes.subspan(kMark.size()));
    if (const std::uint32_t version = in.u32(); version != kVersion)
        return damaged(path, "has a version of the format that this program does not know");
    Tree tree;
    tree.fingerprint = in.u64();
    tree.triangles = in.u32();
    Counts counts;
    counts.moving = in.u32();
    counts.nodes = in.u32();
    counts.parts = in.u32();
    counts.cuts = in.u32();
    tree.grid.origin = in.vector();
    tree.grid.step = in.f64();
    if (bytes.size() != counts.file_size()) return damaged(path, "is cut off or too long");
    Checksum checksum;
    checksum.take(bytes.data(), bytes.size() - kChecksumSize);
    if (Reader(bytes.last(kChecksumSize)).u64() != checksum.value())
        return damaged(path, "is damaged: its checksum is wrong");
    if (tree.triangles != scene.triangle_count() ||
        (counts.moving != 0 && counts.moving != tree.triangles))
        return damaged(path, "is the tree of another scene");
    read_arrays(in, counts, tree);
    if (tree.fingerprint != fingerprint_of(scene, tree.moving))
        return damaged(path, "is the tree of another scene");
    if (!is_sound(tree)) return damaged(path, "is damaged: its tree makes no sense");
    return tree;
}

}  // namespace

}  // namespace bsp

Status save_bsp(const BspTree& tree, const std::string& path) {
    try {
        // What load_bsp() would refuse must not be written.
        if (!bsp::cuts_are_trees(tree.data()))
            return Error{ErrorKind::bad_option,
                         path + ": the tree has too many cuts for a file; build it when needed"};
        Result<AtomicFile> file = AtomicFile::create(path, AtomicFile::Access::sequential);
        if (!file) return file.error();
        bsp::Writer out(*file);
        bsp::write_tree(tree.data(), out);
        return out.finish();
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io, path + ": not enough memory to write the tree; free some"};
    }
}

Result<BspTree> load_bsp(const std::string& path, const Scene& scene) {
    try {
        Result<std::vector<char>> bytes = bsp::read_bytes(path);
        if (!bytes) return bytes.error();
        Result<bsp::Tree> tree = bsp::parse(path, *bytes, scene);
        if (!tree) return tree.error();
        return BspTree(std::make_shared<const bsp::Tree>(std::move(tree).value()));
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::io, path + ": not enough memory to read the tree; free some"};
    }
}

}  // namespace sightline
