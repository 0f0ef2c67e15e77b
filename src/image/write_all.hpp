// Writing everything to a descriptor, of whatever kind it is.
#pragma once

#include <cstddef>

namespace sightline {

/// Writes all of the bytes. Goes on after signals, and waits for the reader of a pipe that was set
/// not to block. Gives 0 or the error number of the system.
[[nodiscard]] int write_all(int descriptor, const void* data, std::size_t size);

/// After a read or write that failed: whether it is to be tried again. Waits until the descriptor
/// is ready (`events` as for poll()) where it does not block.
[[nodiscard]] bool worth_another_try(int descriptor, short events, int error_number);

}  // namespace sightline
