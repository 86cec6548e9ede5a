#include "tafoni/scene/sculpt/journal.h"

#include <csignal>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/test_folder.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Stroke numbered(int i) {
  Stroke s;
  s.brush = "sphere";
  s.points = {{static_cast<double>(i), 0, 0}};
  return s;
}

std::vector<int> numbers(const Journal& journal) {
  std::vector<int> out;
  for (const Journal::Entry& e : journal.strokes()) out.push_back(static_cast<int>(e.stroke->points[0].x));
  return out;
}

/// Ends with the status 0 once f has returned, with another where it throws.
template <class F>
pid_t in_another_process(const F& f) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  try {
    f();
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);
}

int writes_left = 0;
bool counting = false;

void count_write() {
  if (counting && writes_left-- == 0) ::raise(SIGKILL);
}
ssize_t write_at(int fd, const void* data, size_t bytes, off_t at) {
  count_write();
  return ::pwrite(fd, data, bytes, at);
}
ssize_t write_next(int fd, const void* data, size_t bytes) {
  count_write();
  return ::write(fd, data, bytes);
}
int remove_file(const char* path) {
  count_write();
  return ::unlink(path);
}
int shorten(int fd, off_t size) {
  count_write();
  return ::ftruncate(fd, size);
}

/// From now on SQLite changes files `n` times; before the next time this process kills itself.
void die_after_writes(int n) {
  sqlite3_vfs* files = sqlite3_vfs_find(nullptr);
  const auto put = [&](const char* call, auto* function) {
    files->xSetSystemCall(files, call, reinterpret_cast<sqlite3_syscall_ptr>(function));
  };
  put("pwrite64", write_at);
  put("pwrite", write_at);
  put("write", write_next);
  put("unlink", remove_file);
  put("ftruncate", shorten);
  writes_left = n;
  counting = true;
}

class JournalFile : public ::testing::Test {
 protected:
  template <class F>
  static std::string failure(F&& f) {
    try {
      f();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  const TestFolder folder;
  const fs::path root = folder.path;
  const fs::path file = root / "a.journal";
};

TEST_F(JournalFile, UndoAndRedoSurviveARestart) {
  {
    Journal j = Journal::open_or_create(file);
    for (int i = 1; i <= 5; ++i) j.append(numbered(i));
    EXPECT_EQ(j.undo(2), 2u);
  }
  {
    Journal j = Journal::open(file);
    EXPECT_EQ(numbers(j), (std::vector{1, 2, 3}));
    EXPECT_EQ(j.redoable(), 2u);
    EXPECT_EQ(j.redo(), 1u);
    EXPECT_EQ(j.undo(100), 4u);
    EXPECT_EQ(j.undo(), 0u);
  }
  Journal j = Journal::open(file);
  EXPECT_TRUE(j.strokes().empty());
  EXPECT_EQ(j.redo(100), 5u);
  EXPECT_EQ(j.redo(), 0u);
  EXPECT_EQ(numbers(j), (std::vector{1, 2, 3, 4, 5}));
}

TEST_F(JournalFile, AStrokeAfterAnUndoKeepsTheOldBranch) {
  Journal j = Journal::open_or_create(file);
  for (int i = 1; i <= 3; ++i) j.append(numbered(i));
  j.undo(2);
  const std::int64_t branch = j.append(numbered(9));
  EXPECT_EQ(numbers(j), (std::vector{1, 9}));
  EXPECT_EQ(j.redoable(), 0u);
  EXPECT_EQ(j.history().size(), 4u);
  j.undo();
  j.redo();
  EXPECT_EQ(numbers(j), (std::vector{1, 9}));
  j.go_to(3);
  EXPECT_EQ(numbers(j), (std::vector{1, 2, 3}));
  j.undo(2);
  EXPECT_EQ(j.redo(100), 2u);
  EXPECT_EQ(numbers(j), (std::vector{1, 2, 3}));
  j.go_to(branch);
  EXPECT_EQ(numbers(Journal::open(file)), (std::vector{1, 9}));
  EXPECT_THAT(failure([&] { j.go_to(77); }), HasSubstr("has no stroke 77"));
}

TEST_F(JournalFile, ARandomHistoryIsThatOfAList) {
  Journal j = Journal::open_or_create(file);
  std::vector<int> list, undone;
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const auto what = random.below(10);
    if (what < 5) {
      j.append(numbered(i));
      list.push_back(i);
      undone.clear();
    } else if (what < 8) {
      const std::size_t n = j.undo(random.below(4));
      for (std::size_t k = 0; k < n; ++k) undone.push_back(list.back()), list.pop_back();
    } else {
      const std::size_t n = j.redo(random.below(4));
      for (std::size_t k = 0; k < n; ++k) list.push_back(undone.back()), undone.pop_back();
    }
    ASSERT_EQ(numbers(j), list);
    ASSERT_EQ(j.redoable(), undone.size());
    if (i % 50 == 0) j = Journal::open(file);
  }
  EXPECT_EQ(numbers(Journal::open(file)), list);
}

TEST_F(JournalFile, MutesOneStroke) {
  Journal j = Journal::open_or_create(file);
  j.append(std::vector{numbered(1), numbered(2)});
  j.mute(1, true);
  EXPECT_TRUE(Journal::open(file).strokes()[0].muted);
  EXPECT_FALSE(j.strokes()[1].muted);
  j.mute(1, false);
  EXPECT_FALSE(Journal::open(file).strokes()[0].muted);
  EXPECT_THAT(failure([&] { j.mute(3, true); }), HasSubstr("has no stroke 3"));
}

TEST_F(JournalFile, KilledBeforeAnyOfItsWritesItLosesTheStrokeInFlightAlone) {
  constexpr int rounds = 24;  // a stroke takes fewer writes than half of that
  int most = 0, in_flight = 0;
  for (int writes = 0; writes < rounds; ++writes) {
    const int before = static_cast<int>(fs::exists(file) ? Journal::open(file).strokes().size() : 0);
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      // Says which stroke is on the disk; then goes on until it kills itself.
      Journal j = Journal::open_or_create(file);
      for (int i = before;; ++i) {
        if (i == before + 2) die_after_writes(writes);
        j.append(numbered(i));
        if (::write(ready[1], &i, sizeof(i)) != sizeof(i)) ::_exit(1);
      }
    }
    ::close(ready[1]);
    int stored = before - 1, next = 0, status = 0;
    while (::read(ready[0], &next, sizeof(next)) == sizeof(next)) stored = next;
    ::waitpid(child, &status, 0);
    ::close(ready[0]);
    ASSERT_TRUE(WIFSIGNALED(status));
    ASSERT_EQ(WTERMSIG(status), SIGKILL);
    in_flight += stored == before + 1;

    Journal j = Journal::open(file);
    const auto found = numbers(j);
    ASSERT_GE(std::ssize(found), stored + 1);
    ASSERT_LE(std::ssize(found), stored + 2);
    for (int i = 0; i < std::ssize(found); ++i) ASSERT_EQ(found[i], i);
    most = static_cast<int>(found.size());
  }
  EXPECT_GE(most, 2 * rounds);
  // It died at several places of one stroke, and within later ones.
  EXPECT_GT(in_flight, 3);
  EXPECT_LT(in_flight, rounds);
}

