#include "tafoni/core/files.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/inner/file_lock.h"
#include "tafoni/core/test/test_folder.h"

namespace tafoni {
namespace {

namespace fs = std::filesystem;
using inner::FileLock;
using std::chrono::milliseconds;

class Files : public ::testing::Test {
 protected:
  const TestFolder folder;
  const fs::path root = folder.path;
  fs::path make(const char* name) const {
    std::ofstream(root / name) << name;
    return root / name;
  }
};

TEST_F(Files, OneFileHasManyPaths) {
  const fs::path a = make("a"), b = make("b");
  fs::create_directory(root / "in");
  fs::create_directory_symlink("in", root / "also");
  fs::create_symlink("a", root / "link");
  fs::create_hard_link(a, root / "hard");
  for (const char* path : {"a", "./a", "in/../a", "link", "hard", "also/../a"})
    EXPECT_TRUE(same_file(a, root / path)) << path;
  EXPECT_FALSE(same_file(a, b));
  EXPECT_FALSE(same_file(a, root / "none"));
}

TEST_F(Files, TidyPathsLeadToTheSamePlace) {
  fs::create_directories(root / "far" / "deep");
  fs::create_directory(root / "in");
  fs::create_directory_symlink("far/deep", root / "link");
  std::ofstream(root / "far" / "a") << "a";
  EXPECT_EQ(tidy(root / "in" / ".." / "." / "a"), root / "a");
  EXPECT_EQ(tidy(root / "link" / "b"), root / "link" / "b");
  EXPECT_EQ(tidy(root / "none" / ".." / "b"), root / "b");
  EXPECT_EQ(tidy("../x/../y"), "../y");
  EXPECT_TRUE(same_file(tidy(root / "link" / ".." / "a"), root / "far" / "a"));
}

TEST_F(Files, FilesToComeAreComparedByTheirFolders) {
  fs::create_directory(root / "in");
  fs::create_directory_symlink("in", root / "also");
  fs::create_symlink("in/x.glb", root / "link");
  const fs::path x = root / "in" / "x.glb";
  for (const char* path : {"in/x.glb", "in/./x.glb", "also/x.glb", "in/../in/x.glb", "link"})
    EXPECT_TRUE(same_file(x, root / path)) << path;
  EXPECT_FALSE(same_file(x, root / "in" / "y.glb"));
  EXPECT_FALSE(same_file(x, root / "x.glb"));
  // As this disk has it: what is one file once it is there must be one before.
  const bool one = same_file(x, root / "in" / "X.glb");
  std::ofstream(x).flush();
  EXPECT_EQ(one, fs::exists(root / "in" / "X.glb"));
  EXPECT_EQ(std::distance(fs::directory_iterator(root / "in"), fs::directory_iterator()), 1);
}

TEST_F(Files, ALockHoldsUntilItsOwnerIsGone) {
  const fs::path a = make("a");
  std::optional<FileLock> mine = FileLock::take(a, milliseconds(0));
  ASSERT_TRUE(mine);
  EXPECT_FALSE(FileLock::take(a, milliseconds(20)));
  mine.reset();
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = FileLock::take(a, milliseconds(0));
    (void)!::write(ready[1], "x", 1);
    ::pause();
  }
  char x;
  ASSERT_EQ(::read(ready[0], &x, 1), 1);
  EXPECT_FALSE(FileLock::take(a, milliseconds(0)));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(FileLock::take(a, milliseconds(0)));
  EXPECT_TRUE(FileLock::take(root / "none", milliseconds(0)));
}

TEST_F(Files, ALockFollowsAFileThatIsReplaced) {
  const fs::path a = make("a");
  std::optional<FileLock> first = FileLock::take(a, milliseconds(0));
  fs::rename(make("b"), a);
  const auto second = FileLock::take(a, milliseconds(0));
  ASSERT_TRUE(second);
  EXPECT_FALSE(FileLock::take(a, milliseconds(0)));
}

}  // namespace
}  // namespace tafoni
