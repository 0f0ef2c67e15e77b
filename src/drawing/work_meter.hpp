// How far a long piece of work has come, for those who watch it, and whether it shall go on.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>

namespace sightline {

/// Counts units of work done by any number of threads and tells a progress function of the share
/// that is done: from one thread at a time, never less than before.
class WorkMeter {
public:
    /// The function may be empty; it must outlive the meter.
    explicit WorkMeter(const std::function<bool(double)>& progress) : progress_(progress) {}

    /// How much there is to do, once that is known.
    void expect(std::uint64_t units) { units_ = units; }
    /// `units` more are done; with 0 it only asks whether to go on.
    void add(std::uint64_t units) {
        done_ += units;
        if (!progress_) return;
        // Somebody who is asking just now speaks for all.
        if (const std::unique_lock lock(asking_, std::try_to_lock); lock) ask();
    }
    /// Tells of the end.
    void finish() {
        if (!progress_) return;
        const std::unique_lock lock(asking_);
        if (!progress_(1.0)) stopped_ = true;
    }
    [[nodiscard]] bool stopped() const { return stopped_; }

private:
    void ask() {
        const std::uint64_t units = units_, done = done_;
        const double share =
            units == 0 ? 0.0 : static_cast<double>(done) / static_cast<double>(units);
        if (!progress_(share)) stopped_ = true;
    }

    const std::function<bool(double)>& progress_;
    std::atomic<std::uint64_t> units_ = 0, done_ = 0;
    std::atomic<bool> stopped_ = false;
    std::mutex asking_;
};

}  // namespace sightline
