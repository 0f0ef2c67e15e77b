// Signals at any moment and limits of the system: no file is harmed, and none is left over.
#include <csignal>
#include <iostream>
#include <map>
#include <random>

#include "drawing/pages.hpp"
#include "operation/shell.hpp"

namespace sightline::testing {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

class Stopped : public ShellTest {
protected:
    static constexpr const char* kOutputs[] = {"a.png", "d.npy", "i.png"};
    const std::vector<std::string> words_ = {"render", "cube.obj", "--resolution", "500x400",
                                             "-o",     "a.png",    "--depth",      "d.npy",
                                             "--ids",  "i.png"};

    void put_old_files() const {
        for (const char* const name : kOutputs) write(name, "old");
    }
};

TEST_F(Stopped, AtRandomMoments) {
    const auto begun = Clock::now();
    ASSERT_EQ(run(words_).status, 0);
    const auto whole = std::chrono::duration_cast<microseconds>(Clock::now() - begun).count();
    std::vector<std::string> complete;
    for (const char* const name : kOutputs) complete.push_back(read(name));
    constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM, SIGUSR1};
    std::mt19937_64 random(9);
    std::map<int, int> statuses;
    const std::uint64_t count = amount(1000, 40, 15);
    for (std::uint64_t n = 0; n < count; ++n) {
        put_old_files();
        const int signal = kSignals[n % kSignals.size()];
        const auto moment = static_cast<long>(random() % static_cast<unsigned long>(whole + 1));
        SCOPED_TRACE("signal " + std::to_string(signal) + " after " + std::to_string(moment) +
                     " microseconds");
        Running program = start(words_);
        std::this_thread::sleep_for(microseconds(moment));
        program.send(signal);
        const Outcome outcome = program.wait();
        ++statuses[outcome.status];
        const bool done = outcome.status == 0;
        // Before main() the system ends a program by itself.
        const int stopped = signal == SIGXCPU ? 1 : 130;
        EXPECT_TRUE(done || outcome.status == stopped || outcome.status == 128 + signal)
            << outcome.status << " " << outcome.err;
        EXPECT_EQ(temporary_files(), std::vector<std::string>{});
        bool all_old = true, all_new = true;
        for (std::size_t i = 0; i < complete.size(); ++i) {
            const std::string bytes = read(kOutputs[i]);
            all_old = all_old && bytes == "old";
            all_new = all_new && bytes == complete[i];
        }
        EXPECT_TRUE(done ? all_new : all_old || all_new);
        EXPECT_EQ(outcome.error_lines(), outcome.status == 1 ? 1 : 0) << outcome.err;
    }
    if (std::getenv("SIGHTLINE_FULL") != nullptr) {
        for (const auto& [status, times] : statuses) {
            std::cout << "status " << status << ": " << times << "\n";
        }
    }
}

TEST_F(Stopped, ByTheLimitOnFileSize) {
    put_old_files();
    const Outcome outcome = shell(
        "ulimit -f 8; exec $S render cube.obj --resolution 500x400 -o a.png --depth d.npy "
        "--ids i.png");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
    EXPECT_EQ(temporary_files(), std::vector<std::string>{});
    for (const char* const name : kOutputs) EXPECT_EQ(read(name), "old");
}

TEST_F(Stopped, ByTheLimitOnFileSizeWhileAModelIsRead) {
    std::string off = "OFF\n3000 1000 0\n";
    for (int i = 0; i < 3000; ++i) {
        off += std::to_string(i) + (i % 3 == 1 ? " 1 0\n" : " 0 0\n");
    }
    for (int i = 0; i < 3000; i += 3) {
        off += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " +
               std::to_string(i + 2) + "\n";
    }
    write("m.off", off);
    const Outcome outcome = shell("ulimit -f 2; exec $S info m.off");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("ulimit -f"), std::string::npos) << outcome.err;
}

TEST_F(Stopped, ByTheLimitOnProcessorTime) {
    // A thousand triangles and millions of samples: hours of work.
    std::string model = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 1000; ++i) model += "v 0 0 " + std::to_string(i) + "\nf 1 2 -1\n";
    write("slow.obj", model);
    const std::string command =
        "exec $S render slow.obj --algorithm brute --resolution 8000x8000 -o a.png --ids i.png";
    std::vector<std::string> limits = {"ulimit -S -t 1; "};
#ifndef __SANITIZE_THREAD__  // it delivers signals late, and at the hard limit the system kills
    limits.emplace_back("ulimit -t 1; ");
#endif
    for (const std::string& limit : limits) {
        put_old_files();
        const Outcome outcome = shell(limit + command);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        EXPECT_NE(outcome.err.find("processor time"), std::string::npos) << outcome.err;
        EXPECT_EQ(temporary_files(), std::vector<std::string>{});
        EXPECT_EQ(read("a.png"), "old");
    }
}

TEST_F(Stopped, HangUpIsIgnoredUnderNohup) {
    std::vector<std::string> words = words_;
    words[3] = "3000x3000";
    Running program = [&] {
        std::signal(SIGHUP, SIG_IGN);
        Running started = start(words);
        std::signal(SIGHUP, SIG_DFL);
        return started;
    }();
    // The handlers stand when files are written.
    const auto deadline = Clock::now() + std::chrono::seconds(60);
    while (temporary_files().empty() && Clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    program.send(SIGHUP);
    EXPECT_EQ(program.wait().status, 0);
}

}  // namespace
}  // namespace sightline::testing
