// Output files. A single file is left to the library, which writes it under a temporary name and
// renames it. Several files need a second step: each is written completely under a name of ours
// before the first one is renamed, so that a disk that fills up leaves none of them.
#include "outputs.hpp"

#include <ImfThreading.h>
#include <sys/stat.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "errors.hpp"
#include "image/rename_all.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

namespace fs = std::filesystem;

std::string_view name_of(ImageFormat format) {
    switch (format) {
        case ImageFormat::png:
            return "png";
        case ImageFormat::exr:
            return "exr";
        case ImageFormat::npy:
            return "npy";
    }
    return "";
}

// What the two kinds of formats are called.
void parse_format(std::string_view name, std::optional<ImageFormat>& format) {
    format = parse_image_format(name);
}
void parse_format(std::string_view name, std::optional<VectorFormat>& format) {
    format = parse_vector_format(name);
}
void find_format(std::string_view path, std::optional<ImageFormat>& format) {
    format = image_format_of(path);
}
void find_format(std::string_view path, std::optional<VectorFormat>& format) {
    format = vector_format_of(path);
}

template <class Format>
std::string list_of(std::span<const Format> formats) {
    std::vector<std::string_view> names;
    for (const Format format : formats) names.push_back(name_of(format));
    return join(names);
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// The file that a path names, links followed; one spelling for one file.
fs::path identity(const std::string& path) {
    std::error_code ignored;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
    return whole.empty() ? fs::path(path) : whole;
}

bool is_device(const std::string& path) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Device and number of the file on a disk that a path names; "-" is a standard stream. Nothing
/// where there is no such file, but a pipe or a device.
std::optional<std::pair<dev_t, ino_t>> file_number(const std::string& path, int stream) {
    struct stat info {};
    const int failed = path == "-" ? fstat(stream, &info) : stat(path.c_str(), &info);
    if (failed != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
    return std::pair(info.st_dev, info.st_ino);
}

/// Whether standard output goes into a file that is called `path`; "-" is standard input.
bool takes_standard_output(const std::string& path) {
    const auto out = file_number("-", STDOUT_FILENO);
    return out && out == file_number(path, STDIN_FILENO);
}

/// Whether an output by that name overwrites what is read by the other.
bool overwrites(const std::string& output, const std::string& input) {
    if (output == "-") return takes_standard_output(input);
    if (is_device(output)) return false;
    if (input != "-") return identity(input) == identity(output);
    const auto in = file_number("-", STDIN_FILENO);
    return in && in == file_number(output, STDOUT_FILENO);
}

/// Whether two outputs, not both "-", end up in one file.
bool is_same_place(const std::string& a, const std::string& b) {
    if (a == "-") return takes_standard_output(b);
    if (b == "-") return takes_standard_output(a);
    return !is_device(a) && identity(a) == identity(b);
}

std::optional<Error> check_place(const OutputPlace& output) {
    if (output.path == "-") return std::nullopt;
    std::error_code ignored;
    const fs::path path(output.path), folder = folder_of(path);
    std::error_code gone;
    if (path.is_relative() && fs::current_path(gone).empty()) {
        return failure("{}: the working folder, where '{}' would lie, is gone; change to another",
                       output.option, output.path);
    }
    if (fs::is_directory(path, ignored)) {
        return failure("{}: '{}' is a folder; name a file in it", output.option, output.path);
    }
    if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored)) {
        return failure("{}: '{}' in '{}' is a file and no folder; write elsewhere", output.option,
                       folder.string(), output.path);
    }
    if (!fs::is_directory(folder, ignored)) {
        return failure("{}: the folder '{}' of '{}' does not exist; create it first", output.option,
                       folder.string(), output.path);
    }
    const bool exists = fs::exists(path, ignored);
    const bool writable = (exists && access(path.c_str(), W_OK) != 0)
                              ? false
                              : is_device(output.path) || access(folder.c_str(), W_OK | X_OK) == 0;
    if (!writable) {
        return failure("{}: no permission to write '{}'; choose another place", output.option,
                       output.path);
    }
    return std::nullopt;
}

/// Gives a complete temporary file the permissions of the file that it is to replace.
void take_permissions(const std::string& staged, const fs::path& target) {
    std::error_code ignored;
    const fs::file_status old = fs::status(target, ignored);
    if (fs::exists(old)) fs::permissions(staged, old.permissions(), ignored);
}

/// The message of the library with the name that the user gave.
Error with_name(Error error, const std::string& staged, const std::string& wanted) {
    for (std::size_t at; (at = error.message.find(staged)) != std::string::npos;) {
        error.message.replace(at, staged.size(), wanted);
    }
    return error;
}

}  // namespace

void use_exr_threads(int threads) {
    const int count = threads > 0 ? threads : tbb::info::default_concurrency();
    if (count > 1) Imf::setGlobalThreadCount(count);
}

