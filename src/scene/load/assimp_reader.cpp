// assimp does not triangulate or join here, and bakes no transform: with its own passes switched
// off a file's meshes, faces and vertices arrive as they were stored.
#include "scene/load/assimp_reader.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <string_view>

#include "scene/load/assimp_files.hpp"
#include "scene/load/gltf_document.hpp"
#include "scene/load/input.hpp"
#include "scene/load/off_colors.hpp"
#include "scene/load/text.hpp"
#include "scene/load/texture_names.hpp"

namespace sightline::load {
namespace {

/// Keeps the last error that assimp logs while it goes on reading.
class ErrorLog : public Assimp::LogStream {
public:
    void write(const char* message) override {
        const std::string_view text = message;  // "Error, T0: OFF: ..."
        const std::size_t prefix = text.find(": ");
        last = one_line(text.substr(prefix == std::string_view::npos ? 0 : prefix + 2));
    }
    std::string last;
};

/// assimp logs that a count or an index in such a file is wrong, makes up something and goes on.
bool logged_errors_count(const std::string& format) { return format == "off"; }

bool is_linear(const std::string& format) {
    return format == "gltf" || format == "glb" || format == "vrm";
}

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
    // glm's constructor takes columns.
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
            m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

/// How opaque a material is: glTF says by its mode whether alpha counts at all. In other formats a
/// surface that nobody could ever see (opacity 0) is a known fault of exporters.
float opacity_of(const aiMaterial& material, float alpha) {
    aiString mode;
    if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
        return std::string_view(mode.C_Str()) == "BLEND" ? alpha : 1.0f;
    }
    float opacity = 1;
    material.Get(AI_MATKEY_OPACITY, opacity);
    return opacity > 0 ? opacity : 1.0f;
}

Material material_of(const aiMaterial& from) {
    Material material;
    material.name = from.GetName().C_Str();
    aiColor4D color(1, 1, 1, 1);
    if (from.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
        from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
        material.base_color = {color.r, color.g, color.b};
    }
    material.opacity = opacity_of(from, color.a);
    return material;
}

/// assimp invents a material for files that have none; ours is to be used instead.
bool is_invented(const aiMaterial& material) {
    return std::string_view(material.GetName().C_Str()) == AI_DEFAULT_MATERIAL_NAME;
}

void collect_textures(const aiMaterial& material, std::set<std::string>& names) {
    for (unsigned type = 1; type <= AI_TEXTURE_TYPE_MAX; ++type) {
        const auto kind = static_cast<aiTextureType>(type);
        for (unsigned i = 0; i < material.GetTextureCount(kind); ++i) {
            aiString path;
            if (material.GetTexture(kind, i, &path) == aiReturn_SUCCESS)
                names.emplace(path.C_Str());
        }
    }
}

/// The names of the textures of all materials that are not invented.
std::set<std::string> textures_of(const aiScene& scene) {
    std::set<std::string> names;
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
        const aiMaterial* const material = scene.mMaterials[i];
        if (material != nullptr && !is_invented(*material)) collect_textures(*material, names);
    }
    return names;
}

void append_faces(const aiMesh& from, SoupMesh& mesh, std::uint64_t& ignored) {
    mesh.polygon_sizes.reserve(from.mNumFaces);
    mesh.corners.reserve(std::size_t{3} * from.mNumFaces);
    for (unsigned f = 0; f < from.mNumFaces && from.mFaces != nullptr; ++f) {
        const aiFace& face = from.mFaces[f];
        if (face.mNumIndices < 3 || face.mIndices == nullptr) {
            ++ignored;
            continue;
        }
        mesh.polygon_sizes.push_back(face.mNumIndices);
        mesh.corners.insert(mesh.corners.end(), face.mIndices, face.mIndices + face.mNumIndices);
    }
}

/// glTF materials that don't blend take no alpha from the vertices either.
bool ignores_alpha(const aiMaterial& material) {
    aiString mode;
    return material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS &&
           std::string_view(mode.C_Str()) != "BLEND";
}

SoupMesh mesh_of(const aiMesh& from, std::uint64_t& ignored) {
    SoupMesh mesh;
    mesh.name = from.mName.C_Str();
    if (from.mVertices == nullptr) return mesh;
    append_faces(from, mesh, ignored);
    const auto vector_of = [](const aiVector3D& v) { return glm::vec3(v.x, v.y, v.z); };
    mesh.positions.resize(from.mNumVertices);
    std::transform(from.mVertices, from.mVertices + from.mNumVertices, mesh.positions.begin(),
                   vector_of);
    if (from.mNormals != nullptr) {
        mesh.normals.resize(from.mNumVertices);
        std::transform(from.mNormals, from.mNormals + from.mNumVertices, mesh.normals.begin(),
                       vector_of);
    }
    if (from.mColors[0] != nullptr) {
        mesh.colors.resize(from.mNumVertices);
        std::transform(from.mColors[0], from.mColors[0] + from.mNumVertices, mesh.colors.begin(),
                       [](const aiColor4D& c) { return glm::vec4(c.r, c.g, c.b, c.a); });
    }
    return mesh;
}

