#include "image/temporary_file.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <pthread.h>
#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <random>
#include <utility>

namespace sightline {
namespace {

// -- the list of names ----------------------------------------------------------------------------
// Fixed memory and lock-free flags, so that a signal handler may read it at any moment.

constexpr std::size_t kSlots = 64;
constexpr std::size_t kLongestPath = 4096;  // PATH_MAX of Linux, the closing zero included

enum SlotState : int { kFree, kFilling, kLive };

struct Slot {
    std::atomic<int> state{kFree};
    std::array<char, kLongestPath> name{};
};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// Made by the loader of the program, so that a handler can't meet it half made.
constinit std::array<Slot, kSlots> slots;

/// A slot that holds the name from now on, or -1 when none is free.
int register_name(const std::string& name) {
    if (name.size() >= kLongestPath) return -1;
    for (std::size_t i = 0; i < kSlots; ++i) {
        Slot& slot = slots[i];
        int expected = kFree;
        if (!slot.state.compare_exchange_strong(expected, kFilling)) continue;
        std::memcpy(slot.name.data(), name.c_str(), name.size() + 1);
        slot.state.store(kLive);
        return static_cast<int>(i);
    }
    return -1;
}

std::string random_name() {
    std::array<std::uint64_t, 2> bits{};
    if (::getrandom(bits.data(), sizeof bits, 0) != sizeof bits) {
        std::random_device source;  // before Linux 3.17, and where the call is forbidden
        for (std::uint64_t& word : bits) word = std::uint64_t{source()} << 32 | source();
    }
    return fmt::format(".sightline-{:016x}{:016x}.tmp", bits[0], bits[1]);
}

// -- steps ----------------------------------------------------------------------------------------

constinit std::atomic<int> steps{0};          // how many threads are in one
constinit std::atomic<bool> stopping{false};  // a handler removes the files

}  // namespace

UninterruptedStep::UninterruptedStep() noexcept {
    sigset_t all;
    sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
    ++steps;
    if (!stopping.load()) return;
    --steps;
    for (;;) ::pause();  // the program ends in a moment
}

UninterruptedStep::~UninterruptedStep() {
    --steps;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

TemporaryFile::TemporaryFile(const std::string& folder)
    : path_(fmt::format("{}/{}", folder, random_name())), slot_(register_name(path_)) {}

TemporaryFile& TemporaryFile::operator=(TemporaryFile&& other) noexcept {
    TemporaryFile taken(std::move(other));
    swap(taken);
    return *this;
}

TemporaryFile::~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
    release();
}

void TemporaryFile::release() noexcept {
    if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(kFree);
    slot_ = -1;
    path_.clear();
}

void TemporaryFile::swap(TemporaryFile& other) noexcept {
    path_.swap(other.path_);
    std::swap(slot_, other.slot_);
}

void remove_temporary_files_from_signal_handler() noexcept {
    // A thread that sees the flag too late is in a step, which is seen here.
    stopping.store(true);
    constexpr int kLongestWait = 5000;  // milliseconds; a step takes that on a disk that hangs only
    for (int waited = 0; waited < kLongestWait && steps.load() > 0; ++waited) {
        ::poll(nullptr, 0, 1);
    }
    for (Slot& slot : slots) {
        if (slot.state.load() == kLive) ::unlink(slot.name.data());
    }
}

}  // namespace sightline
