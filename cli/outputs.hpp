// The files a command writes: checked before any work, and all of them or none appear.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/temporary_file.hpp"
#include "options.hpp"
#include "sightline/image.hpp"
#include "sightline/vector.hpp"

namespace sightline::cli {

/// Where a file goes, whatever is in it.
struct OutputPlace {
    std::string option;  ///< "--depth", for messages
    std::string path;    ///< "-" is standard output
};

/// Format: ImageFormat or VectorFormat.
template <class Format>
struct OutputOf : OutputPlace {
    Format format = Format::png;
};
using Output = OutputOf<ImageFormat>;
using VectorOutput = OutputOf<VectorFormat>;

/// An option that names an output; its format follows the extension, or --output-format for "-".
template <class Format>
std::optional<OutputOf<Format>> read_output(OptionReader& reader, std::string_view option,
                                            std::span<const Format> allowed);

/// An output that is an input or is in the way of --json, a missing folder, a folder without
/// permission: reported before any work.
void check_output(OptionReader& reader, const OutputPlace& output,
                  std::span<const std::string> inputs);

/// A report on standard output that goes into one of the files ("-": into what standard input comes
/// from) that the run reads or writes.
void check_report(OptionReader& reader, std::span<const std::string> files);

/// check_output() for each, and two outputs in one place.
void check_outputs(OptionReader& reader, std::span<const Output> outputs,
                   std::span<const std::string> inputs);

/// OpenEXR compresses on a pool of threads of its own, which is the program's to fill: the library
/// leaves it alone. The bytes are the same. 0 = all cores.
void use_exr_threads(int threads);

/// Files that appear together: several of them are written beside their targets under temporary
/// names, and renamed when every one of them is complete.
class OutputBatch {
public:
    explicit OutputBatch(std::vector<Output> outputs);

    /// In the order in which they are to be completed: streams last, which can't be taken back.
    [[nodiscard]] std::span<const Output> outputs() const { return outputs_; }
    /// Where outputs()[i] is to be written.
    [[nodiscard]] const std::string& path(std::size_t i) const;
    /// Gives all files their names. After an error that `written` has, nothing of them is left, and
    /// its message names the files as the user does.
    [[nodiscard]] Status publish(Status written);

private:
    std::vector<Output> outputs_;
    std::vector<TemporaryFile> staged_;  // of the first outputs, if any
};

}  // namespace sightline::cli
