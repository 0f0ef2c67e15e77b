// The triangles that a row of samples meets, in the order of x.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "visibility/row_bands.hpp"

namespace sightline {

/// Puts a list that is nearly in order into order. Neighbouring rows differ little, so insertion
/// takes O(n) on most; a list that turns out to be far from order is sorted in O(n log n).
template <class Entry, class Before>
void restore_order(std::vector<Entry>& list, const Before& before) {
    std::size_t budget = 8 * list.size() + 64;
    for (std::size_t k = 1; k < list.size(); ++k) {
        if (!before(list[k], list[k - 1])) continue;
        const Entry entry = list[k];
        std::size_t at = k;
        for (; at > 0 && before(entry, list[at - 1]); --at) list[at] = list[at - 1];
        list[at] = entry;
        if (k - at < budget) {
            budget -= k - at;
            continue;
        }
        std::sort(list.begin(), list.end(), before);
        return;
    }
}

/// Sorts `fresh` and merges it into the ordered `list`; `fresh` is empty afterwards.
template <class Entry, class Before>
void merge_into(std::vector<Entry>& list, std::vector<Entry>& fresh, const Before& before) {
    if (fresh.empty()) return;
    std::sort(fresh.begin(), fresh.end(), before);
    const auto middle = static_cast<std::ptrdiff_t>(list.size());
    list.insert(list.end(), fresh.begin(), fresh.end());
    std::inplace_merge(list.begin(), list.begin() + middle, list.end(), before);
    fresh.clear();
}

/// Active triangles in slots that stay theirs until they are released.
class ActivePool {
public:
    /// The triangle's slot, or kNone when it covers no row from this one on.
    [[nodiscard]] std::uint32_t add(const ScreenScene& screen, const SampleUnits& units,
                                    std::uint32_t number, std::int32_t row) {
        if (free_.empty()) {
            slots_.emplace_back(screen, units, number, row);
            if (!slots_.back().rows.empty()) {
                ++size_;
                return static_cast<std::uint32_t>(slots_.size() - 1);
            }
            slots_.pop_back();
            return kNone;
        }
        const std::uint32_t slot = free_.back();
        slots_[slot] = ActiveTriangle(screen, units, number, row);
        if (slots_[slot].rows.empty()) return kNone;
        free_.pop_back();
        ++size_;
        return slot;
    }

    void release(std::uint32_t slot) {
        free_.push_back(slot);
        --size_;
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] ActiveTriangle& operator[](std::uint32_t slot) { return slots_[slot]; }
    [[nodiscard]] const ActiveTriangle& operator[](std::uint32_t slot) const {
        return slots_[slot];
    }

private:
    std::vector<ActiveTriangle> slots_;
    std::vector<std::uint32_t> free_;
    std::size_t size_ = 0;
};

}  // namespace sightline
