// Work on all cores, or on one when somebody watches.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/arena.hpp"
#include "sightline/visibility.hpp"

namespace sightline {

/// Whether a piece of work stays on the thread that asks for it.
[[nodiscard]] inline bool works_alone(const ResolveOptions& options) {
    return options.observer != nullptr || options.threads == 1;
}

/// How many threads there are for work that is not done alone.
[[nodiscard]] inline std::uint32_t worker_count(const ResolveOptions& options) {
    return static_cast<std::uint32_t>(
        options.threads > 0 ? options.threads : tbb::this_task_arena::max_concurrency());
}

/// body(i) for i in 0 .. n-1, in any order, by the threads of the arena that this is called in;
/// alone: in ascending order on this thread.
template <class Body>
void each_index(std::uint32_t n, bool alone, const Body& body) {
    if (alone) {
        for (std::uint32_t i = 0; i < n; ++i) body(i);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, n), [&](const auto& range) {
        for (std::uint32_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

/// The same by as many threads as the options say; in ascending order on this thread under an
/// observer.
template <class Body>
void for_each_index(std::uint32_t n, const ResolveOptions& options, const Body& body) {
    if (works_alone(options))
        each_index(n, true, body);
    else
        in_arena(options.threads, [&] { each_index(n, false, body); });
}

/// Numbers 0 .. n-1, each for one worker: for each a part of them in succession, and what others
/// have left when that is done. In the next frame a worker so finds in its cache what it had there
/// in the last one, and its neighbours, too.
class Shares {
public:
    Shares() = default;
    Shares(std::size_t n, std::uint32_t workers) : n_(n), next_(workers) {
        for (std::uint32_t w = 0; w < workers; ++w) next_[w].number = begin(w);
    }

    /// body(i) for all that this worker gets.
    template <class Body>
    void take(std::uint32_t worker, const Body& body) {
        const std::size_t workers = next_.size();
        for (std::size_t k = 0; k < workers; ++k) {
            const std::size_t part = (worker + k) % workers;
            for (;;) {
                const std::size_t i = next_[part].number.fetch_add(1, std::memory_order_relaxed);
                if (i >= begin(part + 1)) break;
                body(i);
            }
        }
    }

private:
    /// On a cache line of its own.
    struct alignas(64) Next {
        std::atomic<std::size_t> number{0};
    };

    [[nodiscard]] std::size_t begin(std::size_t part) const { return n_ * part / next_.size(); }

    std::size_t n_ = 0;
    std::vector<Next> next_;
};

/// Resolves the rows that `out` holds, band by band. Precondition: they begin with a band.
inline void resolve_bands(RowSource& source, const ResolveOptions& options, Visibility& out) {
    const std::uint32_t height = source.band_rows();
    const std::size_t samples = std::size_t{height} * out.grid.columns();
    for_each_index((out.rows() + height - 1) / height, options, [&](std::uint32_t b) {
        source.resolve_band(out.first_row / height + b, out.ids.data() + b * samples,
                            out.depth.data() + b * samples);
    });
}

}  // namespace sightline
