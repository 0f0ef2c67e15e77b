// Items sorted into the parts of a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline {

/// What one chunk of triangles puts into each part (tile, band of rows) of a picture.
template <class Item>
struct Bins {
    std::vector<Item> items;
    std::vector<std::uint32_t> first;  ///< of each part, and the end

    [[nodiscard]] std::span<const Item> of(std::uint32_t part) const {
        return {items.data() + first[part], first[part + 1] - first[part]};
    }

    /// A counting sort: stable, so that a part meets its items in ascending order.
    /// for_each(visit) calls visit(part, item) for all, in the same order each time.
    template <class ForEach>
    void sort(std::size_t parts, const ForEach& for_each) {
        first.assign(parts + 2, 0);
        for_each([&](std::uint32_t part, const Item&) { ++first[part + 2]; });
        for (std::size_t t = 2; t < first.size(); ++t) first[t] += first[t - 1];
        items.resize(first.back());
        // first[part + 1] runs from the part's start to its end, which is where the next one
        // starts.
        for_each([&](std::uint32_t part, const Item& item) { items[first[part + 1]++] = item; });
        first.pop_back();
    }
};

}  // namespace sightline
