#include "scene/load/contained.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace sightline::load {
namespace {

using Bytes = std::vector<std::byte>;

Error error_of(const Result<MappedBytes>& result) {
    if (result.ok()) {
        ADD_FAILURE() << "no error";
        return {};
    }
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
    EXPECT_EQ(result.error().message.rfind("file: ", 0), 0u) << result.error().message;
    return result.error();
}

bool mentions(const Error& error, const std::string& text) {
    return error.message.find(text) != std::string::npos;
}

TEST(Contained, HandsBytesOver) {
    const Result<MappedBytes> result = run_contained(
        [] {
            std::puts("this must not be seen");
            return Bytes(100000, std::byte{42});
        },
        {}, "file");
    ASSERT_TRUE(result.ok()) << result.error().message;
    ASSERT_EQ(result->bytes().size(), 100000u);
    EXPECT_EQ(result->bytes().back(), std::byte{42});
    const Result<MappedBytes> nothing = run_contained([] { return Bytes{}; }, {}, "file");
    ASSERT_TRUE(nothing.ok());
    EXPECT_TRUE(nothing->bytes().empty());
}

TEST(Contained, ChangesNothingInTheCaller) {
    int value = 1;
    const auto result = run_contained(
        [&] {
            value = 2;
            return Bytes{};
        },
        {}, "file");
    EXPECT_TRUE(result.ok());
    EXPECT_EQ(value, 1);
}

TEST(Contained, ACrashIsAnError) {
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS}) {
        const Error error = error_of(run_contained(
            [=] {
                std::raise(signal);
                return Bytes{};
            },
            {}, "file"));
        EXPECT_EQ(error.kind, ErrorKind::bad_input);
        EXPECT_TRUE(mentions(error, "crashed")) << error.message;
    }
}

TEST(Contained, AnExceptionIsAnError) {
    const Error error = error_of(run_contained([]() -> Bytes { throw 1; }, {}, "file"));
    EXPECT_TRUE(mentions(error, "crashed")) << error.message;
    const Error memory =
        error_of(run_contained([]() -> Bytes { throw std::bad_alloc(); }, {}, "file"));
    EXPECT_TRUE(mentions(memory, "memory")) << memory.message;
}

TEST(Contained, SleepingAndSpinningEndInTime) {
    const auto begin = std::chrono::steady_clock::now();
    ChildLimits limits;
    limits.seconds = 0.1;
    const Error asleep = error_of(run_contained(
        [] {
            std::this_thread::sleep_for(std::chrono::seconds(60));
            return Bytes{};
        },
        limits, "file"));
    EXPECT_TRUE(mentions(asleep, "longer than 0.1 s")) << asleep.message;
    const Error spinning = error_of(run_contained(
        [] {
            std::atomic<unsigned> spins = 0;
            while (++spins != 0 || spins == 0) {
            }
            return Bytes{};
        },
        limits, "file"));
    EXPECT_TRUE(mentions(spinning, "longer than 0.1 s")) << spinning.message;
    EXPECT_EQ(spinning.kind, ErrorKind::bad_input);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(Contained, AnInterruptedChildIsNoDamagedFile) {
    const Error error = error_of(run_contained(
        [] {
            std::raise(SIGINT);
            return Bytes{};
        },
        {}, "file"));
    EXPECT_EQ(error.kind, ErrorKind::cancelled);
}

TEST(Contained, IgnoringChildrenChangesNothing) {
    std::signal(SIGCHLD, SIG_IGN);
    const auto bytes = run_contained([] { return Bytes(1000, std::byte{42}); }, {}, "file");
    const auto memory = run_contained([]() -> Bytes { throw std::bad_alloc(); }, {}, "file");
    const auto crash = run_contained([]() -> Bytes { std::abort(); }, {}, "file");
    std::signal(SIGCHLD, SIG_DFL);
    ASSERT_TRUE(bytes.ok()) << bytes.error().message;
    EXPECT_EQ(bytes->bytes().size(), 1000u);
    EXPECT_TRUE(mentions(error_of(memory), "memory"));
    EXPECT_TRUE(mentions(error_of(crash), "crashed"));
}

TEST(Contained, TooLargeAResultIsAnError) {
    ChildLimits limits;
    limits.memory_bytes = std::size_t{1} << 20;
    const Error error =
        error_of(run_contained([] { return Bytes(std::size_t{3} << 20); }, limits, "file"));
    EXPECT_TRUE(mentions(error, "memory")) << error.message;
}

#if !defined(SIGHTLINE_SANITIZED)
TEST(Contained, EatingMemoryIsAnError) {
    ChildLimits limits;
    limits.memory_bytes = std::size_t{64} << 20;
    const Error error = error_of(run_contained(
        [] {
            std::size_t sum = 0;
            while (sum != 1) {
                char* const block = new char[1 << 20];
                std::memset(block, 1, 1 << 20);
                sum += static_cast<std::size_t>(block[17]) << 20;
            }
            return Bytes(sum);
        },
        limits, "file"));
    EXPECT_EQ(error.kind, ErrorKind::bad_input);
    EXPECT_TRUE(mentions(error, "more than 64 MiB of memory")) << error.message;
}
#endif

TEST(Contained, LeavesNoProcessesAndDescriptorsBehind) {
    const int before = dup(0);
    close(before);
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(run_contained([] { return Bytes(10); }, {}, "file").ok());
    }
    const int after = dup(0);
    close(after);
    EXPECT_EQ(before, after);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
}

}  // namespace
}  // namespace sightline::load
