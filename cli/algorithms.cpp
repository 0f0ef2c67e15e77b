// `sightline algorithms`: the registry.
#include <array>

#include "errors.hpp"
#include "options.hpp"
#include "report.hpp"
#include "sightline/visibility.hpp"
#include "streams.hpp"

namespace sightline::cli {
namespace {

std::string_view name_of(Space space) {
    switch (space) {
        case Space::image:
            return "image";
        case Space::object:
            return "object";
        case Space::list_priority:
            return "list priority";
    }
    return "";
}

std::string as_json() {
    Value::List list;
    for (const Algorithm& algorithm : algorithms()) {
        list.emplace_back(Value::Object{{"name", algorithm.name},
                                        {"title", algorithm.title},
                                        {"space", name_of(algorithm.space)},
                                        {"exact", algorithm.exact},
                                        {"exhaustive", algorithm.exhaustive},
                                        {"help", algorithm.help},
                                        {"citation", algorithm.citation}});
    }
    return to_json(Value::Object{{"default", default_algorithm().name}, {"algorithms", list}}) +
           "\n";
}

std::string as_table() {
    std::vector<std::vector<std::string>> rows = {{"name", "space", "exact", "what it is"}};
    for (const Algorithm& algorithm : algorithms()) {
        const bool is_default = &algorithm == &default_algorithm();
        rows.push_back({std::string(algorithm.name), std::string(name_of(algorithm.space)),
                        algorithm.exact ? "yes" : "no",
                        fmt::format("{}{}", algorithm.title, is_default ? " (the default)" : "")});
    }
    std::string text = to_grid(rows);
    for (const Algorithm& algorithm : algorithms()) {
        text +=
            fmt::format("\n{}: {}\n    {}\n", algorithm.name, algorithm.help, algorithm.citation);
    }
    return text;
}

Result<int> run(const Arguments& arguments) {
    OptionReader reader(arguments);
    const CommonOptions common = read_common(reader);
    if (reader.error()) return *reader.error();
    if (common.stats) {
        tell(to_table({{"", "algorithms", algorithms().size(), ""}}));
    }
    if (Status done = print(common.json ? as_json() : as_table()); !done) return done.error();
    return 0;
}

const std::array kGroups = {OptionGroup{"Common", kCommonOptions}};

constexpr std::array kExamples = {
    Example{"sightline algorithms", "names, titles and sources"},
    Example{"sightline algorithms --json", "the same for programs"},
};

}  // namespace

const Command kAlgorithms = {
    "algorithms", "the visibility algorithms, and which give the exact answer",
    "",           "Lists the algorithms that --algorithm takes.",
    kGroups,      kExamples,
    run};

}  // namespace sightline::cli
