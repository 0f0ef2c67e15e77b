#include "scene/load/named_files.hpp"

#include <algorithm>
#include <system_error>

#include "scene/load/input.hpp"

namespace sightline::load {
namespace {

namespace fs = std::filesystem;

bool lies_in(const fs::path& file, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
           folder.end();
}

}  // namespace

NamedFiles::NamedFiles(const std::string& model, const std::vector<std::string>& allowed) {
    std::error_code error;
    if (!model.empty()) {
        const fs::path folder = fs::canonical(fs::absolute(model).parent_path(), error);
        if (!error) folders_ = {folder, folder.parent_path() / "textures"};
    }
    for (const std::string& name : allowed) {
        const fs::path folder = fs::canonical(name, error);
        if (!error) folders_.push_back(folder);
    }
}

NamedFiles::Verdict NamedFiles::judge(const fs::path& file) const {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(fs::absolute(file, error), error);
    if (error) return Verdict::missing;
    if (std::ranges::none_of(folders_, [&](const fs::path& f) { return lies_in(real, f); })) {
        return Verdict::outside;
    }
    const fs::file_status status = fs::status(real, error);
    if (!fs::exists(status)) return Verdict::missing;
    const bool readable = fs::is_regular_file(status) && !is_kernel_file(real.string());
    return readable ? Verdict::readable : Verdict::special;
}

}  // namespace sightline::load