template <class Format>
std::optional<OutputOf<Format>> read_output(OptionReader& reader, std::string_view option,
                                            std::span<const Format> allowed) {
    const Arguments& arguments = reader.arguments();
    const auto path = arguments.value(option);
    if (!path) return std::nullopt;
    const std::string_view shown = option == "--output" ? "-o" : option;
    const auto wanted = arguments.value("--output-format");
    std::optional<Format> format;
    if (path->empty()) {
        reader.fail(wrong_use("{}: the name of the file is empty", shown));
        return std::nullopt;
    }
    if (wanted && (*path == "-" || option == "--output")) {
        parse_format(*wanted, format);
    } else if (*path == "-") {
        reader.fail(wrong_use("{} - needs --output-format ({})", shown, list_of(allowed)));
        return std::nullopt;
    } else {
        find_format(*path, format);
    }
    if (!format || std::find(allowed.begin(), allowed.end(), *format) == allowed.end()) {
        const bool by_option = wanted && (*path == "-" || option == "--output");
        reader.fail(by_option ? wrong_use("--output-format: '{}' can't be written by {}; choose {}",
                                          *wanted, shown, list_of(allowed))
                              : wrong_use("{}: '{}' has no extension that can be written here; "
                                          "choose {}",
                                          shown, *path, list_of(allowed)));
        return std::nullopt;
    }
    return OutputOf<Format>{{std::string(shown), *path}, *format};
}

template std::optional<Output> read_output(OptionReader&, std::string_view,
                                           std::span<const ImageFormat>);
template std::optional<VectorOutput> read_output(OptionReader&, std::string_view,
                                                 std::span<const VectorFormat>);

void check_output(OptionReader& reader, const OutputPlace& output,
                  std::span<const std::string> inputs) {
    for (const std::string& input : inputs) {
        if (!overwrites(output.path, input)) continue;
        reader.fail(
            wrong_use("{}: '{}' is an input, which would be overwritten; choose another "
                      "name",
                      output.option, output.path == "-" ? input : output.path));
    }
    if (reader.arguments().has("--json") && output.path != "-") {
        check_report(reader, {&output.path, 1});
        check_report(reader, inputs);
    }
    if (auto error = check_place(output)) reader.fail(std::move(*error));
}

void check_report(OptionReader& reader, std::span<const std::string> files) {
    for (const std::string& file : files) {
        if (!takes_standard_output(file)) continue;
        reader.fail(
            wrong_use("standard output goes into '{}', which this run reads or writes "
                      "itself; send it elsewhere",
                      file));
    }
}

void check_outputs(OptionReader& reader, std::span<const Output> outputs,
                   std::span<const std::string> inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const Output& output = outputs[i];
        for (std::size_t j = 0; j < i; ++j) {
            const Output& other = outputs[j];
            if (output.path == "-" && other.path == "-") {
                reader.fail(wrong_use("{} and {} can't both go to standard output; give one a file",
                                      other.option, output.option));
            } else if (is_same_place(output.path, other.path)) {
                reader.fail(wrong_use(
                    "{} and {} name the same file '{}'; give them different names", other.option,
                    output.option, output.path == "-" ? other.path : output.path));
            }
        }
        check_output(reader, output, inputs);
    }
}

OutputBatch::OutputBatch(std::vector<Output> outputs) : outputs_(std::move(outputs)) {
    const auto is_stream = [](const Output& output) {
        return output.path == "-" || is_device(output.path);
    };
    const auto files =
        std::stable_partition(outputs_.begin(), outputs_.end(),
                              [&](const Output& output) { return !is_stream(output); }) -
        outputs_.begin();
    if (outputs_.size() == 1) return;
    for (std::ptrdiff_t i = 0; i < files; ++i) {
        const fs::path folder = folder_of(identity(outputs_[static_cast<std::size_t>(i)].path));
        staged_.emplace_back(folder.string());
    }
}

const std::string& OutputBatch::path(std::size_t i) const {
    return i < staged_.size() ? staged_[i].path() : outputs_[i].path;
}

Status OutputBatch::publish(Status written) {
    std::vector<Renaming> renamings;
    for (std::size_t i = 0; i < staged_.size(); ++i) {
        const std::string& staged = staged_[i].path();
        if (!written) {
            written = with_name(written.error(), staged, outputs_[i].path);
            continue;
        }
        const fs::path target = identity(outputs_[i].path);
        take_permissions(staged, target);
        renamings.push_back({staged, target.string()});
    }
    if (!written) return written;
    if (const auto failed = rename_all(renamings)) {
        return failure("cannot write '{}': {}; write elsewhere", outputs_[failed->index].path,
                       std::system_category().message(failed->error_number));
    }
    return success();
}

}  // namespace sightline::cli
