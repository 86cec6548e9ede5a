#include "tafoni/core/atomic_file.h"

#include <csignal>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/core/impl/left_over.h"
#include "tafoni/core/test/test_folder.h"

namespace tafoni {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  static std::string content(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  /// The error's sentence, empty when nothing was thrown.
  template <class F>
  static std::string sentence(F&& f) {
    try {
      f();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::output);
      return error.what();
    }
    return "";
  }
  const TestFolder test_folder_;
  const fs::path folder_ = test_folder_.path;
};

TEST_F(AtomicFileTest, AppearsOnCommitOnly) {
  const fs::path target = folder_ / "mesh.glb";
  {
    AtomicFile file(target);
    file.write("hello");
    EXPECT_FALSE(fs::exists(target));
    EXPECT_EQ(files(), 0u);
    EXPECT_EQ(std::ofstream(file.path()).good(), true);
    file.commit();
  }
  EXPECT_EQ(content(target), "hello");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, LeavesTheOldFileWhenNotCommitted) {
  const fs::path target = folder_ / "a.txt";
  std::ofstream(target) << "old";
  {
    AtomicFile file(target);
    file.write("new");
  }
  EXPECT_EQ(content(target), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, SeeksBackIntoLargeFiles) {
  const fs::path target = folder_ / "a.bin";
  const std::string big(3'000'001, 'x');
  AtomicFile file(target);
  file.write("0000");
  file.write(big);
  EXPECT_EQ(file.position(), big.size() + 4);
  file.seek(0);
  file.write("1234");
  EXPECT_EQ(file.position(), 4u);
  file.commit();
  EXPECT_EQ(content(target), "1234" + big);
}

TEST_F(AtomicFileTest, KeepsTheModeAndTheLink) {
  const fs::path real = folder_ / "real.txt", link = folder_ / "link.txt";
  std::ofstream(real) << "old";
  fs::permissions(real, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.txt", link);
  AtomicFile file(link);
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content(real), "new");
  EXPECT_EQ(fs::status(real).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFileTest, ALinkThatLeadsNowhereMakesWhatItNames) {
  const fs::path link = folder_ / "link.txt";
  fs::create_symlink("real.txt", link);
  AtomicFile file(link);
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content(folder_ / "real.txt"), "new");
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  EXPECT_THROW(AtomicFile(folder_ / "a"), Error);
}

TEST_F(AtomicFileTest, TakesTheLongestNameThereIs) {
  const fs::path target = folder_ / (std::string(251, 'n') + ".glb");
  for (const char* text : {"first", "second"}) {
    AtomicFile file(target);
    file.write(text);
    file.commit();
    EXPECT_EQ(content(target), text);
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, ANewOneReplacesNothing) {
  const fs::path target = folder_ / "a.txt";
  AtomicFile first(target), second(target);
  first.write("first");
  second.write("second");
  EXPECT_TRUE(first.commit_new());
  EXPECT_FALSE(second.commit_new());
  EXPECT_EQ(content(target), "first");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, WhatAKilledProcessLeftIsRemovedAndNothingElse) {
  // Both kinds have names, and are the only ones that a kill can leave.
  const auto make_and_wait = [&](const fs::path& folder, int fd) {
    const TemporaryFolder made(folder);
    std::ofstream(made.path() / "tile.glb") << "half";
    fs::path name;
    impl::make_temporary_file(folder, name);
    (void)!::write(fd, "x", 1);
    ::pause();
  };
  const auto child = [&](const fs::path& folder) {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    const pid_t made = ::fork();
    if (made == 0) {
      make_and_wait(folder, ready[1]);
      ::_exit(0);
    }
    char x;
    EXPECT_EQ(::read(ready[0], &x, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    return made;
  };
  std::ofstream(folder_ / ".tafoni-notes.part") << "a user's";
  const pid_t dead = child(folder_);
  ::kill(dead, SIGKILL);
  ::waitpid(dead, nullptr, 0);
  const pid_t alive = child(folder_);
  // The living one removed what the dead one left when it began.
  EXPECT_EQ(files(), 3u);
  const pid_t writer = ::fork();
  if (writer == 0) {
    AtomicFile(folder_ / "a.txt").commit();
    ::_exit(0);
  }
  ::waitpid(writer, nullptr, 0);
  EXPECT_EQ(files(), 4u) << "what a living process holds stays";
  ::kill(alive, SIGKILL);
  ::waitpid(alive, nullptr, 0);
  AtomicFile(folder_ / "a.txt").commit();
  EXPECT_EQ(files(), 2u);
}

TEST_F(AtomicFileTest, RefusesInOneSentence) {
  EXPECT_THAT(sentence([&] { AtomicFile file(folder_); }), testing::HasSubstr("is a folder"));
  EXPECT_THAT(
      sentence([&] { AtomicFile file(folder_ / "no" / "a.txt"); }),
      testing::AllOf(testing::HasSubstr("a.txt: there is no folder "), testing::HasSubstr("make it")));
  EXPECT_THAT(sentence([&] { AtomicFile file("/dev/null"); }), testing::HasSubstr("not a plain file"));
  EXPECT_EQ(files(), 0u);
}

TEST_F(AtomicFileTest, FullDiskIsOneSentence) {
  // A file-size limit makes write() fail as a full disk does.
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit low = old;
  low.rlim_cur = 1 << 16;
  ::setrlimit(RLIMIT_FSIZE, &low);
  const std::string text = sentence([&] {
    AtomicFile file(folder_ / "a.bin");
    file.write(std::string(1 << 21, 'x'));
    file.commit();
  });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(text, testing::HasSubstr("a.bin: File too large"));
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace tafoni
