#include "scene/load/assimp_files.hpp"

#include <assimp/MemoryIOWrapper.h>

#include <cstdint>
#include <string_view>

#include "scene/load/text.hpp"

namespace sightline::load {

bool AssimpFiles::may_open(const std::string& file) const {
    constexpr std::size_t kMostNoted = 20;
    const NamedFiles::Verdict verdict = named_.judge(file);
    if (verdict != NamedFiles::Verdict::missing) names_.asked_for.insert(file);
    const bool refused =
        verdict == NamedFiles::Verdict::outside || verdict == NamedFiles::Verdict::special;
    if (refused && names_.refused.size() < kMostNoted) names_.refused.insert(file);
    return verdict == NamedFiles::Verdict::readable;
}

/// The model, without a byte order mark: not all of assimp's readers skip it.
Assimp::IOStream* AssimpFiles::open_model(const char* mode) {
    Assimp::IOStream* const stream = DefaultIOSystem::Open(path_.c_str(), mode);
    if (stream == nullptr) return nullptr;
    std::string beginning(3, '\0');
    beginning.resize(stream->Read(beginning.data(), 1, beginning.size()));
    stream->Seek(0, aiOrigin_SET);
    if (without_mark(beginning).size() == beginning.size()) return stream;
    const std::size_t size = stream->FileSize() - beginning.size();
    auto* const text = new std::uint8_t[size];  // the new stream deletes it
    stream->Seek(beginning.size(), aiOrigin_SET);
    const std::size_t read = stream->Read(text, 1, size);
    Close(stream);
    return new Assimp::MemoryIOStream(text, read, true);
}

bool AssimpFiles::Exists(const char* file) const {
    if (file == alias_) return DefaultIOSystem::Exists(path_.c_str());
    return may_open(file);
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
    if (!std::string_view(mode).starts_with('r')) return nullptr;
    if (file == alias_) return open_model(mode);
    if (!may_open(file)) return nullptr;
    return DefaultIOSystem::Open(file, mode);
}

}  // namespace sightline::load
