// Files appear complete or not at all.
#include "image/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "support/files.hpp"

namespace {

using namespace sightline;
using sightline::testing::read_file;
using sightline::testing::TemporaryFolder;
using sightline::testing::write_file;

AtomicFile open_file(const std::string& path,
                     AtomicFile::Access access = AtomicFile::Access::sequential) {
    Result<AtomicFile> file = AtomicFile::create(path, access);
    EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().message);
    return std::move(*file);
}

TEST(AtomicFile, AppearsOnCommitOnly) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.bin");
    AtomicFile file = open_file(path);
    EXPECT_TRUE(file.write("one ", 4).ok());
    EXPECT_TRUE(file.write("two", 3).ok());
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_TRUE(file.commit().ok());
    EXPECT_EQ(read_file(path), "one two");
    EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, WithoutCommitTheOldFileStaysAndNothingElse) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.bin");
    write_file(path, "old");
    {
        AtomicFile file = open_file(path);
        EXPECT_TRUE(file.write("new", 3).ok());
        EXPECT_EQ(folder.count(), 2);
    }
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, ManyWritesAndSeeksArriveInPlace) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.bin");
    AtomicFile file = open_file(path, AtomicFile::Access::seekable);
    const std::string block(100'000, 'x');
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(file.write(block.data(), block.size()).ok());
    ASSERT_TRUE(file.write(std::string(600'000, 'y').data(), 600'000).ok());
    ASSERT_TRUE(file.seek(5).ok());
    ASSERT_TRUE(file.write("HELLO", 5).ok());
    EXPECT_EQ(file.position(), 10u);
    ASSERT_TRUE(file.commit().ok());
    const std::string bytes = read_file(path);
    ASSERT_EQ(bytes.size(), 1'600'000u);
    EXPECT_EQ(bytes.substr(0, 12), "xxxxxHELLOxx");
    EXPECT_EQ(bytes[999'999], 'x');
    EXPECT_EQ(bytes[1'000'000], 'y');
}

TEST(AtomicFile, MissingFolderSaysSo) {
    const TemporaryFolder folder;
    const std::string path = folder.file("missing/a.png");
    const auto file = AtomicFile::create(path, AtomicFile::Access::sequential);
    ASSERT_FALSE(file.ok());
    EXPECT_EQ(file.error().kind, ErrorKind::io);
    EXPECT_NE(file.error().message.find(path), std::string::npos);
    EXPECT_NE(file.error().message.find("No such file"), std::string::npos);
    EXPECT_NE(file.error().message.find("create the folder"), std::string::npos);
}

TEST(AtomicFile, FolderAsTargetSaysSo) {
    const TemporaryFolder folder;
    const auto file = AtomicFile::create(folder.file("."), AtomicFile::Access::sequential);
    ASSERT_FALSE(file.ok());
    EXPECT_NE(file.error().message.find("directory"), std::string::npos);
    EXPECT_FALSE(AtomicFile::create("", AtomicFile::Access::sequential).ok());
    EXPECT_FALSE(AtomicFile::create(folder.file("new/"), AtomicFile::Access::sequential).ok());
    EXPECT_EQ(folder.count(), 0);
}

TEST(AtomicFile, ProtectedFolderSaysSo) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.file("locked"));
    std::filesystem::permissions(folder.file("locked"), std::filesystem::perms::owner_read |
                                                            std::filesystem::perms::owner_exec);
    const auto file =
        AtomicFile::create(folder.file("locked/a.png"), AtomicFile::Access::sequential);
    ASSERT_FALSE(file.ok());
    EXPECT_NE(file.error().message.find("Permission denied"), std::string::npos);
}

TEST(AtomicFile, FullDiskEndsInAnErrorThatSticks) {
    if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
    AtomicFile file = open_file("/dev/full");
    EXPECT_TRUE(file.write("a few bytes stay in the buffer", 30).ok());
    const std::string much(1'000'000, 'x');
    EXPECT_FALSE(file.write(much.data(), much.size()).ok());
    EXPECT_FALSE(file.write("x", 1).ok());
    EXPECT_FALSE(file.status().ok());
    const Status done = file.commit();
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(done.error().kind, ErrorKind::io);
    EXPECT_NE(done.error().message.find("No space left"), std::string::npos);
    EXPECT_NE(done.error().message.find("free some space"), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

// A limit on the size of files stands in for a disk that fills up while it is written: the first
// bytes are taken, a write is cut short, the next one fails. Runs in a child process.
[[noreturn]] void fill_the_disk(const TemporaryFolder& folder, const std::string& path) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{300'001, 300'001};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    bool failed = false;
    {
        AtomicFile file = open_file(path);
        const std::string block(250'000, 'x');
        for (int i = 0; i < 4; ++i) failed = !file.write(block.data(), block.size()).ok();
        failed = failed && !file.commit().ok();
    }
    ::_exit(failed && folder.count() == 1 && read_file(path) == "old" ? 0 : 1);
}

TEST(AtomicFileDeathTest, DiskThatFillsUpLeavesNothing) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.bin");
    write_file(path, "old");
    EXPECT_EXIT(fill_the_disk(folder, path), ::testing::ExitedWithCode(0), "");
}

TEST(AtomicFile, DevicesAreWrittenAndNotReplaced) {
    AtomicFile file = open_file("/dev/null", AtomicFile::Access::seekable);
    EXPECT_TRUE(file.write("abc", 3).ok());
    EXPECT_TRUE(file.seek(0).ok());
    EXPECT_TRUE(file.commit().ok());
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFileDeathTest, StandardOutputGetsSoughtBytesInOrder) {
    const TemporaryFolder folder;
    const std::string path = folder.file("stdout");
    EXPECT_EXIT(
        {
            const int out = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
            ::dup2(out, STDOUT_FILENO);
            AtomicFile file = open_file("-", AtomicFile::Access::seekable);
            bool ok = file.write("abcdef", 6).ok() && file.seek(2).ok() && file.write("XY", 2).ok();
            ok = ok && read_file(path).empty() && file.commit().ok();
            ::_exit(ok ? 0 : 1);
        },
        ::testing::ExitedWithCode(0), "");
    EXPECT_EQ(read_file(path), "abXYef");
}

TEST(AtomicFile, KeepsLinksAndPermissions) {
    const TemporaryFolder folder;
    const std::string path = folder.file("real"), link = folder.file("link");
    write_file(path, "old");
    std::filesystem::permissions(path, std::filesystem::perms{0640});
    std::filesystem::create_symlink(path, link);
    AtomicFile file = open_file(link);
    EXPECT_TRUE(file.write("new", 3).ok());
    EXPECT_TRUE(file.commit().ok());
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(read_file(path), "new");
    EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0640});
}

