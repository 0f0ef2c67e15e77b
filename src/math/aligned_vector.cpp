// Memory for large arrays.
#include "sightline/aligned_vector.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;
constexpr std::align_val_t kLine{64}, kHuge{kHugePage};

// Half of an array at least must fill pages.
constexpr bool is_large(std::size_t bytes) { return bytes >= 2 * kHugePage; }

}  // namespace

void* allocate_array(std::size_t bytes) {
    if (!is_large(bytes)) return ::operator new(bytes, kLine);
    void* array = ::operator new(bytes, kHuge);
#ifdef MADV_HUGEPAGE
    // Whole pages only: the last one may hold what belongs to others. Advice may be ignored.
    ::madvise(array, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
    return array;
}

void free_array(void* array, std::size_t bytes) noexcept {
    ::operator delete(array, is_large(bytes) ? kHuge : kLine);
}

}  // namespace sightline
