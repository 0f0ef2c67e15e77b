// `sightline composite`: pictures of one view joined by depth.
#include "sightline/composite.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "errors.hpp"
#include "notes.hpp"
#include "options.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace sightline::cli {
namespace {

constexpr std::array kFormats = {ImageFormat::exr, ImageFormat::png};

struct CompositeCommandOptions {
    CommonOptions common;
    std::vector<std::string> paths;
    bool flatten = false;
    Output output;
};

// -- options -----------------------------------------------------------------------------------

void read_inputs(OptionReader& reader, CompositeCommandOptions& options) {
    options.paths = reader.arguments().models();
    if (options.paths.empty()) {
        reader.fail(wrong_use("no picture given; name EXR files, as in a.exr b.exr"));
    }
    for (const std::string& path : options.paths) {
        if (path.empty()) {
            reader.fail(wrong_use("the name of a picture is empty; name a file, as in a.exr"));
        }
        if (path == "-") {
            reader.fail(
                wrong_use("EXR pictures can't be read from standard input ('-'); name a file"));
        }
    }
}

void read_output_file(OptionReader& reader, CompositeCommandOptions& options) {
    auto output = read_output<ImageFormat>(reader, "--output", kFormats);
    if (output) {
        options.output = std::move(*output);
        check_output(reader, options.output, options.paths);
    } else {
        reader.fail(wrong_use("nothing to write; name a file, as in -o all.exr"));
    }
    if (options.output.path == "-" && options.common.json) {
        reader.fail(
            wrong_use("--json would mix with the picture on standard output; write the picture to "
                      "a file"));
    }
}

Result<CompositeCommandOptions> read_options(const Arguments& arguments) {
    OptionReader reader(arguments);
    CompositeCommandOptions options;
    read_inputs(reader, options);
    options.flatten = arguments.has("--flatten");
    options.common = read_common(reader);
    read_output_file(reader, options);
    if (reader.error()) return *reader.error();
    return options;
}

// -- the work ----------------------------------------------------------------------------------

/// What --stats and --json tell.
struct Summary {
    double load = 0, composite = 0, write = 0;
    bool deep = false;
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint64_t> taken;  ///< of each file: pixels, or samples of deep files
    std::uint64_t samples = 0;         ///< of the result, if it is deep
};

Result<std::vector<ExrPicture>> read_pictures(const std::vector<std::string>& paths,
                                              Progress& progress) {
    std::vector<ExrPicture> pictures;
    for (const std::string& path : paths) {
        progress.stage("reading", static_cast<unsigned>(pictures.size() + 1),
                       static_cast<unsigned>(paths.size()));
        Result<ExrPicture> picture = read_exr(path);
        if (!picture) return picture.error();
        pictures.push_back(std::move(*picture));
    }
    return pictures;
}

/// One picture of all, flat where that is wanted.
Result<ExrPicture> join_pictures(std::vector<ExrPicture> pictures,
                                 const CompositeCommandOptions& options, Summary& summary) {
    CompositeOptions how;
    how.threads = options.common.threads;
    how.names = options.paths;
    how.taken = &summary.taken;
    Result<ExrPicture> joined = composite(std::move(pictures), how);
    if (!joined) return joined.error();
    const auto* deep = std::get_if<DeepImage>(&*joined);
    summary.deep = deep != nullptr;
    if (deep == nullptr) return joined;
    summary.samples = deep->samples.size();
    const bool flat = options.flatten || options.output.format == ImageFormat::png;
    if (!flat) return joined;
    return ExrPicture(flatten(*deep, options.common.threads));
}

Status write_picture(const Output& output, const ExrPicture& picture) {
    if (const auto* deep = std::get_if<DeepImage>(&picture)) {
        return write_deep_exr(output.path, *deep);
    }
    const auto& flat = std::get<FlatPicture>(picture);
    if (output.format == ImageFormat::png) return write_color_png(output.path, flat.color);
    return write_exr(output.path, layers_of(flat));
}

void note_size(const ExrPicture& picture, Summary& summary) {
    const auto note = [&](std::uint32_t width, std::uint32_t height) {
        summary.width = width;
        summary.height = height;
    };
    const auto* deep = std::get_if<DeepImage>(&picture);
    if (deep != nullptr) {
        note(deep->width, deep->height);
    } else {
        const ColorImage& color = std::get<FlatPicture>(picture).color;
        note(color.width, color.height);
    }
}

bool is_blank(const ExrPicture& picture) {
    if (const auto* deep = std::get_if<DeepImage>(&picture)) return deep->samples.empty();
    return std::ranges::none_of(std::get<FlatPicture>(picture).depth.pixels,
                                [](float depth) { return std::isfinite(depth); });
}

std::vector<Row> report_rows(const Summary& summary, const std::vector<std::string>& paths) {
    std::vector<Row> rows = {
        {"load_ms", "load", milliseconds(summary.load), "ms"},
        {"composite_ms", "join", milliseconds(summary.composite), "ms"},
        {"write_ms", "write", milliseconds(summary.write), "ms"},
        {"width", "width", summary.width, "pixels"},
        {"height", "height", summary.height, "pixels"},
        {"files", "files", std::uint64_t{paths.size()}, ""},
        {"deep", "deep", summary.deep, ""},
    };
    if (summary.deep) rows.push_back({"samples", "samples, tidy", summary.samples, ""});
    rows.push_back({"peak_rss_mb", "peak memory", std::round(10 * peak_memory_mib()) / 10, "MiB"});
    return rows;
}

/// The numbers of each file: a row a file for people, a list for programs.
Status report(const Summary& summary, const CompositeCommandOptions& options) {
    std::vector<Row> table = report_rows(summary, options.paths), object = table;
    Value::List taken;
    for (std::size_t i = 0; i < summary.taken.size(); ++i) {
        taken.emplace_back(summary.taken[i]);
        table.push_back(
            {"", options.paths[i], summary.taken[i], summary.deep ? "samples" : "pixels taken"});
    }
    object.push_back({summary.deep ? "samples_in" : "pixels_taken", "", std::move(taken), ""});
    if (Status told = print_rows(table, options.common.stats, false); !told) return told;
    return print_rows(object, false, options.common.json);
}

Result<int> run(const Arguments& arguments) {
    const Result<CompositeCommandOptions> options = read_options(arguments);
    if (!options) return options.error();
    use_exr_threads(options->common.threads);
    Progress progress(options->common.quiet);
    Summary summary;
    Stopwatch watch;
    auto pictures = read_pictures(options->paths, progress);
    if (!pictures) return pictures.error();
    summary.load = watch.lap();

    progress.stage("joining");
    const auto joined = join_pictures(std::move(*pictures), *options, summary);
    if (!joined) return joined.error();
    note_size(*joined, summary);
    summary.composite = watch.lap();

    progress.stage("writing");
    if (Status done = write_picture(options->output, *joined); !done) return done.error();
    summary.write = watch.lap();
    progress.clear();
    const Notes notes(options->common.quiet, progress);
    if (is_blank(*joined))
        notes.warn("the picture is blank: no file has a depth or a sample anywhere");
    const IdleOption own[] = {{"--flatten", !summary.deep, "flat files have nothing to flatten"}};
    notes.warn_of_options(arguments, own);
    if (Status told = report(summary, *options); !told) return told.error();
    return 0;
}

constexpr std::array kOutputRows = {
    Option{"--output", "FILE", "the picture: .exr or .png; '-' is standard output", "-o"},
    Option{"--output-format", "NAME", "exr or png, whatever the extension; needed for '-'"},
    Option{"--flatten", "", "of deep files, write an EXR with one colour and depth a pixel"},
};

const std::array kGroups = {OptionGroup{"Output", kOutputRows},
                            OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline composite house.exr trees.exr -o both.exr",
            "of two pictures with depth, the nearest at each pixel"},
    Example{"sightline composite smoke.exr scene.exr -o all.exr",
            "of two deep files, all samples in their order"},
    Example{"sightline composite smoke.exr scene.exr --flatten -o flat.exr",
            "what they look like, with depth; or as a PNG with -o all.png"},
};

}  // namespace

const Command kComposite = {
    "composite",
    "join depth images or deep images by depth",
    "FILE.exr...",
    "Joins EXR files of one camera and resolution. Of flat ones (R G B A Z) every pixel comes "
    "from\n"
    "the file that is nearest there; deep ones become one deep file, tidied, with the samples of\n"
    "all. A single deep file is tidied or flattened.",
    kGroups,
    kExamples,
    run};

}  // namespace sightline::cli
