#include "scene/load/obj_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "scene/load/input.hpp"
#include "scene/load/scan.hpp"
#include "scene/load/text.hpp"
#include "scene/load/texture_names.hpp"

namespace sightline::load {
namespace {

constexpr std::size_t kLargestFile = std::size_t{64} << 20;

/// Memory that a name in a set takes beside its characters.
constexpr std::size_t kBytesPerName = 80;

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
    constexpr std::string_view kMap = "map";
    const std::string_view first(p, static_cast<std::size_t>(skip_word(p) - p));
    const auto same = [](char lower, char c) { return c == lower || c == lower - 'a' + 'A'; };
    const bool is_map = first.size() > kMap.size() && first[kMap.size()] == '_' &&
                        std::equal(kMap.begin(), kMap.end(), first.begin(), same);
    return is_map || std::ranges::any_of(
                         kKeywords, [&](const char* word) { return starts_with_word(p, word); });
}

/// The rest of a line, and of the next ones while each is continued by a backslash. `end` is that
/// of the text.
std::string rest_of_statement(const char* p, const char* end) {
    constexpr int kMostLines = 16;
    std::string rest(rest_of_line(p));
    for (int line = 1; line < kMostLines && rest.ends_with('\\'); ++line) {
        p = skip_to_line_end(p);
        p += *p == '\r' && p + 1 < end && p[1] == '\n' ? 2 : 1;
        if (p >= end) break;
        rest.back() = ' ';
        rest += rest_of_line(p);
    }
    return rest;
}

}  // namespace

Status ObjMaterials::load(std::string_view names) {
    if (names.empty() || !lines_.emplace(names).second) return success();
    if (context_.path().empty()) {
        note(names, Outcome::missing);
    } else if (const Outcome whole = load_named(names); whole != Outcome::read) {
        if (load_words(names) != Outcome::read) {
            const std::string own = stem_of(context_.path()) + ".mtl";
            if (load_named(own) != Outcome::read || whole == Outcome::outside) note(names, whole);
        }
    }
    return context_.check(bytes_ + materials_.size() * sizeof(Material));
}

