// The files that assimp may open: the model, and what it names as far as NamedFiles allows it.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <set>
#include <string>

#include "scene/load/named_files.hpp"

namespace sightline::load {

class AssimpFiles : public Assimp::DefaultIOSystem {
public:
    /// Names of files beside the model: those that are there or lie outside, and some of those that
    /// may not be opened.
    struct Names {
        std::set<std::string> asked_for, refused;
    };

    /// assimp sees the model at `path` under the name `alias`, whose extension is its format.
    /// `names` must outlive this.
    AssimpFiles(std::string alias, std::string path, NamedFiles named, Names& names)
        : alias_(std::move(alias)),
          path_(std::move(path)),
          named_(std::move(named)),
          names_(names) {}

    bool Exists(const char* file) const override;
    /// For reading only.
    Assimp::IOStream* Open(const char* file, const char* mode) override;

private:
    [[nodiscard]] Assimp::IOStream* open_model(const char* mode);
    [[nodiscard]] bool may_open(const std::string& file) const;

    std::string alias_, path_;
    NamedFiles named_;
    Names& names_;
};

}  // namespace sightline::load
