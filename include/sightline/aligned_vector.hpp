// Vectors for large arrays: aligned to cache lines, so that finished parts can be streamed out, and
// left uninitialised by resize(), for whoever makes one writes every element.
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace sightline {

/// Memory for an array, aligned to 64 bytes. Large ones lie in huge pages where the system has
/// them to give: fewer translations of addresses are missed. Throws std::bad_alloc.
[[nodiscard]] void* allocate_array(std::size_t bytes);
/// Gives it back. `bytes` as it was asked for.
void free_array(void* array, std::size_t bytes) noexcept;

template <class T>
struct AlignedAllocator {
    using value_type = T;

    AlignedAllocator() = default;
    template <class U>
    AlignedAllocator(const AlignedAllocator<U>&) noexcept {}
    [[nodiscard]] T* allocate(std::size_t n) {
        return static_cast<T*>(allocate_array(n * sizeof(T)));
    }
    void deallocate(T* p, std::size_t n) noexcept { free_array(p, n * sizeof(T)); }
    template <class U>
    void construct(U* p) noexcept {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... A>
    void construct(U* p, A&&... a) {
        ::new (static_cast<void*>(p)) U{std::forward<A>(a)...};
    }
    friend bool operator==(AlignedAllocator, AlignedAllocator) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace sightline
