#include "tafoni/runtime/journal.h"

#include <csignal>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/runtime/test/operations.h"

namespace tafoni::runtime {
namespace {

namespace fs = std::filesystem;

constexpr Digest base = 0x123456789abcdef0;

class EditJournal : public ::testing::Test {
 protected:
  std::string bytes() const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void set_bytes(const std::string& all) const {
    std::ofstream(file, std::ios::binary | std::ios::trunc).write(all.data(), static_cast<long>(all.size()));
  }
  static std::vector<Message> messages(std::uint64_t n) {
    std::vector<Message> out;
    for (std::uint64_t i = 0; i < n; ++i)
      out.push_back(encode(random_operation(i, {{-100, -100, -100}, {100, 100, 100}}, 5)));
    return out;
  }
  static JournalContents parse(const std::string& all) {
    return parse_journal(std::as_bytes(std::span(all)), "a.edits");
  }
  const TestFolder folder;
  const fs::path root = folder.path;
  fs::path file = root / "a.edits";
};

TEST_F(EditJournal, GivesBackWhatWasAppended) {
  const auto all = messages(10000);
  const std::vector<Message> first(all.begin(), all.begin() + 10);
  write_journal(file, base, first);
  {
    JournalWriter writer(file, read_journal(file));
    for (std::size_t i = 10; i < all.size(); ++i) writer.append({&all[i], 1});
    writer.sync();
  }
  const JournalContents contents = read_journal(file);
  EXPECT_EQ(contents.base, base);
  EXPECT_EQ(contents.edits, all);
  EXPECT_EQ(contents.torn, 0u);
  EXPECT_EQ(contents.bytes, fs::file_size(file));
  const std::string appended = bytes();
  write_journal(file, base, all);
  EXPECT_EQ(bytes(), appended);
}

TEST_F(EditJournal, IsCutAtTheLastWholeEdit) {
  const auto all = messages(12);
  write_journal(file, base, {});
  std::vector<std::size_t> ends{bytes().size()};  // of n whole edits
  {
    JournalWriter writer(file, read_journal(file));
    for (const Message& m : all) {
      writer.append({&m, 1});
      ends.push_back(bytes().size());
    }
  }
  const std::string full = bytes();
  for (std::size_t size = ends[0]; size <= full.size(); ++size)
    for (const bool with_zeros : {false, true}) {
      // Cut, or as long as it was but with the end never written.
      std::string torn = full.substr(0, size);
      if (with_zeros) torn.resize(full.size(), '\0');
      std::size_t n = 0;
      while (n < all.size() && ends[n + 1] <= size) ++n;
      const JournalContents contents = parse(torn);
      ASSERT_EQ(contents.edits.size(), n) << size << (with_zeros ? " with zeros" : "");
      ASSERT_EQ(contents.torn, torn.size() - ends[n]);
      if (size % 37 != 0) continue;
      set_bytes(torn);
      // Going on from there gives what never was torn.
      JournalWriter writer(file, read_journal(file));
      for (std::size_t i = n; i < all.size(); ++i) writer.append({&all[i], 1});
      ASSERT_EQ(bytes(), full);
    }
}

TEST_F(EditJournal, EveryFlippedBitIsNoticed) {
  const auto all = messages(60);
  write_journal(file, base, all);
  const std::string full = bytes();
  for (std::size_t bit = 0; bit < 8 * full.size(); ++bit) {
    std::string flipped = full;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    try {
      parse(flipped);
      ADD_FAILURE() << "bit " << bit << " of " << 8 * full.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), testing::HasSubstr("a.edits"));
    }
  }
}

TEST_F(EditJournal, WhatCouldNotBeCutOffIsNeverAppendedTo) {
  // A file that may not shrink, and no room: neither the write nor the cut after it is done.
  const auto all = messages(3);
  write_journal(file, base, {all[0]});
  const std::string start = bytes();
  const int fd = ::memfd_create("journal", MFD_ALLOW_SEALING);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(::write(fd, start.data(), start.size()), static_cast<ssize_t>(start.size()));
  ASSERT_EQ(::fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK), 0);
  file = "/proc/self/fd/" + std::to_string(fd);
  {
    JournalWriter writer(file, read_journal(file));
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit old_limit{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    rlimit limit = old_limit;
    limit.rlim_cur = start.size() + 20;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    EXPECT_THAT(error_of([&] {
                  writer.append({&all[1], 1});
                }),
                ::testing::HasSubstr("the edit was not made"));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
    std::signal(SIGXFSZ, old_handler);
    ASSERT_EQ(bytes().size(), start.size() + 20) << "the file was to keep a torn edit";
    // There is room again, but behind a torn edit nothing would ever be read.
    EXPECT_THAT(error_of([&] { writer.append({&all[2], 1}); }), ::testing::HasSubstr("cannot be cut off"));
    EXPECT_EQ(bytes().size(), start.size() + 20);
  }
  const JournalContents contents = read_journal(file);
  EXPECT_EQ(contents.edits.size(), 1u);
  EXPECT_EQ(contents.torn, 20u);
  ::close(fd);
}