TEST(AtomicFile, MovesKeepTheFile) {
    const TemporaryFolder folder;
    AtomicFile first = open_file(folder.file("a"));
    EXPECT_TRUE(first.write("a", 1).ok());
    AtomicFile second = open_file(folder.file("b"));
    second = std::move(first);  // b is abandoned
    EXPECT_EQ(folder.count(), 1);
    EXPECT_TRUE(second.commit().ok());
    EXPECT_EQ(read_file(folder.file("a")), "a");
    EXPECT_FALSE(std::filesystem::exists(folder.file("b")));
}

TEST(AtomicFileDeathTest, SignalHandlerRemovesWhatIsOpenAndSparesWhatIsDone) {
    const TemporaryFolder folder;
    EXPECT_EXIT(
        {
            AtomicFile done = open_file(folder.file("done"));
            AtomicFile open = open_file(folder.file("open"));
            AtomicFile other = open_file(folder.file("other"));
            const bool ok = done.commit().ok() && folder.count() == 3;
            std::signal(SIGINT, [](int) {
                remove_temporary_files_from_signal_handler();
                ::_exit(7);
            });
            if (ok) ::raise(SIGINT);
            ::_exit(1);
        },
        ::testing::ExitedWithCode(7), "");
    EXPECT_EQ(folder.count(), 1);
    EXPECT_TRUE(std::filesystem::exists(folder.file("done")));
}

TEST(AtomicFile, MoreFilesThanTheRegistryHoldsStillWork) {
    const TemporaryFolder folder;
    std::vector<AtomicFile> files;
    for (int i = 0; i < 70; ++i) files.push_back(open_file(folder.file(std::to_string(i))));
    for (AtomicFile& file : files) EXPECT_TRUE(file.commit().ok());
    EXPECT_EQ(folder.count(), 70);
}

}  // namespace
