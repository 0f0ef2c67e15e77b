// Vectors of aggregates that resize() leaves without values: whoever makes one writes every
// element, and does so on all cores, which also spreads the system's work of handing out the
// memory.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline {

template <class T>
struct RawAllocator {
    // Memory from operator new holds aggregates without more ado: they have implicit lifetimes.
    static_assert(std::is_aggregate_v<T> && std::is_trivially_copyable_v<T>);
    using value_type = T;

    RawAllocator() = default;
    template <class U>
    RawAllocator(const RawAllocator<U>&) noexcept {}
    [[nodiscard]] T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new(n * sizeof(T)));
    }
    void deallocate(T* p, std::size_t) noexcept { ::operator delete(p); }
    template <class U>
    void construct(U*) noexcept {}
    template <class U, class... A>
    void construct(U* p, A&&... a) {
        ::new (static_cast<void*>(p)) U{std::forward<A>(a)...};
    }
    friend bool operator==(RawAllocator, RawAllocator) { return true; }
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace sightline
