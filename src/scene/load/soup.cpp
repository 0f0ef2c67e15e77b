#include "scene/load/soup.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <type_traits>

namespace sightline::load {
namespace {

constexpr std::uint64_t kMagic = 0x33504f534c535f5full;  // changes with the layout

class Writer {
public:
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        append(&value, sizeof value);
    }
    template <class T>
    void put_all(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(std::uint64_t{values.size()});
        append(values.data(), values.size() * sizeof(T));
    }
    void put_text(const std::string& text) {
        put(std::uint64_t{text.size()});
        append(text.data(), text.size());
    }
    [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

private:
    void append(const void* data, std::size_t size) {
        const auto* first = static_cast<const std::byte*>(data);
        bytes_.insert(bytes_.end(), first, first + size);
    }
    std::vector<std::byte> bytes_;
};

/// Reads what Writer wrote. After the first failure everything reads as zero or empty.
class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <class T>
    [[nodiscard]] T get() {
        T value{};
        copy(&value, 1);
        return value;
    }
    /// A count of things that take at least `size` bytes each: never more than there is room for.
    [[nodiscard]] std::size_t get_count(std::size_t size) {
        const auto count = get<std::uint64_t>();
        ok_ = ok_ && count <= bytes_.size() / size;
        return ok_ ? static_cast<std::size_t>(count) : 0;
    }
    template <class T>
    [[nodiscard]] std::vector<T> get_all() {
        std::vector<T> values(get_count(sizeof(T)));
        copy(values.data(), values.size());
        return values;
    }
    [[nodiscard]] std::string get_text() {
        std::string text(get_count(1), '\0');
        copy(text.data(), text.size());
        return text;
    }
    void require(bool condition) { ok_ = ok_ && condition; }
    [[nodiscard]] bool ok() const { return ok_; }
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

private:
    template <class T>
    void copy(T* to, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        ok_ = ok_ && count <= bytes_.size() / sizeof(T);
        if (!ok_ || count == 0) return;
        std::memcpy(static_cast<void*>(to), bytes_.data(), count * sizeof(T));
        bytes_ = bytes_.subspan(count * sizeof(T));
    }
    std::span<const std::byte> bytes_;
    bool ok_ = true;
};

void put(Writer& writer, const Material& material) {
    writer.put_text(material.name);
    writer.put(material.base_color);
    writer.put(material.opacity);
    writer.put(material.specular);
    writer.put(material.shininess);
}

Material get_material(Reader& reader) {
    Material material;
    material.name = reader.get_text();
    material.base_color = reader.get<glm::vec3>();
    material.opacity = reader.get<float>();
    material.specular = reader.get<float>();
    material.shininess = reader.get<float>();
    return material;
}

void put(Writer& writer, const SoupMesh& mesh) {
    writer.put_text(mesh.name);
    writer.put(mesh.material);
    writer.put_all(mesh.positions);
    writer.put_all(mesh.precise_positions);
    writer.put_all(mesh.normals);
    writer.put_all(mesh.colors);
    writer.put_all(mesh.polygon_sizes);
    writer.put_all(mesh.corners);
    writer.put_all(mesh.normal_corners);
    writer.put(std::uint32_t{mesh.has_polygon_normals});
}

SoupMesh get_mesh(Reader& reader, std::size_t materials) {
    SoupMesh mesh;
    mesh.name = reader.get_text();
    mesh.material = reader.get<std::uint32_t>();
    mesh.positions = reader.get_all<glm::vec3>();
    mesh.precise_positions = reader.get_all<glm::dvec3>();
    mesh.normals = reader.get_all<glm::vec3>();
    mesh.colors = reader.get_all<glm::vec4>();
    mesh.polygon_sizes = reader.get_all<std::uint32_t>();
    mesh.corners = reader.get_all<std::uint32_t>();
    mesh.normal_corners = reader.get_all<std::uint32_t>();
    mesh.has_polygon_normals = reader.get<std::uint32_t>() != 0;
    reader.require(mesh.material == kNone || mesh.material < materials);
    reader.require(mesh.positions.empty() || mesh.precise_positions.empty());
    const std::size_t normals = mesh.normals.size();
    if (mesh.has_polygon_normals) {
        reader.require(mesh.normal_corners.empty() && normals == mesh.polygon_sizes.size());
    } else if (mesh.normal_corners.empty()) {
        reader.require(normals == 0 || normals == mesh.position_count());
    } else {
        reader.require(mesh.normal_corners.size() == mesh.corners.size());
        reader.require(std::ranges::all_of(
            mesh.normal_corners, [&](auto index) { return index < normals || index == kNone; }));
    }
    reader.require(mesh.colors.empty() || mesh.colors.size() == mesh.position_count());
    reader.require(std::ranges::all_of(mesh.polygon_sizes, [](auto size) { return size >= 3; }));
    reader.require(std::accumulate(mesh.polygon_sizes.begin(), mesh.polygon_sizes.end(),
                                   std::uint64_t{0}) == mesh.corners.size());
    return mesh;
}

void put(Writer& writer, const SoupObject& object) {
    writer.put_text(object.name);
    writer.put(object.mesh);
    writer.put(object.transform);
}

SoupObject get_object(Reader& reader, std::size_t meshes) {
    SoupObject object;
    object.name = reader.get_text();
    object.mesh = reader.get<std::uint32_t>();
    object.transform = reader.get<glm::dmat4>();
    reader.require(object.mesh < meshes);
    return object;
}

// Bytes that the smallest thing of each kind takes: bounds what a count may ask for.
constexpr std::size_t kLeastText = 8;
constexpr std::size_t kLeastMaterial = 8 + sizeof(glm::vec3) + 3 * sizeof(float);
constexpr std::size_t kLeastMesh = 8 + sizeof(std::uint32_t) + 7 * 8;
constexpr std::size_t kLeastObject = 8 + sizeof(std::uint32_t) + sizeof(glm::dmat4);

}  // namespace

