// The materials of an OBJ file: its MTL files and what it uses without defining it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/scene.hpp"

namespace sightline::load {

class ObjMaterials {
public:
    /// `path` is the OBJ file's, "" when it is in memory: then no MTL file is read.
    explicit ObjMaterials(std::string path) : path_(std::move(path)) {}

    /// Reads the files that a mtllib line names: one name with spaces, else several without, else
    /// the OBJ file's own name with the extension mtl. Those that are missing are noted.
    void load(std::string_view names);

    /// Takes the definitions (newmtl, Kd, d, Tr) of an MTL file; what can't be read is skipped. A
    /// name that is known already gets the new values.
    void parse(std::string_view text);

    /// Index of a material, made when there is none of this name.
    [[nodiscard]] std::uint32_t use(std::string_view name);

    [[nodiscard]] const std::string& name(std::uint32_t material) const {
        return materials_[material].name;
    }
    /// All of them, in order of definition or first use. An opacity of 0 has become 1.
    [[nodiscard]] std::vector<Material> take();
    /// Paths of the material libraries that were read and of the textures that they name.
    [[nodiscard]] std::vector<std::string> files() const;
    /// What had no effect: files that are missing, textures. See Soup::notes.
    [[nodiscard]] std::vector<std::string> notes() const;

private:
    bool load_file(std::string_view name);

    std::string path_;
    std::vector<Material> materials_;
    std::map<std::string, std::uint32_t, std::less<>> numbers_;
    std::set<std::string> missing_, textures_, libraries_;
};

}  // namespace sightline::load
