// What a program inherits from the one that starts it: ignored and blocked signals, pipes that do
// not block, limits on threads.
#include <csignal>

#include "operation/shell.hpp"

namespace sightline::testing {
namespace {

/// Any format that is read in a process of its own.
const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

class Inherited : public ShellTest {
protected:
    /// Starts the program with a descriptor in the place of a standard stream; the others are
    /// files.
    [[nodiscard]] pid_t spawn(std::vector<std::string> words, int descriptor, int stream) const {
        const std::vector<char*> argv = argv_of(words);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addchdir_np(&actions, folder_.c_str());
        posix_spawn_file_actions_addopen(&actions, 2, (streams_ / "err").c_str(),
                                         O_WRONLY | O_CREAT | O_TRUNC, 0600);
        if (stream == 0)
            posix_spawn_file_actions_addopen(&actions, 1, (streams_ / "out").c_str(),
                                             O_WRONLY | O_CREAT | O_TRUNC, 0600);
        posix_spawn_file_actions_adddup2(&actions, descriptor, stream);
        pid_t program = -1;
        EXPECT_EQ(posix_spawn(&program, SIGHTLINE_PROGRAM, &actions, nullptr, argv.data(), environ),
                  0);
        posix_spawn_file_actions_destroy(&actions);
        return program;
    }

    /// Everything that the program writes into a pipe that does not block, read after a while.
    [[nodiscard]] std::string slowly_read(const std::vector<std::string>& words) const {
        std::array<int, 2> ends{};
        EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
        const pid_t program = spawn(words, ends[1], 1);
        close(ends[1]);
        fcntl(ends[0], F_SETFL, 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        std::string all(1 << 16, '\0');
        std::size_t size = 0;
        for (ssize_t got = 0; (got = read_some(ends[0], all, size)) > 0;) {
            size += static_cast<std::size_t>(got);
            all.resize(size + (1 << 16));
        }
        close(ends[0]);
        EXPECT_EQ(status_of(program), 0) << read_file(streams_ / "err");
        all.resize(size);
        return all;
    }

private:
    [[nodiscard]] static ssize_t read_some(int pipe, std::string& text, std::size_t from) {
        return ::read(pipe, text.data() + from, text.size() - from);
    }
};

TEST_F(Inherited, IgnoredChildrenAreWaitedFor) {
    write("m.off", kOff);
    std::signal(SIGCHLD, SIG_IGN);
    Running program = start({"info", "m.off"});
    std::signal(SIGCHLD, SIG_DFL);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Inherited, BlockedSignalsComeAllTheSame) {
    std::string model = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 1000; ++i) model += "v 0 0 " + std::to_string(i) + "\nf 1 2 -1\n";
    write("slow.obj", model);  // hours of work
    const std::vector<std::string> words = {"render",       "slow.obj",  "--algorithm", "brute",
                                            "--resolution", "8000x8000", "-o",          "a.png"};
    sigset_t all, before;
    sigfillset(&all);
    const auto start_blocked = [&](const std::vector<std::string>& more) {
        pthread_sigmask(SIG_SETMASK, &all, &before);
        std::vector<std::string> line = words;
        line.insert(line.end(), more.begin(), more.end());
        Running program = start(line);
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
        return program;
    };
    const Outcome limited = start_blocked({"--time-limit", "0.2"}).wait();
    EXPECT_EQ(limited.status, 1);
    EXPECT_NE(limited.err.find("--time-limit"), std::string::npos) << limited.err;
    Running stopped = start_blocked({});
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stopped.send(SIGTERM);
    EXPECT_EQ(stopped.wait().status, 130);
}

TEST_F(Inherited, PipesThatDoNotBlockAreWaitedFor) {
    std::string model;
    for (int i = 0; i < 3000; ++i) {
        const std::string x = std::to_string(i);
        model += "v " + x + " 0 0\nv " + x + ".5 0 0\nv " + x + " 1 0\nf -3 -2 -1\n";
    }
    write("m.obj", model);
    const std::vector<std::string> visible = {"visible", "m.obj", "--view", "front"};
    EXPECT_EQ(slowly_read(visible), run(visible).out);
    const std::vector<std::string> picture = {
        "render", "m.obj", "-o", "-", "--output-format", "npy", "--resolution", "400x300"};
    EXPECT_EQ(slowly_read(picture), run(picture).out);
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
    const pid_t program = spawn({"info", "-", "--format", "obj"}, ends[0], 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(::write(ends[1], kCube.data(), kCube.size()), static_cast<ssize_t>(kCube.size()));
    close(ends[1]);
    close(ends[0]);
    EXPECT_EQ(status_of(program), 0) << read_file(streams_ / "err");
}

TEST_F(Inherited, ALimitOnThreadsIsNamed) {
    // Limits on processes do not bind the superuser, who has to be somebody else for it.
    const std::string other =
        "setpriv --reuid=65533 --regid=65533 --clear-groups prlimit --nproc=1:1 ";
    write("sees.sh", "exec " + other + "\"$S\" --version");
    fs::permissions(folder_.parent_path(), fs::perms::all);
    fs::permissions(folder_, fs::perms::all);
    if (geteuid() != 0 || shell("exec sh sees.sh").status != 0) GTEST_SKIP() << "needs setpriv";
    for (const char* const name : {"a.exr", "b.exr"}) {
        ASSERT_EQ(run({"render", "cube.obj", "-o", name, "--resolution", "64x64"}).status, 0);
    }
    for (const std::string arguments :
         {"render cube.obj -o a.png", "composite a.exr b.exr -o c.exr", "plot y=x*z -o a.svg"}) {
        SCOPED_TRACE(arguments);
        const Outcome outcome = shell("exec " + other + "\"$S\" " + arguments);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        EXPECT_NE(outcome.err.find("threads"), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find("cube.obj"), std::string::npos) << outcome.err;
    }
#ifndef __SANITIZE_THREAD__  // its stand-in for oneTBB has two threads at least
    const Outcome alone = shell("exec " + other + "\"$S\" render cube.obj -o a.png --threads 1");
    EXPECT_EQ(alone.status, 0) << alone.err;
#endif
}

}  // namespace
}  // namespace sightline::testing
