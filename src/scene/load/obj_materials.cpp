#include "scene/load/obj_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "scene/load/input.hpp"
#include "scene/load/scan.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kLargestFile = std::size_t{64} << 20;

/// Kd of a material that does not state it, as a display colour.
constexpr float kDefaultDiffuse = 0.6f;

/// Up to three numbers of a line; how many there are.
std::size_t scan_numbers(const char* p, std::array<float, 3>& numbers) {
    std::size_t count = 0;
    for (p = skip_blanks(p); count < 3 && !is_line_end(*p); p = skip_blanks(p)) {
        const char* const end = scan_real(p, numbers[count]);
        if (end == nullptr) break;
        p = end;
        ++count;
    }
    return count;
}

void apply_line(const char* p, Material& material) {
    std::array<float, 3> n{};
    if (starts_with_word(p, "d")) {
        p = skip_blanks(p + 1);
        if (starts_with_word(p, "-halo")) p += 5;
        if (scan_numbers(p, n) > 0) material.opacity = n[0];
    } else if (*p == 'T' && starts_with_word(p + 1, "r")) {
        if (scan_numbers(p + 2, n) > 0) material.opacity = 1 - n[0];
    } else if (*p == 'K' && starts_with_word(p + 1, "d")) {
        const std::size_t count = scan_numbers(p + 2, n);
        if (count == 0) return;
        // Green and blue are the same as red when they are left out.
        material.base_color = count == 3 ? glm::vec3(n[0], n[1], n[2]) : glm::vec3(n[0]);
    }
}

/// Whether a line names a texture: map_Kd and its like, and what older programs write.
bool names_texture(const char* p) {
    constexpr std::array kKeywords = {"bump", "disp", "decal", "refl", "norm"};
    const std::string_view first(p, static_cast<std::size_t>(skip_word(p) - p));
    return first.starts_with("map_") || std::ranges::any_of(kKeywords, [&](const char* word) {
               return starts_with_word(p, word);
           });
}

/// The name of the file stands after its options.
std::string_view last_word(std::string_view line) {
    const std::size_t blank = line.find_last_of(" \t");
    return blank == std::string_view::npos ? line : line.substr(blank + 1);
}

}  // namespace

void ObjMaterials::load(std::string_view names) {
    if (names.empty() || load_file(names)) return;
    bool found = false;
    std::set<std::string> missing;
    for (std::string_view rest = names; !rest.empty();) {
        const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
        if (end > 0 && end < names.size()) {
            const bool here = load_file(rest.substr(0, end));
            if (!here) missing.emplace(rest.substr(0, end));
            found = found || here;
        }
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (found) {
        missing_.merge(missing);
    } else if (!load_file(std::filesystem::path(path_).stem().string() + ".mtl")) {
        missing_.emplace(names);
    }
}

bool ObjMaterials::load_file(std::string_view name) {
    if (path_.empty()) return false;
    std::string portable(name);
    std::ranges::replace(portable, '\\', '/');
    const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
    for (const std::string_view candidate : {name, std::string_view(portable)}) {
        const std::filesystem::path file = folder / candidate;
        std::error_code ignored;
        // Nothing that could block, such as a pipe.
        if (!std::filesystem::is_regular_file(file, ignored)) continue;
        const Result<InputFile> input = InputFile::open(file.string(), kLargestFile);
        if (!input) continue;
        const Result<std::vector<std::byte>> bytes = input->read_all();
        if (!bytes) continue;
        libraries_.insert(file.string());
        parse({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
        return true;
    }
    return false;
}

void ObjMaterials::parse(std::string_view text) {
    const std::string lines = std::string(text) + '\n';
    std::uint32_t current = kNone;
    for (const char *p = lines.data(), *const end = p + lines.size(); p < end;) {
        p = skip_blanks(p);
        if (starts_with_word(p, "newmtl")) {
            current = use(rest_of_line(p + 6));
        } else if (current != kNone) {
            apply_line(p, materials_[current]);
            if (names_texture(p)) textures_.emplace(last_word(rest_of_line(skip_word(p))));
        }
        p = skip_to_line_end(p) + 1;
    }
}

std::uint32_t ObjMaterials::use(std::string_view name) {
    const auto known = numbers_.find(name);
    if (known != numbers_.end()) return known->second;
    const auto number = static_cast<std::uint32_t>(materials_.size());
    Material material;
    material.name = name;
    material.base_color = glm::vec3(kDefaultDiffuse);
    materials_.push_back(std::move(material));
    numbers_.emplace(name, number);
    return number;
}

std::vector<std::string> ObjMaterials::notes() const {
    std::vector<std::string> notes;
    for (const std::string& name : missing_) {
        notes.push_back(fmt::format("the material library '{}' {}; its materials are grey",
                                    one_line(name),
                                    path_.empty() ? "can't be read, as the model comes without a "
                                                    "folder"
                                                  : "is missing"));
    }
    if (!textures_.empty()) notes.push_back(note_of_textures(textures_));
    return notes;
}

std::vector<std::string> ObjMaterials::files() const {
    std::vector<std::string> files(libraries_.begin(), libraries_.end());
    for (const std::string& name : textures_) files.push_back(path_beside(path_, name));
    return files;
}

std::vector<Material> ObjMaterials::take() {
    for (Material& material : materials_) {
        if (!(material.opacity > 0)) material.opacity = 1;
    }
    return std::move(materials_);
}

}  // namespace sightline::load
