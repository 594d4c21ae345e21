// SPDX-License-Identifier: Apache-2.0
#include "lib/output/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "tests/output/test_folder.h"

namespace sagitta::output {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Files larger than this fail, as on a full disk, while it lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(AtomicFile, ReplacesTheOldFileAndLeavesNothingElse) {
  const TestFolder folder;
  const std::string bytes("a\0b\n", 4);
  EXPECT_EQ(write_file(folder / "x.exr", "old and longer").error, "");
  EXPECT_EQ(write_file(folder / "x.exr", bytes).error, "");
  EXPECT_EQ(folder.contents("x.exr"), bytes);
  EXPECT_THAT(folder.names(), ElementsAre("x.exr"));
}

TEST(AtomicFile, ARelativeNameWithoutAFolderIsWrittenHere) {
  const TestFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  EXPECT_EQ(write_file("plain", "here").error, "");
  std::filesystem::current_path(before);
  EXPECT_EQ(folder.contents("plain"), "here");
}

TEST(AtomicFile, ANameAsLongAsNamesMayBeIsWritten) {
  const TestFolder folder;
  const std::string name(255, 'n');
  EXPECT_EQ(write_file(folder / name, "x").error, "");
  EXPECT_EQ(folder.contents(name), "x");
}

TEST(AtomicFile, AFailedWriteLeavesTheOldFileAndNoTemporary) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "x.exr", "old").ok());
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  WriteResult result;
  {
    const FileSizeLimit limit(4096);
    result = write_file(folder / "x.exr", std::string(10000, 'n'));
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(result.error, HasSubstr("x.exr: cannot be written: File too large"));
  EXPECT_EQ(folder.contents("x.exr"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("x.exr"));
}

TEST(AtomicFile, AWriterKilledInTheMiddleLeavesTheOldFileAndDoesNotDisturbTheNext) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "x.exr", "old").ok());
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_DFL);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const FileSizeLimit limit(4096);
    write_file(folder / "x.exr", std::string(10000, 'n'));
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
  EXPECT_EQ(folder.contents("x.exr"), "old");
  EXPECT_EQ(write_file(folder / "x.exr", "new").error, "");
  EXPECT_EQ(folder.contents("x.exr"), "new");
}

TEST(AtomicFile, ATemporaryLeftByAKilledProcessOfOurIdIsNotInTheWay) {
  const TestFolder folder;
  const std::string left = ".x.exr.tmp-" + std::to_string(getpid()) + "-0";
  ASSERT_TRUE(write_file(folder / left, "left behind").ok());
  EXPECT_EQ(write_file(folder / "x.exr", "new").error, "");
  EXPECT_EQ(folder.contents("x.exr"), "new");
  EXPECT_EQ(folder.contents(left), "left behind");
}

TEST(AtomicFile, AnUnwritableFolderIsNamedInTheError) {
  const TestFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const pid_t child = fork();  // root may write anywhere, so the child becomes nobody first
  if (child == 0) {
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    const std::string error = write_file(folder / "x.exr", "new").error;
    _exit(error == (folder / "x.exr") + ": cannot be created: Permission denied" ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, PlacesThatAreNoFilesAreErrors) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "sub");
  EXPECT_THAT(write_file(folder / "sub", "x").error, HasSubstr("sub: cannot be replaced: Is a directory"));
  EXPECT_THAT(write_file(folder / "sub/", "x").error, HasSubstr("not the name of a file"));
  EXPECT_THAT(write_file("", "x").error, HasSubstr("not the name of a file"));
  EXPECT_THAT(write_file(folder / "none/x", "x").error, HasSubstr("none/x: cannot be created: No such file"));
  EXPECT_THAT(folder.names(), ElementsAre("sub"));
}

}  // namespace
}  // namespace sagitta::output