TEST_F(JournalFile, NothingOfAKilledProcessStaysOnceItWasOpened) {
  Journal::open_or_create(file).append(numbered(0));
  for (int writes = 0; writes < 12; ++writes) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      Journal j = Journal::open(file);
      die_after_writes(writes);
      for (int i = 1;; ++i) j.append(numbered(i));
    }
    ::waitpid(child, nullptr, 0);
    Journal::open(file);
    EXPECT_EQ(std::distance(fs::directory_iterator(root), fs::directory_iterator()), 1) << writes;
  }
}

TEST_F(JournalFile, TwoProcessesAppendToOneHistory) {
  Journal::open_or_create(file);
  const pid_t child = in_another_process([&] {
    Journal j = Journal::open(file);
    for (int i = 0; i < 20; ++i) j.append(numbered(100 + i));
  });
  ASSERT_GE(child, 0);
  Journal j = Journal::open(file);
  for (int i = 0; i < 20; ++i) j.append(numbered(i));
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  j.refresh();
  EXPECT_FALSE(j.refresh());
  std::vector<int> mine, theirs;
  for (const int n : numbers(j)) (n < 100 ? mine : theirs).push_back(n);
  ASSERT_EQ(mine.size(), 20u);
  ASSERT_EQ(theirs.size(), 20u);
  EXPECT_TRUE(std::is_sorted(mine.begin(), mine.end()));
  EXPECT_TRUE(std::is_sorted(theirs.begin(), theirs.end()));
}

TEST_F(JournalFile, OpensWhileAnotherProcessAppends) {
  Journal::open_or_create(file);
  const pid_t child = in_another_process([&] {
    Journal j = Journal::open(file);
    for (int i = 0; i < 200; ++i) j.append(numbered(i));
  });
  ASSERT_GE(child, 0);
  int status = -1;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    std::vector<int> found;
    EXPECT_EQ(failure([&] { found = numbers(Journal::open(file)); }), "no error");
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], static_cast<int>(i));
  }
  EXPECT_EQ(status, 0);
}

