#include "scene/load/foreign_reader.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "scene/load/contained.hpp"
#include "scene/load/text.hpp"

namespace sightline::load {
namespace {

// The child sends a soup or a message, and then one of these.
constexpr std::byte kSoup{0}, kMessage{1};

Error bad_input(std::string message) { return {ErrorKind::bad_input, std::move(message)}; }

/// Makes the memory that malloc() hands out from here on hold this byte (or its complement) where
/// nobody sets it, beyond the end of a block too, and lie at an address that depends on the byte.
/// For the child: it slows malloc() down and leaks.
void fill_memory(int byte) {
    constexpr std::size_t kLargest = std::size_t{4} << 20, kMost = std::size_t{256} << 20;
    constexpr int kNever = 32 << 20;
    mallopt(M_PERTURB, byte);
    mallopt(M_MMAP_THRESHOLD, kNever);  // from the heap, and
    mallopt(M_TRIM_THRESHOLD, kNever);  // not given back to the system
    void* volatile shift = std::malloc(static_cast<std::size_t>(byte) << 12);
    if (shift == nullptr) return;
    // All that the caller left free is taken until the heap grows, in blocks of every size, and
    // given back: what is freed is filled.
    void* blocks = nullptr;
    std::size_t total = 0;
    for (std::size_t size = kLargest; size > 3 * sizeof(void*); size /= 2) {
        for (const void* const end = sbrk(0); sbrk(0) == end && total < kMost; total += size) {
            void* const block = std::malloc(size);
            if (block == nullptr) break;
            std::memcpy(block, &blocks, sizeof blocks);  // a list, which takes no memory more
            blocks = block;
        }
    }
    while (blocks != nullptr) {
        void* next = nullptr;
        std::memcpy(&next, blocks, sizeof next);
        std::free(std::exchange(blocks, next));
    }
}

/// `fill`: see fill_memory(). Sanitizers have an allocator of their own, which fills what it likes.
std::vector<std::byte> read_in_child(const Source& source, int fill) {
    if (!kIsSanitized) fill_memory(fill);
    std::variant<Soup, std::string> read = read_with_assimp(source);
    std::vector<std::byte> bytes;
    if (const Soup* soup = std::get_if<Soup>(&read)) {
        bytes = serialise(*soup);
        bytes.push_back(kSoup);  // at the end, where it costs nothing
    } else {
        const std::string& message = *std::get_if<std::string>(&read);
        const auto text = std::as_bytes(std::span(message));
        bytes.assign(text.begin(), text.end());
        bytes.push_back(kMessage);
    }
    return bytes;
}

/// Reads a file by assimp, and gives the bytes that the child process sends. Some of its readers
/// use memory that they have not set, so the same file gives another model each time. So nothing
/// that was not set is left to chance, and a file of moderate size is read twice, with other values
/// there.
Result<MappedBytes> read_twice(const Source& source, const LoadOptions& options) {
    constexpr int kFill = 0x55, kOtherFill = 0xAB;
    constexpr std::uintmax_t kReadTwice = std::uintmax_t{16} << 20;
    const ChildLimits limits{options.time_limit_seconds, options.memory_limit_bytes};
    const auto read = [&](int fill) {
        return run_contained([&] { return read_in_child(source, fill); }, limits, source.name);
    };
    Result<MappedBytes> first = read(kFill);
    if (!first) return first;
    std::error_code error;
    const std::uintmax_t size =
        source.path.empty() ? source.bytes.size() : std::filesystem::file_size(source.path, error);
    if (error || size > kReadTwice) return first;
    const Result<MappedBytes> second = read(kOtherFill);
    if (!second) return second.error();
    if (!std::ranges::equal(first->bytes(), second->bytes())) {
        return bad_input(
            fmt::format("{}: its reader gives another result each time, so none is "
                        "right; export it again or convert it to another format",
                        source.name));
    }
    return first;
}

}  // namespace

Result<Soup> read_foreign(const Source& source, const LoadOptions& options) {
    const Result<MappedBytes> mapped = read_twice(source, options);
    if (!mapped) return mapped.error();
    const std::span<const std::byte> bytes = mapped->bytes();
    if (!bytes.empty() && bytes.back() == kMessage) {
        return bad_input(fmt::format("{}: not a readable {} file ({}); check or export it again",
                                     source.name, source.format,
                                     one_line(text_of(bytes.first(bytes.size() - 1)))));
    }
    std::optional<Soup> soup;
    if (!bytes.empty()) soup = deserialise(bytes.first(bytes.size() - 1));
    if (!soup) {
        return bad_input(
            fmt::format("{}: the file is damaged: its reader returned nonsense; export "
                        "it again or convert it to another format",
                        source.name));
    }
    return std::move(*soup);
}

}  // namespace sightline::load