TEST_F(EditJournal, RecordsCannotBeMovedOrMixed) {
  const auto all = messages(3);
  write_journal(file, base, {all[0], all[1]});
  const std::string one = bytes();
  write_journal(file, base, {all[0]});
  const std::size_t first = bytes().size();
  write_journal(file, base + 1, {});
  const std::string other_head = bytes();
  set_bytes(one.substr(0, 32) + one.substr(first));  // edit 1 is lost
  EXPECT_THAT(error_of([&] { read_journal(file); }), ::testing::HasSubstr("edit 1 is damaged"));
  set_bytes(other_head + one.substr(32));
  EXPECT_THAT(error_of([&] { read_journal(file); }), ::testing::HasSubstr("edit 1 is damaged"));
}

TEST_F(EditJournal, WhatStandsBeforeADamageCanBeHad) {
  const auto all = messages(20);
  write_journal(file, base, {});
  std::vector<std::size_t> ends{bytes().size()};
  for (std::size_t n = 1; n <= all.size(); ++n) {
    write_journal(file, base, {all.begin(), all.begin() + static_cast<long>(n)});
    ends.push_back(bytes().size());
  }
  const std::string full = bytes();
  EXPECT_TRUE(is_journal(file));
  EXPECT_EQ(survey_journal(file).damage, "");
  for (std::size_t at = ends[0]; at < full.size(); at += 7) {
    std::string bad = full;
    bad[at] = static_cast<char>(bad[at] ^ 0x40);
    set_bytes(bad);
    std::size_t n = 0;
    while (ends[n + 1] <= at) ++n;
    const JournalContents contents = survey_journal(file);
    EXPECT_THAT(contents.damage, testing::HasSubstr("edit " + std::to_string(n + 1) + " is damaged"));
    const fs::path saved = root / "saved.edits";
    fs::remove(saved);
    ASSERT_TRUE(make_journal(saved, contents.base, contents.edits));
    EXPECT_FALSE(make_journal(saved, contents.base, contents.edits));
    EXPECT_EQ(read_journal(saved).edits,
              std::vector<Message>(all.begin(), all.begin() + static_cast<long>(n)));
  }
}

TEST_F(EditJournal, HasOneWriterAtATime) {
  const auto all = messages(4);
  write_journal(file, base, {all[0]});
  const JournalContents early = read_journal(file);
  {
    JournalWriter writer(file, read_journal(file));
    EXPECT_THAT(error_of([&] { JournalWriter(file, read_journal(file)); }),
                ::testing::HasSubstr("another program records in it"));
    EXPECT_THAT(error_of([&] { write_journal(file, base, {}); }),
                ::testing::HasSubstr("a program records in it"));
    fs::create_symlink(file, root / "link");
    EXPECT_THAT(error_of([&] { write_journal(root / "link", base, {}); }),
                ::testing::HasSubstr("a program records in it"));
    writer.append({&all[1], 1});
    EXPECT_EQ(read_journal(file).edits.size(), 2u);
  }
  // What was read before another wrote is not gone on with.
  EXPECT_THAT(error_of([&] { JournalWriter(file, early); }), ::testing::HasSubstr("was changed"));
  JournalWriter(file, read_journal(file)).append({&all[2], 1});
  EXPECT_EQ(read_journal(file).edits, std::vector<Message>(all.begin(), all.begin() + 3));
}

TEST_F(EditJournal, OfProgramsThatBeginAtOnceOneRecordsAndTheOthersAreTold) {
  const auto all = messages(5);
  std::vector<pid_t> children;
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  for (int i = 0; i < 6; ++i) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    ::close(ends[1]);
    const std::string what = error_of([&] {
      make_journal(file, base, {});
      JournalWriter writer(file, read_journal(file));
      writer.append(all);
      char x;
      (void)!::read(ends[0], &x, 1);  // it does not end, and free the file, before all have tried
    });
    ::_exit(what.empty() ? 0 : what.find("records in it") == std::string::npos ? 2 : 1);
  }
  ::close(ends[0]);
  ::usleep(300000);
  ::close(ends[1]);
  int recorded = 0;
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_NE(WEXITSTATUS(status), 2);
    recorded += WEXITSTATUS(status) == 0;
  }
  EXPECT_EQ(recorded, 1);
  EXPECT_EQ(read_journal(file).edits.size(), 5u);
}

TEST_F(EditJournal, OtherFilesAreRefused) {
  EXPECT_THAT(error_of([&] { read_journal(file); }), ::testing::HasSubstr("does not exist; check the path"));
  ASSERT_EQ(::mkfifo((root / "pipe").c_str(), 0600), 0);
  for (const fs::path& endless : {root / "pipe", fs::path("/dev/zero")})
    EXPECT_THAT(error_of([&] { read_journal(endless); }), ::testing::HasSubstr("is a pipe or a device"));
  for (const std::string& text : {std::string(), std::string("not a journal, but a text of some length")}) {
    set_bytes(text);
    EXPECT_THAT(error_of([&] { read_journal(file); }),
                ::testing::HasSubstr("is no journal of a terrain's edits"));
  }
  EXPECT_THAT(error_of([&] { JournalWriter(root / "none" / "b.edits", {}); }),
              ::testing::HasSubstr("cannot append to"));
  EXPECT_THAT(error_of([&] { write_journal(root / "none" / "b.edits", base, {}); }),
              ::testing::HasSubstr("cannot write"));
}

}  // namespace
}  // namespace tafoni::runtime
