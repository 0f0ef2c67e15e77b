// One name, one meaning: no object of any command's JSON has a key twice.
#include <nlohmann/json.hpp>
#include <set>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;

/// Notes the keys that an object has twice; a parsed object keeps only one of the two.
class RepeatedKeys : public nlohmann::json_sax<json> {
public:
    std::vector<std::string> repeated;

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool start_object(std::size_t) override {
        open_.emplace_back();
        return true;
    }
    bool end_object() override {
        open_.pop_back();
        return true;
    }
    bool key(string_t& name) override {
        if (!open_.back().insert(name).second) repeated.push_back(name);
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const json::exception& e) override {
        ADD_FAILURE() << e.what();
        return false;
    }

private:
    std::vector<std::set<std::string>> open_;
};

class JsonKeys : public ProgramTest {
protected:
    /// The last line of the output, which must have each key once.
    json expect_unique(std::vector<std::string> words) const {
        std::string shown;
        for (const std::string& word : words) shown += " " + word;
        SCOPED_TRACE("sightline" + shown + " --json");
        words.insert(words.end(), {"--json", "--quiet"});
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::string text = outcome.out.substr(0, outcome.out.find_last_not_of('\n') + 1);
        text = text.substr(text.rfind('\n') + 1);
        RepeatedKeys keys;
        EXPECT_TRUE(json::sax_parse(text, &keys));
        EXPECT_EQ(keys.repeated, std::vector<std::string>{});
        return json::parse(text, nullptr, false);
    }
};

const std::vector<std::string> kSmall{"--resolution", "48x32"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST_F(JsonKeys, OfRenderWithEveryAlgorithm) {
    const json known = expect_unique({"algorithms"});
    for (const json& row : known["algorithms"]) {
        const auto name = row["name"].get<std::string>();
        const std::vector<std::string> command =
            with({"render", "cube.obj", "-o", "a.png", "--algorithm", name}, kSmall);
        EXPECT_EQ(expect_unique(command)["polygons"], 6) << name;
        const json frames =
            expect_unique({"render", "cube.obj", "-o", "f#.png", "--algorithm", name, "--frames",
                           "2", "--orbit", "y", "--resolution", "48x32"});
        EXPECT_EQ(frames["samples"], name == "abuffer" ? 0 : 1) << name;
    }
}

TEST_F(JsonKeys, OfTheOtherCommands) {
    write("d.txt", "1,0,0\n0,1,0\n");
    expect_unique({"info", "cube.obj", "--vanishing-direction", "1,1,0"});
    expect_unique(with({"render", "cube.obj", "--stream", "-o", "s.png"}, kSmall));
    expect_unique(with({"render", "cube.obj", "-o", "flat.exr"}, kSmall));
    expect_unique(
        with({"render", "cube.obj", "--algorithm", "abuffer", "--deep", "-o", "d.exr"}, kSmall));
    expect_unique({"composite", "flat.exr", "flat.exr", "-o", "both.exr"});
    expect_unique({"composite", "d.exr", "d.exr", "-o", "deep.exr"});
    expect_unique(with({"draw", "cube.obj", "-o", "a.svg", "--fill", "flat"}, kSmall));
    expect_unique({"plot", "y = x*z", "--count", "5", "-o", "p.svg"});
    for (const char* by : {"triangle", "polygon", "object"}) {
        expect_unique(with({"visible", "cube.obj", "--by", by}, kSmall));
    }
    expect_unique(with({"visible", "cube.obj", "--from-directions", "d.txt"}, kSmall));
    expect_unique(with({"compare", "cube.obj"}, kSmall));
    for (const char* algorithm : {"zbuffer", "bsp"}) {
        expect_unique({"bench", "cube.obj", "--frames", "1", "--algorithm", algorithm});
    }
}

TEST_F(JsonKeys, BackFacingCountsWhateverCullSays) {
    // A cube, and a sheet that is not closed and shows its back.
    write("sheet.obj", "v 3 0 0\nv 4 0 0\nv 4 1 0\nv 3 1 0\nf 4 3 2 1\n");
    for (const char* cull : {"auto", "none", "back", "front"}) {
        const json counts = expect_unique({"render", "cube.obj", "sheet.obj", "-o", "a.png",
                                           "--cull", cull, "--resolution", "48x32"});
        EXPECT_EQ(counts["back_facing"], 8) << cull;
    }
    const json sums = expect_unique({"render", "cube.obj", "-o", "f#.png", "--frames", "3",
                                     "--orbit", "y", "--cull", "none", "--resolution", "48x32"});
    EXPECT_EQ(sums["back_facing"], 3 * 6);
}

}  // namespace
}  // namespace sightline::testing
