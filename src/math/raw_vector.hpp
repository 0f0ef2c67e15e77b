// Vectors of aggregates that resize() leaves without values: whoever makes one writes every
// element, and does so on all cores, which also spreads the system's work of handing out the
// memory.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline {

template <class T>
struct RawAllocator : std::allocator<T> {
    // Memory from an allocator holds aggregates without more ado (they have implicit lifetimes).
    static_assert(std::is_aggregate_v<T> && std::is_trivially_copyable_v<T>);

    RawAllocator() = default;
    template <class U>
    RawAllocator(const RawAllocator<U>&) noexcept {}
    template <class U>
    struct rebind {
        using other = RawAllocator<U>;
    };
    template <class U>
    void construct(U*) noexcept {}
    template <class U, class... A>
    void construct(U* p, A&&... a) {
        ::new (static_cast<void*>(p)) U{std::forward<A>(a)...};
    }
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace sightline
