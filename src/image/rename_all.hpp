// Several files get their names together, or none does.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace sightline {

/// A complete file and the name it is to get. No link is followed.
struct Renaming {
    std::string from, to;
};

struct RenameFailure {
    std::size_t index = 0;  ///< of the file that could not be renamed
    int error_number = 0;   ///< errno
};

/// Renames all of the files; what stood under the new names is removed once all have them. When
/// one can't be renamed, the others get back their old names, and what stood under the new ones
/// stands there again. Signals are taken before or after, not in between.
[[nodiscard]] std::optional<RenameFailure> rename_all(std::span<const Renaming> renamings);

}  // namespace sightline
