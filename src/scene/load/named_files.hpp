// Which files a model may name: its material libraries, buffers and textures.
//
// A model may come from anybody, so what it names is opened only where a model's own files belong:
// in its folder, below it, in the folder `textures` beside that folder, and where the user allows
// it. What counts is where a file lies after all links are followed. Devices, pipes and the files
// of the kernel are never opened.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::load {

/// Why a file is not read that lies elsewhere, and the way out; follows its name in a message.
inline constexpr std::string_view kOutsideReason =
    "lies outside of the model's folder and is not read (allow its folder with --allow-path DIR)";

class NamedFiles {
public:
    /// `model` is the path of the model, "" when it has none: then it may name only files in the
    /// folders of `allowed`.
    NamedFiles(const std::string& model, const std::vector<std::string>& allowed);

    enum class Verdict {
        readable,  ///< a regular file at a place that is allowed
        missing,   ///< nothing is there, at a place that is allowed
        outside,   ///< a place that is not allowed; whether anything is there is not told
        special,   ///< a folder, device, pipe or file of the kernel
    };
    [[nodiscard]] Verdict judge(const std::filesystem::path& file) const;

private:
    std::vector<std::filesystem::path> folders_;  ///< without links
};

}  // namespace sightline::load
