#include "scene/load/assimp_files.hpp"

#include <string_view>

namespace sightline::load {

bool AssimpFiles::may_open(const std::string& file) const {
    constexpr std::size_t kMostNoted = 20;
    const NamedFiles::Verdict verdict = named_.judge(file);
    const bool refused =
        verdict == NamedFiles::Verdict::outside || verdict == NamedFiles::Verdict::special;
    if (refused && refused_.size() < kMostNoted) refused_.insert(file);
    return verdict == NamedFiles::Verdict::readable;
}

bool AssimpFiles::Exists(const char* file) const {
    if (file == alias_) return DefaultIOSystem::Exists(path_.c_str());
    return may_open(file);
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
    if (!std::string_view(mode).starts_with('r')) return nullptr;
    if (file == alias_) return DefaultIOSystem::Open(path_.c_str(), mode);
    return may_open(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
}

}  // namespace sightline::load
