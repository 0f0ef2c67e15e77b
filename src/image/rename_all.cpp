// Files under the new names are exchanged with ours (renameat2), so that they can be exchanged back
// and no name is ever without a file. File systems that can't do that get two renames instead.
#include "image/rename_all.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <vector>

#include "image/temporary_file.hpp"

namespace sightline {
namespace {

enum class Way {
    placed,     ///< nothing stood there
    exchanged,  ///< what stood there bears our old name
    set_aside,  ///< what stood there bears our old name with an ending
};

std::string aside(const Renaming& renaming) { return renaming.from + ".old"; }

int rename_with(const Renaming& renaming, unsigned flags) {
    const int done =
        ::renameat2(AT_FDCWD, renaming.from.c_str(), AT_FDCWD, renaming.to.c_str(), flags);
    return done == 0 ? 0 : errno;
}

int plain_rename(const std::string& from, const std::string& to) {
    return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

bool is_folder(const std::string& path) {
    struct stat info {};
    return ::lstat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode);
}

bool exists(const std::string& path) {
    struct stat info {};
    return ::lstat(path.c_str(), &info) == 0;
}

/// For file systems that know neither flag of renameat2().
int set_aside_and_rename(const Renaming& renaming, Way& way) {
    way = Way::placed;
    if (exists(renaming.to)) {
        if (const int error = plain_rename(renaming.to, aside(renaming))) return error;
        way = Way::set_aside;
    }
    const int error = plain_rename(renaming.from, renaming.to);
    if (error != 0 && way == Way::set_aside) plain_rename(aside(renaming), renaming.to);
    return error;
}

/// 0, or the number of the error, after which everything is as before.
int rename_one(const Renaming& renaming, Way& way) {
    if (is_folder(renaming.to)) return EISDIR;
    way = Way::placed;
    int error = rename_with(renaming, RENAME_NOREPLACE);
    if (error == EEXIST) {
        way = Way::exchanged;
        error = rename_with(renaming, RENAME_EXCHANGE);
        if (error == 0 && is_folder(renaming.from)) {  // it came in this moment
            error = rename_with(renaming, RENAME_EXCHANGE);
            return error != 0 ? error : EISDIR;
        }
    }
    if (error == EINVAL || error == ENOSYS) return set_aside_and_rename(renaming, way);
    return error;
}

void take_back(const Renaming& renaming, Way way) {
    if (way == Way::exchanged) {
        rename_with(renaming, RENAME_EXCHANGE);
        return;
    }
    plain_rename(renaming.to, renaming.from);
    if (way == Way::set_aside) plain_rename(aside(renaming), renaming.to);
}

}  // namespace

std::optional<RenameFailure> rename_all(std::span<const Renaming> renamings) {
    std::vector<Way> ways(renamings.size());
    const UninterruptedStep step;
    for (std::size_t i = 0; i < renamings.size(); ++i) {
        const int error = rename_one(renamings[i], ways[i]);
        if (error == 0) continue;
        for (std::size_t k = i; k-- > 0;) take_back(renamings[k], ways[k]);
        return RenameFailure{i, error};
    }
    for (std::size_t i = 0; i < renamings.size(); ++i) {
        if (ways[i] == Way::exchanged) ::unlink(renamings[i].from.c_str());
        if (ways[i] == Way::set_aside) ::unlink(aside(renamings[i]).c_str());
    }
    return std::nullopt;
}

}  // namespace sightline