/// Reads the files that a line names if it is several; whether one of them is there.
ObjMaterials::Outcome ObjMaterials::load_words(std::string_view names) {
    if (names.find_first_of(" \t") == std::string_view::npos) return Outcome::missing;
    std::map<std::string, Outcome> not_read;
    bool found = false;
    for (std::string_view rest = names; !rest.empty();) {
        const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
        if (end > 0) {
            const Outcome outcome = load_named(rest.substr(0, end));
            if (outcome == Outcome::read) {
                found = true;
            } else {
                not_read.emplace(rest.substr(0, end), outcome);
            }
        }
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (!found) return Outcome::missing;
    for (const auto& [name, outcome] : not_read) note(name, outcome);
    return Outcome::read;
}

/// Reads a file by its name as it stands, as other systems mean it, or beside the model when it
/// lies nowhere else: other people's folders are not here.
ObjMaterials::Outcome ObjMaterials::load_named(std::string_view name) {
    const std::string portable = portable_path(name);
    const std::filesystem::path folder = std::filesystem::path(context_.path()).parent_path();
    const bool quoted = name.size() > 2 && name.starts_with('"') && name.ends_with('"');
    Outcome outcome = Outcome::missing;
    for (const std::string_view candidate :
         {name, std::string_view(portable), last_component(portable),
          quoted ? name.substr(1, name.size() - 2) : std::string_view()}) {
        if (candidate.empty()) continue;
        const Outcome here = load_file(folder / candidate);
        if (here == Outcome::read) return here;
        if (here != Outcome::missing) outcome = here;
    }
    return outcome;
}

ObjMaterials::Outcome ObjMaterials::load_file(const std::filesystem::path& file) {
    switch (context_.named_files().judge(file)) {
        case NamedFiles::Verdict::missing:
            return Outcome::missing;
        case NamedFiles::Verdict::outside:
            refused_.insert(file.string());
            return Outcome::outside;
        case NamedFiles::Verdict::special:
            refused_.insert(file.string());
            return Outcome::unreadable;
        case NamedFiles::Verdict::readable:
            break;
    }
    std::error_code error;
    const std::string real = std::filesystem::canonical(file, error).string();
    if (error) return Outcome::missing;
    if (files_.contains(real)) return Outcome::read;
    refused_.insert(real);  // until it is read
    const Result<InputFile> input = InputFile::open(real, kLargestFile);
    if (!input) return Outcome::unreadable;
    const Result<std::vector<std::byte>> bytes = input->read_all();
    if (!bytes) return Outcome::unreadable;
    const std::string_view text = text_of(*bytes);
    refused_.erase(real);
    files_.insert(real);
    if (is_utf16(text)) {
        note(file.filename().string(), Outcome::utf16);
        return Outcome::read;
    }
    bytes_ += bytes->size();
    folder_ = file.parent_path();
    parse(text);
    return Outcome::read;
}

void ObjMaterials::note(std::string_view name, Outcome outcome) {
    constexpr std::size_t kMostNoted = 100;
    if (not_read_.size() < kMostNoted) not_read_.emplace(name, outcome);
}

void ObjMaterials::parse(std::string_view text) {
    const std::string lines = std::string(without_mark(text)) + '\n';
    std::uint32_t current = kNone;
    for (const char *p = lines.data(), *const end = p + lines.size(); p < end;) {
        p = skip_blanks(p);
        if (starts_with_word(p, "newmtl")) {
            current = use(rest_of_line(p + 6));
        } else if (current != kNone) {
            apply_line(p, materials_[current]);
            if (starts_with_word(p, "map_kd")) textured_[current] = true;
        }
        if (names_texture(p)) add_texture(rest_of_statement(skip_word(p), end));
        p = skip_to_line_end(p) + 1;
    }
}

/// Programs disagree on whether a name is relative to the MTL file or to the OBJ file.
void ObjMaterials::add_texture(const std::string& statement) {
    const std::vector<std::string> names = names_in_map(statement);
    if (names.empty()) return;
    textures_.insert(names.front());
    // At the limit load() gives up.
    if (context_.path().empty() || !context_.check(bytes_)) return;
    const std::filesystem::path own = std::filesystem::path(context_.path()).parent_path();
    for (const std::string& name : names) {
        for (const std::filesystem::path& folder : {folder_, own}) {
            for (std::string& place : places_of(folder, name)) {
                if (texture_files_.insert(place).second) bytes_ += kBytesPerName + place.size();
            }
        }
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
    textured_.push_back(false);
    numbers_.emplace(name, number);
    return number;
}

std::string_view ObjMaterials::reason(Outcome outcome) const {
    if (context_.path().empty()) return "can't be read, as the model comes without a folder";
    switch (outcome) {
        case Outcome::outside:
            return kOutsideReason;
        case Outcome::unreadable:
            return "is not a file of at most 64 MiB that may be read";
        case Outcome::utf16:
            return kUtf16Reason;
        default:
            return "is missing";
    }
}

std::vector<std::string> ObjMaterials::notes() const {
    std::vector<std::string> notes;
    for (const auto& [name, outcome] : not_read_) {
        notes.push_back(fmt::format("the material library '{}' {}; its materials are grey",
                                    one_line(name), reason(outcome)));
    }
    if (!textures_.empty()) notes.push_back(note_of_textures(textures_));
    return notes;
}

std::vector<std::string> ObjMaterials::files() const {
    std::vector<std::string> files(files_.begin(), files_.end());
    files.insert(files.end(), refused_.begin(), refused_.end());
    files.insert(files.end(), texture_files_.begin(), texture_files_.end());
    return files;
}

std::vector<Material> ObjMaterials::take() {
    for (std::size_t i = 0; i < materials_.size(); ++i) {
        Material& material = materials_[i];
        if (!(material.opacity > 0)) material.opacity = 1;
        if (textured_[i] && material.base_color == glm::vec3(0)) {
            material.base_color = glm::vec3(kDefaultDiffuse);
        }
    }
    return std::move(materials_);
}

}  // namespace sightline::load