/// The node's name if a user knows it (assimp invents names such as <STL_BINARY>), else the mesh's.
std::string object_name(const aiNode& node, const SoupMesh& mesh) {
    const std::string name = node.mName.C_Str();
    const bool own =
        !name.empty() && name.front() != '<' && (node.mNumMeshes == 1 || mesh.name.empty());
    return own ? name : mesh.name;
}

/// Appends the objects of a node and below it; whether nodes are missing there. Some readers leave
/// null pointers where they went wrong.
bool append_nodes(const aiNode& node, const glm::dmat4& above, Soup& soup) {
    const glm::dmat4 transform = above * matrix_of(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes && node.mMeshes != nullptr; ++i) {
        const std::uint32_t mesh = node.mMeshes[i];
        if (mesh >= soup.meshes.size()) continue;
        soup.objects.push_back({object_name(node, soup.meshes[mesh]), mesh, transform});
    }
    bool missing = false;
    for (unsigned i = 0; i < node.mNumChildren && node.mChildren != nullptr; ++i) {
        const aiNode* const child = node.mChildren[i];
        missing |= child == nullptr || append_nodes(*child, transform, soup);
    }
    return missing;
}

/// Where nodes are missing, meshes that stand at no node are objects as they are stored.
void append_lost_meshes(Soup& soup) {
    std::vector<bool> placed(soup.meshes.size());
    for (const SoupObject& object : soup.objects) placed[object.mesh] = true;
    for (std::uint32_t mesh = 0; mesh < soup.meshes.size(); ++mesh) {
        if (!placed[mesh]) soup.objects.push_back({soup.meshes[mesh].name, mesh, glm::dmat4(1.0)});
    }
}

void append_materials(const aiScene& scene, Soup& soup, std::vector<std::uint32_t>& numbers) {
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
        const aiMaterial* const material = scene.mMaterials[i];
        if (material == nullptr || is_invented(*material)) continue;
        numbers[i] = static_cast<std::uint32_t>(soup.materials.size());
        soup.materials.push_back(material_of(*material));
    }
}

/// The up axis that an FBX file states, such as "0,0,1"; y, which all else here has, when it states
/// none.
std::string up_axis_of(const aiScene& scene) {
    int axis = 1, sign = 1;
    if (scene.mMetaData != nullptr) {
        scene.mMetaData->Get("UpAxis", axis);
        scene.mMetaData->Get("UpAxisSign", sign);
    }
    const auto at = [&](int i) { return i != axis ? 0 : sign < 0 ? -1 : 1; };
    return fmt::format("{},{},{}", at(0), at(1), at(2));
}

/// Notes what a file holds that would shape its meshes and is not read.
void note_what_is_not_read(const aiScene& scene, Soup& soup) {
    unsigned skinned = 0, morphed = 0;
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        if (scene.mMeshes[i] == nullptr) continue;
        skinned += scene.mMeshes[i]->HasBones() ? 1 : 0;
        morphed += scene.mMeshes[i]->mNumAnimMeshes > 0 ? 1 : 0;
    }
    if (skinned > 0) {
        soup.notes.push_back(fmt::format(
            "bones are not read, so skinned meshes may look wrong: {}; export it posed", skinned));
    }
    if (morphed > 0) {
        soup.notes.push_back(
            fmt::format("morph targets are not read, so meshes stand without them: {}", morphed));
    }
    if (const std::string up = up_axis_of(scene); up != "0,1,0") {
        soup.notes.push_back(
            fmt::format("the file says that {0} is upwards, but y is here; give --up {0}", up));
    }
}

Soup soup_of(const aiScene& scene, const std::string& format) {
    Soup soup;
    soup.srgb_colors = !is_linear(format);
    std::vector<std::uint32_t> numbers(scene.mNumMaterials, kNone);
    append_materials(scene, soup, numbers);
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        soup.meshes.emplace_back();
        if (scene.mMeshes[i] == nullptr) continue;
        const aiMesh& mesh = *scene.mMeshes[i];
        soup.meshes.back() = mesh_of(mesh, soup.ignored_primitives);
        if (mesh.mMaterialIndex < numbers.size()) {
            const aiMaterial* const material = scene.mMaterials[mesh.mMaterialIndex];
            if (material != nullptr && ignores_alpha(*material))
                for (glm::vec4& color : soup.meshes.back().colors) color.a = 1;
            soup.meshes.back().material = numbers[mesh.mMaterialIndex];
        }
    }
    if (scene.mRootNode != nullptr && append_nodes(*scene.mRootNode, glm::dmat4(1.0), soup)) {
        append_lost_meshes(soup);
    }
    note_what_is_not_read(scene, soup);
    return soup;
}