std::vector<std::byte> serialise(const Soup& soup) {
    Writer writer;
    writer.put(kMagic);
    writer.put(std::uint8_t{soup.srgb_colors});
    writer.put(soup.ignored_primitives);
    writer.put(std::uint64_t{soup.notes.size()});
    for (const std::string& note : soup.notes) writer.put_text(note);
    writer.put(std::uint64_t{soup.files.size()});
    for (const std::string& file : soup.files) writer.put_text(file);
    writer.put(std::uint64_t{soup.materials.size()});
    for (const Material& material : soup.materials) put(writer, material);
    writer.put(std::uint64_t{soup.meshes.size()});
    for (const SoupMesh& mesh : soup.meshes) put(writer, mesh);
    writer.put(std::uint64_t{soup.objects.size()});
    for (const SoupObject& object : soup.objects) put(writer, object);
    return writer.take();
}

std::optional<Soup> deserialise(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    Soup soup;
    reader.require(reader.get<std::uint64_t>() == kMagic);
    soup.srgb_colors = reader.get<std::uint8_t>() != 0;
    soup.ignored_primitives = reader.get<std::uint64_t>();
    for (std::size_t n = reader.get_count(kLeastText); n > 0 && reader.ok(); --n) {
        soup.notes.push_back(reader.get_text());
    }
    for (std::size_t n = reader.get_count(kLeastText); n > 0 && reader.ok(); --n) {
        soup.files.push_back(reader.get_text());
    }
    for (std::size_t n = reader.get_count(kLeastMaterial); n > 0 && reader.ok(); --n) {
        soup.materials.push_back(get_material(reader));
    }
    for (std::size_t n = reader.get_count(kLeastMesh); n > 0 && reader.ok(); --n) {
        soup.meshes.push_back(get_mesh(reader, soup.materials.size()));
    }
    for (std::size_t n = reader.get_count(kLeastObject); n > 0 && reader.ok(); --n) {
        soup.objects.push_back(get_object(reader, soup.meshes.size()));
    }
    if (!reader.ok() || !reader.at_end()) return std::nullopt;
    return soup;
}

}  // namespace sightline::load
