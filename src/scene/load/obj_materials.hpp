// The materials of an OBJ file: its MTL files and what it uses without defining it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/load/reader.hpp"
#include "sightline/scene.hpp"

namespace sightline::load {

class ObjMaterials {
public:
    /// No MTL file is read for an OBJ file in memory.
    explicit ObjMaterials(const ReadContext& context) : context_(context) {}

    /// Reads the files that a mtllib line names: one name with spaces, else several without, else
    /// the OBJ file's own name with the extension mtl. A file is read once, however often it is
    /// named. Those that are missing or not allowed are noted. Errors: the limits on reading.
    [[nodiscard]] Status load(std::string_view names);

    /// Takes the definitions (newmtl, Kd, d, Tr) of an MTL file; what can't be read is skipped. A
    /// name that is known already gets the new values.
    void parse(std::string_view text);

    /// Index of a material, made when there is none of this name.
    [[nodiscard]] std::uint32_t use(std::string_view name);

    [[nodiscard]] const std::string& name(std::uint32_t material) const {
        return materials_[material].name;
    }
    /// All of them, in order of definition or first use. An opacity of 0 has become 1, and black
    /// grey where a texture was to give the colour.
    [[nodiscard]] std::vector<Material> take();
    /// Paths of the material libraries, those that were not read among them, and of the textures
    /// that they may name.
    [[nodiscard]] std::vector<std::string> files() const;
    /// What had no effect: files that are missing, textures. See Soup::notes.
    [[nodiscard]] std::vector<std::string> notes() const;

private:
    enum class Outcome { read, missing, outside, unreadable, utf16 };

    Outcome load_named(std::string_view name);
    Outcome load_file(const std::filesystem::path& file);
    Outcome load_words(std::string_view names);
    void add_texture(const std::string& statement);
    void note(std::string_view name, Outcome outcome);
    [[nodiscard]] std::string_view reason(Outcome outcome) const;

    const ReadContext& context_;
    std::vector<Material> materials_;
    std::vector<bool> textured_;  ///< whether a material has a texture for its colour
    std::map<std::string, std::uint32_t, std::less<>> numbers_;
    std::set<std::string, std::less<>> lines_;  ///< what mtllib lines have named so far
    std::set<std::string> files_;               ///< MTL files that were opened, without links
    std::uint64_t bytes_ = 0;                   ///< in those
    std::map<std::string, Outcome> not_read_;
    std::set<std::string> refused_;        ///< paths of MTL files that may not be read
    std::filesystem::path folder_;         ///< of the MTL file that is being read
    std::set<std::string> textures_;       ///< for messages
    std::set<std::string> texture_files_;  ///< paths
};

}  // namespace sightline::load
