// `bench --peers`: shell scripts stand in for the peers' programs, good ones and bad ones.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

class BenchPeers : public ProgramTest {
protected:
    void SetUp() override {
        ProgramTest::SetUp();
        fs::create_directories(folder_ / "peers");
    }

    /// A program in the folder of the peers.
    void add_program(const std::string& name, const std::string& script) const {
        write("peers/" + name, "#!/bin/sh\n" + script + "\n");
        fs::permissions(folder_ / "peers" / name, fs::perms::owner_all);
    }

    /// Whether the process in the file `pid` is gone before the time is over. A zombie is gone too:
    /// it only waits for its parent, or init, to look at it.
    [[nodiscard]] bool is_gone(Clock::time_point deadline) const {
        std::string number = read("pid");
        number.erase(number.find_last_not_of('\n') + 1);
        if (number.empty()) return false;
        while (Clock::now() < deadline) {
            const std::string stat = read_file("/proc/" + number + "/stat");
            if (stat.empty() || stat.find(") Z ") != std::string::npos) return true;
            std::this_thread::sleep_for(milliseconds(5));
        }
        return false;
    }

    static std::string says(const std::string& fields) { return "echo '{" + fields + "}'"; }

    [[nodiscard]] static std::vector<std::string> words(std::vector<std::string> more = {}) {
        std::vector<std::string> all = {"bench", "cube.obj", "--peers", "peers",    "--resolution",
                                        "32x24", "--frames", "2",       "--rounds", "2"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

const std::string kGood = R"("triangles": 12, "frame_ms_median": 1e6, "renderer": "a stub")";

TEST_F(BenchPeers, RatiosOfEveryProgramThatIsThere) {
    add_program("peer_llvmpipe", "echo a warning; echo noise >&2; " + BenchPeers::says(kGood));
    add_program("peer_embree", BenchPeers::says(kGood + R"(, "build_ms_median": 2e6)"));
    const Outcome outcome = run(words({"--json"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["triangles"], 12);
    EXPECT_EQ(object["rounds"], 2);
    std::vector<std::string> names;
    for (const json& row : object["programs"]) {
        names.push_back(row["program"]);
        EXPECT_EQ(row["frame_ms_rounds"].size(), 2u);
        EXPECT_LE(row["ratio"]["min"], row["ratio"]["median"]);
        EXPECT_LE(row["ratio"]["median"], row["ratio"]["max"]);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"sightline", "peer_llvmpipe", "peer_embree",
                                               "peer_embree + build"}));
    const json& rows = object["programs"];
    EXPECT_EQ(rows[0]["ratio"]["max"], 1.0);
    EXPECT_EQ(rows[1]["frame_ms"]["median"], 1e6);
    EXPECT_EQ(rows[3]["frame_ms"]["max"], 3e6);
    EXPECT_GT(rows[1]["ratio"]["min"], 1.0);
    const Outcome text = run(words());
    EXPECT_EQ(text.status, 0);
    EXPECT_NE(text.out.find("peer_embree + build"), std::string::npos) << text.out;
}

TEST_F(BenchPeers, TheProgramsGetTheSameOptions) {
    add_program("roofline", "echo \"$@\" > options; " + BenchPeers::says(kGood));
    ASSERT_EQ(run(words({"--threads", "1", "--repeat-gap", "0.5", "--cull", "back"})).status, 0);
    EXPECT_EQ(read("options"),
              "cube.obj --mode=id --size=32x24 --frames=2 --threads=1 --subdivide=0 --repeat=1 "
              "--repeat-gap=0.5 --cull\n");
    add_program("roofline", "echo \"$@\" > options; " +
                                BenchPeers::says(R"("triangles": 96, "frame_ms_median": 1)"));
    ASSERT_EQ(run(words({"--subdivide", "1", "--repeat", "2", "--farthest-first", "--view", "front",
                         "--projection", "orthographic", "--ortho-height", "3"}))
                  .status,
              0);
    const std::string options = read("options");
    for (const char* word : {"--subdivide=1", "--repeat=2", "--farthest-first", "--eye=0.5,0.5,",
                             "--target=0.5,0.5,0.5", "--up=0,1,0", "--ortho=3"}) {
        EXPECT_NE(options.find(word), std::string::npos) << options;
    }
}

TEST_F(BenchPeers, ProgramsThatFailAreNamedInOneLine) {
    const auto expect = [&](const std::string& script, std::initializer_list<std::string> needles) {
        add_program("peer_llvmpipe", script);
        expect_failure(1, words(), needles);
    };
    expect("kill -SEGV $$", {"peer_llvmpipe", "signal 11"});
    expect("echo 'no OpenGL' >&2; exit 3", {"peer_llvmpipe", "status 3", "no OpenGL"});
    expect("echo hello", {"peer_llvmpipe", "without a line of JSON", "hello"});
    expect("true", {"without a line of JSON", "printed nothing"});
    expect("echo '{\"triangles\": 12,'", {"without a line of JSON"});
    expect(says(R"("triangles": 12)"), {"lacks", "frame_ms_median"});
    expect(says(R"("triangles": 12, "frame_ms_median": -1)"), {"lacks", "frame_ms_median"});
    expect(says(R"("triangles": "12", "frame_ms_median": 1)"), {"lacks", "triangles"});
    expect(says(R"("triangles": 1, "frame_ms_median": 1)"), {"1 triangles", "12", "cube.obj"});
    // Neither escape sequences nor endless output reach the terminal.
    expect("printf 'a\\033[2Jb\\n' >&2; exit 1", {"a?[2Jb"});
    expect("head -c 5000000 /dev/zero | tr '\\0' x", {"without a line of JSON", "xxx..."});
    write("peers/peer_llvmpipe", "not a program");
    fs::permissions(folder_ / "peers/peer_llvmpipe", fs::perms::owner_read);
    expect_failure(1, words(), {"peer_llvmpipe", "cannot be started"});
}

TEST_F(BenchPeers, AProgramThatHangsIsKilledWithAllItStarted) {
    add_program("peer_embree", "sleep 60 & echo $! > pid; wait");
    const auto begun = Clock::now();
    const Outcome outcome = run(words({"--peer-limit", "1"}));
    EXPECT_LT(Clock::now() - begun, seconds(20));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.error_lines(), 1);
    EXPECT_NE(outcome.err.find("peer_embree took longer than 1 s"), std::string::npos);
    EXPECT_TRUE(is_gone(begun + seconds(20)));
}

TEST_F(BenchPeers, AnInterruptEndsTheProgramToo) {
    add_program("peer_embree", "echo $$ > pid; exec sleep 60");
    Running program = start(words());
    const auto deadline = Clock::now() + seconds(20);
    while (read("pid").empty() && Clock::now() < deadline) {
        std::this_thread::sleep_for(milliseconds(5));
    }
    program.send(SIGTERM);
    EXPECT_EQ(program.wait().status, 130);
    EXPECT_TRUE(is_gone(deadline));
}

TEST_F(BenchPeers, WrongUse) {
    expect_failure(1, words(), {"none of", "peer_llvmpipe", "'peers'"});
    expect_failure(1, {"bench", "cube.obj", "--peers", "nowhere"}, {"'nowhere'", "does not exist"});
    expect_failure(2, {"bench", "--peers", "peers"}, {"--peers", "one model"});
    expect_failure(2, words({"cube.obj"}), {"--peers", "one model"});
    expect_failure(2, words({"--cull", "front"}), {"--cull front"});
    expect_failure(2, words({"--projection", "cavalier"}), {"--projection cavalier"});
    expect_failure(2, words({"--rounds", "0"}), {"--rounds", "'0'"});
    expect_failure(2, words({"--peer-limit", "0"}), {"--peer-limit", "'0'"});
    expect_failure(2, {"bench", "cube.obj", "--rounds", "2"}, {"--rounds", "--peers"});
}

}  // namespace
}  // namespace sightline::testing