TEST_F(JournalFile, RefusesWhatIsNoJournal) {
  EXPECT_THAT(failure([&] { Journal::open(root / "none"); }), HasSubstr("does not exist"));
  EXPECT_THAT(failure([&] { Journal::open(root); }), HasSubstr("is a folder"));
  std::ofstream(root / "text") << "this is some text that is no database at all, and goes on for a while";
  EXPECT_THAT(failure([&] { Journal::open_or_create(root / "text"); }), HasSubstr("is no sculpt journal"));
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open((root / "other").c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "create table t (x); insert into t values (1);", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(db);
  EXPECT_THAT(failure([&] { Journal::open_or_create(root / "other"); }), HasSubstr("is no sculpt journal"));
  EXPECT_THAT(failure([&] { Journal::open_or_create(root / "no folder" / "j"); }),
              HasSubstr("there is no folder"));
}

TEST_F(JournalFile, AFileOfNoBytesIsANewOne) {
  std::ofstream(file).flush();
  {
    Journal j = Journal::open(file), other = Journal::open(file);
    EXPECT_TRUE(j.strokes().empty());
    EXPECT_EQ(fs::file_size(file), 0u) << "reading writes nothing";
    j.append(numbered(1));
    other.append(numbered(2));
  }
  EXPECT_EQ(numbers(Journal::open(file)), (std::vector{1, 2}));
  EXPECT_FALSE(Journal::make(file));
  EXPECT_EQ(numbers(Journal::open(file)), (std::vector{1, 2}));
}

TEST_F(JournalFile, IsMadeWholeOrNotAtAll) {
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit tight = old;
  tight.rlim_cur = 5000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const std::string what = failure([&] { Journal::make(file); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(what, HasSubstr("cannot write"));
  EXPECT_TRUE(fs::is_empty(root));
  EXPECT_TRUE(Journal::make(file, "s.toml"));
  EXPECT_EQ(Journal::open(file).scene(), "s.toml");
}

TEST_F(JournalFile, ACopyHoldsEveryStrokeAndIsItsOwn) {
  Journal j = Journal::open_or_create(file);
  for (int i = 1; i <= 4; ++i) j.append(numbered(i));
  j.undo(2);
  j.append(numbered(9));
  j.mute(1, true);
  j.undo();
  ASSERT_TRUE(Journal::make(root / "b.journal", "b.toml", &j));
  Journal copy = Journal::open(root / "b.journal");
  EXPECT_EQ(numbers(copy), (std::vector{1, 2}));
  EXPECT_TRUE(copy.strokes()[0].muted);
  EXPECT_EQ(copy.redo(9), 1u);
  EXPECT_EQ(copy.history().size(), 5u);
  copy.go_to(4);
  EXPECT_EQ(copy.append(numbered(7)), 6);
  EXPECT_EQ(numbers(copy), (std::vector{1, 2, 3, 4, 7}));
  EXPECT_EQ(numbers(Journal::open(file)), (std::vector{1, 2}));
}

/// Changes the tables of a journal with six strokes, the last two of them undone.
class DamagedJournal : public JournalFile,
                       public ::testing::WithParamInterface<std::pair<const char*, int>> {};

TEST_P(DamagedJournal, IsRefusedAndWhatStandsBeforeIsSaved) {
  {
    Journal j = Journal::open_or_create(file);
    for (int i = 1; i <= 6; ++i) j.append(numbered(i));
    j.undo(2);
  }
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, GetParam().first, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  sqlite3_close(db);
  EXPECT_THAT(failure([&] { Journal::open(file); }), HasSubstr("a.journal"));
  const std::string before = [&] {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }();
  const fs::path saved = root / "saved.journal";
  const int stand = GetParam().second;
  const std::string what = failure([&] {
    const Journal::Remains remains = Journal::salvage(file, saved);
    EXPECT_EQ(static_cast<int>(remains.history.size()), stand);
    EXPECT_NE(remains.damage, "");
  });
  EXPECT_EQ(what == "no error", stand > 0) << what;
  if (stand == 0) return;
  Journal j = Journal::open(saved);
  EXPECT_EQ(static_cast<int>(j.history().size()), stand);
  j.go_to(1);
  j.redo(100);
  j.append(numbered(7));
  EXPECT_EQ(numbers(Journal::open(saved)), numbers(j));
  EXPECT_THAT(failure([&] { Journal::salvage(file, saved); }), HasSubstr("exists already"));
  std::ifstream in(file, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), before);
}

constexpr const char* endless =
    "drop table state; create view state (head) as "
    "with recursive n(i) as (values (0) union all select i + 1 from n) select max(i) from n";

INSTANTIATE_TEST_SUITE_P(
    All, DamagedJournal,
    ::testing::Values(std::pair("update stroke set before = 5 where id = 2", 1),
                      std::pair("update stroke set before = 2 where id = 2", 1),
                      std::pair("update stroke set before = 99 where id = 6", 5),
                      std::pair("update stroke set before = -1 where id = 4", 3),
                      std::pair("update stroke set after = 3 where id = 5", 6),
                      std::pair("update stroke set after = 1 where id = 6", 6),
                      std::pair("update stroke set after = 100 where id = 6", 6),
                      std::pair("update stroke set after = 5 where id = 0", 6),
                      std::pair("update state set head = 77", 6), std::pair("delete from state", 6),
                      std::pair("insert into state values (3)", 6),
                      std::pair("delete from stroke where id = 3", 2),
                      std::pair("delete from stroke where id = 0", 6),
                      std::pair("update stroke set text = 'spere at=1,2,3' where id = 5", 4),
                      std::pair("insert into stroke (id, before, text) values (-4, 0, 'sphere at=1,2,3')", 0),
                      std::pair("create trigger t after insert on stroke begin delete from stroke; end", 0),
                      std::pair(endless, 0)));

TEST_F(JournalFile, RefusesANewerVersion) {
  Journal::open_or_create(file).append(numbered(1));
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  sqlite3_exec(db, "pragma user_version = 9", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_THAT(failure([&] { Journal::open(file); }), HasSubstr("version 9"));
}

TEST_F(JournalFile, EveryDamagedByteIsAnErrorOrHarmless) {
  {
    Journal j = Journal::open_or_create(file);
    for (int i = 0; i < 30; ++i) j.append(numbered(i));
  }
  std::ifstream in(file, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const fs::path bad = root / "bad.journal";
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 400) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5a);
    std::ofstream(bad, std::ios::binary | std::ios::trunc) << bytes;
    const std::string what = failure([&] { Journal::open(bad); });
    if (what == "no error") continue;
    ++refused;
    EXPECT_THAT(what, HasSubstr("bad.journal"));
  }
  EXPECT_GT(refused, 10);
  std::ofstream(bad, std::ios::binary | std::ios::trunc) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(failure([&] { Journal::open(bad); }), HasSubstr("is damaged"));
}

TEST_F(JournalFile, ALockedOneSaysSo) {
  Journal j = Journal::open_or_create(file);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "begin exclusive", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_THAT(failure([&] { j.append(numbered(1)); }), HasSubstr("is in use by another program"));
  sqlite3_exec(db, "rollback", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  j.append(numbered(2));
  EXPECT_EQ(numbers(j), (std::vector{2}));
}

TEST_F(JournalFile, AFullDiskLosesNothingThatWasThere) {
  Journal j = Journal::open_or_create(file);
  j.append(numbered(1));
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit tight = old;
  tight.rlim_cur = fs::file_size(file) + 2048;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  std::string what = "no error";
  int stored = 1;
  for (int i = 2; i < 500 && what == "no error"; ++i) {
    what = failure([&] { j.append(numbered(i)); });
    if (what == "no error") stored = i;
  }
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(what, HasSubstr("a.journal: cannot"));
  EXPECT_EQ(static_cast<int>(j.strokes().size()), stored);
  EXPECT_EQ(numbers(Journal::open(file)), numbers(j));
  j.append(numbered(stored + 1));
  EXPECT_EQ(static_cast<int>(Journal::open(file).strokes().size()), stored + 1);
}

TEST_F(JournalFile, AReadOnlyFolderCanBeReadAndNotWritten) {
  Journal::open_or_create(file).append(numbered(1));
  fs::permissions(file, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  fs::permissions(
      root, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // Root may write anywhere; nobody may not.
    if (::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(99);
    const auto says = [](const std::string& what, const char* words) {
      return what.find(words) != std::string::npos;
    };
    int wrong = 0;
    const std::string read = failure([&] {
      Journal j = Journal::open(file);
      if (numbers(j) != std::vector{1}) wrong |= 1;
      if (!says(failure([&] { j.append(numbered(2)); }), "cannot be")) wrong |= 2;
      if (numbers(j) != std::vector{1}) wrong |= 4;
    });
    if (read != "no error") wrong |= 8;
    if (!says(failure([&] { Journal::open_or_create(root / "b.journal"); }), "cannot write")) wrong |= 16;
    ::_exit(wrong);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  fs::permissions(root, fs::perms::owner_all);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace tafoni::scene
