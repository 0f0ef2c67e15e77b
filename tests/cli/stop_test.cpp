// Stopping in the middle: Ctrl-C, SIGTERM and --time-limit leave at once and leave nothing behind.
#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

// The thread sanitizer holds signals back until the program calls the system.
#ifdef __SANITIZE_THREAD__
constexpr seconds kAtOnce{60};
#else
constexpr seconds kAtOnce{1};
#endif

class Stop : public ProgramTest {
protected:
    void SetUp() override {
        ProgramTest::SetUp();
        // 20,000 triangles in a plane: hours of work for the exhaustive algorithm below.
        std::string grid;
        for (int y = 0; y <= 100; ++y) {
            for (int x = 0; x <= 100; ++x) {
                grid += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
            }
        }
        for (int i = 0; i < 100 * 101 - 1; ++i) {
            if (i % 101 == 100) continue;
            const auto corner = [&](int by) { return std::to_string(i + 1 + by) + " "; };
            grid += "f " + corner(0) + corner(1) + corner(102) + corner(101) + "\n";
        }
        write("grid.obj", grid);
        before_ = files();
    }

    const std::vector<std::string> endless_ = {
        "render",       "grid.obj",  "--view", "front", "--algorithm", "brute",
        "--resolution", "8000x8000", "-o",     "a.png", "--depth",     "d.npy"};
    std::vector<std::string> before_;
};

TEST_F(Stop, SignalsDuringTheWork) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Running program = start(endless_);
        std::this_thread::sleep_for(milliseconds(700));
        const auto sent = Clock::now();
        program.send(signal);
        const Outcome outcome = program.wait();
        EXPECT_LT(Clock::now() - sent, kAtOnce);
        EXPECT_EQ(outcome.status, 130);
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(files(), before_);
    }
}

TEST_F(Stop, InterruptWhileFilesAreWritten) {
    // Noise that compresses slowly: the temporary files stand for a while.
    Running program = start({"render", "grid.obj", "--view", "front", "--shading", "ids",
                             "--resolution", "6000x6000", "-o", "a.png", "--ids", "i.png"});
    const auto deadline = Clock::now() + seconds(60);
    while (files() == before_ && Clock::now() < deadline) {
        std::this_thread::sleep_for(milliseconds(2));
    }
    EXPECT_NE(files(), before_);
    program.send(SIGINT);
    EXPECT_EQ(program.wait().status, 130);
    EXPECT_EQ(files(), before_);
}

TEST_F(Stop, TimeLimit) {
    auto words = endless_;
    words.insert(words.end(), {"--time-limit", "0.3"});
    const auto begun = Clock::now();
    expect_failure(1, words, {"--time-limit", "0.3 seconds"});
    EXPECT_LT(Clock::now() - begun, seconds(4) + kAtOnce);
}

TEST_F(Stop, AGenerousTimeLimitChangesNothing) {
    const Outcome outcome = run({"render", "cube.obj", "-o", "a.png", "--time-limit", "1000"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(exists("a.png"));
}

}  // namespace
}  // namespace sightline::testing