/// The names of refused files, for a message.
std::string list_of(const std::set<std::string>& refused) {
    return fmt::format("'{}'{} {}", one_line(*refused.begin()), refused.size() > 1 ? ", ..." : "",
                       kOutsideReason);
}

/// All bytes of a model; none when they can't be read.
std::string bytes_of(const Source& source) {
    if (source.path.empty()) return std::string(text_of(source.bytes));
    constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max() / 2;
    const Result<InputFile> file = InputFile::open(source.path, kNoLimit);
    if (!file) return {};
    const Result<std::vector<std::byte>> bytes = file->read_all();
    return bytes ? std::string(text_of(*bytes)) : std::string();
}

/// An importer that is never destroyed: after some files that were read well, its destructor
/// crashes.
Assimp::Importer* new_importer() {
    static auto* const all = new std::vector<Assimp::Importer*>;  // so none counts as leaked
    all->push_back(new Assimp::Importer);
    return all->back();
}

/// Whether assimp took the file for glTF, by its content, whatever it is called.
bool was_read_as_gltf(const Assimp::Importer& importer) {
    const int index = importer.GetPropertyInteger("importerIndex", -1);
    const aiImporterDesc* const reader =
        index < 0 ? nullptr : importer.GetImporterInfo(static_cast<std::size_t>(index));
    return reader != nullptr && std::string_view(reader->mName).starts_with("glTF");
}

const aiScene* import(Assimp::Importer& importer, const Source& source, AssimpFiles::Names& names) {
    // Where there is nothing to show, assimp would draw the bones.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const std::vector<std::string> allowed(source.allowed_paths.begin(),
                                           source.allowed_paths.end());
    const bool named_so = extension_of(source.path) == source.format;
    const std::string alias = named_so ? source.path : source.path + "." + source.format;
    // The importer deletes it.
    importer.SetIOHandler(
        new AssimpFiles(alias, source.path, NamedFiles(source.path, allowed), names));
    if (!source.path.empty()) return importer.ReadFile(alias, 0);
    const std::string_view bytes = without_mark(text_of(source.bytes));
    return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, source.format.c_str());
}

}  // namespace

std::vector<std::string> assimp_extensions() {
    const Assimp::Importer importer;
    aiString all;
    importer.GetExtensionList(all);
    std::vector<std::string> extensions;
    std::string_view rest = all.C_Str();
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(';'), rest.size());
        const std::string_view pattern = rest.substr(0, end);
        extensions.emplace_back(pattern.substr(pattern.rfind('.') + 1));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    std::ranges::sort(extensions);
    extensions.erase(std::unique(extensions.begin(), extensions.end()), extensions.end());
    return extensions;
}

std::variant<Soup, std::string> read_with_assimp(const Source& source) {
    const bool is_gltf = is_linear(source.format);
    GltfDocument document;
    if (is_gltf) document = read_gltf_document(bytes_of(source));
    if (!document.fault.empty()) return document.fault;
    auto* const logger = Assimp::DefaultLogger::create(nullptr, Assimp::Logger::NORMAL, 0);
    auto* const errors = new ErrorLog;  // the logger deletes it
    logger->attachStream(errors, Assimp::Logger::Err);
    Assimp::Importer* const importer = new_importer();
    AssimpFiles::Names names;
    const aiScene* scene = import(*importer, source, names);
    const std::set<std::string>& refused = names.refused;
    if (scene == nullptr) {
        const std::string why = one_line(importer->GetErrorString());
        return refused.empty() ? why : fmt::format("{}; {}", why, list_of(refused));
    }
    if (!is_gltf && was_read_as_gltf(*importer)) {
        return "it looks like gltf, so rename it or give --format gltf";
    }
    if (logged_errors_count(source.format) && !errors->last.empty()) return errors->last;
    Soup soup = soup_of(*scene, source.format);
    // assimp tells only the textures of materials that it knows; a glTF file has others.
    const std::set<std::string> textures = is_gltf ? document.images : textures_of(*scene);
    if (!textures.empty()) soup.notes.insert(soup.notes.begin(), note_of_textures(textures));
    if (source.format == "off" && off_has_face_colors(bytes_of(source))) {
        soup.notes.emplace_back(kNoFaceColors);
    }
    if (!refused.empty()) soup.notes.push_back("the file " + list_of(refused));
    soup.files.assign(names.asked_for.begin(), names.asked_for.end());
    if (source.path.empty()) return soup;
    const std::filesystem::path folder = std::filesystem::path(source.path).parent_path();
    for (const auto& named : {textures_of(*scene), document.files}) {
        for (const std::string& name : named) {
            const std::vector<std::string> places = places_of(folder, name);
            soup.files.insert(soup.files.end(), places.begin(), places.end());
        }
    }
    return soup;
}

}  // namespace sightline::load
