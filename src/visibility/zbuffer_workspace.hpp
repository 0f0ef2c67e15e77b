// What the z-buffer keeps from frame to frame: memory that has been touched. Fresh pages would cost
// as much as a frame.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "visibility/zbuffer_stages.hpp"

namespace sightline::zbuffer {

/// Triangles of a chunk by tile. Parts 0 .. tiles - 1 are the tiles' front sides, the rest their
/// back sides.
class TriangleBins {
public:
    /// A counting sort. Neighbours mostly go to one part, where each would have to wait for the
    /// other's count: so the two halves of the list are taken at the same time, with counts of
    /// their own.
    void sort(const Selected& selected, const TriangleRange& range, std::size_t parts) {
        first_.assign(2 * parts + 3, 0);
        for_each_in_halves(selected, [&](std::size_t i, std::size_t half) {
            ++first_[2 * selected.tile[i] + half + 2];
        });
        std::uint32_t sum = 0;
        for (std::uint32_t& first : first_) first = sum += first;
        if (items_.size() < sum) items_.resize(sum);
        // first_[k + 1] runs from the start of a half of a part to its end, where the next starts.
        for_each_in_halves(selected, [&](std::size_t i, std::size_t half) {
            TriangleItem& item = items_[first_[2 * selected.tile[i] + half + 1]++];
            item.marked = selected.marked[i];
            item.corners = range.corners[item.number() - range.first];
        });
    }
    /// Marks the tiles that something fell into.
    void mark(std::span<std::uint8_t> hit) const {
        const std::uint32_t *front = first_.data(), *back = front + 2 * hit.size();
        for (std::size_t t = 0; t < hit.size(); ++t)
            hit[t] |= static_cast<std::uint8_t>(front[2 * t] != front[2 * t + 2] ||
                                                back[2 * t] != back[2 * t + 2]);
    }
    [[nodiscard]] std::span<const TriangleItem> of(std::size_t part) const {
        return {items_.data() + first_[2 * part], first_[2 * part + 2] - first_[2 * part]};
    }

private:
    template <class Visit>
    static void for_each_in_halves(const Selected& selected, const Visit& visit) {
        const std::size_t half = selected.count / 2;
        for (std::size_t i = 0; i < half; ++i) {
            visit(i, 0);
            visit(half + i, 1);
        }
        if (2 * half < selected.count) visit(2 * half, 1);
    }

    std::vector<TriangleItem> items_;
    std::vector<std::uint32_t> first_;  // of each half of each part, and the end
};

/// One worker's.
struct Worker {
    Selected selected;
    PointBins points;
    std::vector<std::uint8_t> hit;  ///< by tile: whether something of this worker's fell into it
    TileBins bins;
    std::unique_ptr<Tile[]> tiles = std::make_unique_for_overwrite<Tile[]>(2);
};

struct Workspace {
    std::vector<TriangleBins> chunks;
    std::vector<Worker> workers;
};

/// A workspace for the time of a frame. Frames at the same time get different ones; they are kept
/// until the process ends. Thread-safe.
class LentWorkspace {
public:
    LentWorkspace() {
        const std::lock_guard lock(mutex_);
        if (idle_.empty()) {
            workspace_ = std::make_unique<Workspace>();
        } else {
            workspace_ = std::move(idle_.back());
            idle_.pop_back();
        }
    }
    ~LentWorkspace() {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(workspace_));
    }
    LentWorkspace(const LentWorkspace&) = delete;
    LentWorkspace& operator=(const LentWorkspace&) = delete;

    Workspace& operator*() const { return *workspace_; }

private:
    static inline std::mutex mutex_;
    static inline std::vector<std::unique_ptr<Workspace>> idle_;

    std::unique_ptr<Workspace> workspace_;
};

}  // namespace sightline::zbuffer
