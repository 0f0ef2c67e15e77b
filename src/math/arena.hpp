// A number of threads for a piece of work.
#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <optional>

namespace sightline {

/// Runs `work` with `threads` threads (0: all cores) and returns what it returns. More threads than
/// cores are allowed: results never depend on the number, and tests make sure of it.
template <class Work>
auto in_arena(int threads, const Work& work) {
    // A new arena's workers have to be woken up; those of the one that we are in may still be
    // there.
    if (threads <= 0 || threads == tbb::this_task_arena::max_concurrency()) return work();
    std::optional<tbb::global_control> more;
    if (threads > tbb::info::default_concurrency())
        more.emplace(tbb::global_control::max_allowed_parallelism,
                     static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute(work);
}

}  // namespace sightline
