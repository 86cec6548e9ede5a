// Scenes that are copied, moved and made at once: whose strokes are whose.
#include "tafoni/scene/sculpt/impl/own_journal.h"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/heard_warnings.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/csv.h"
#include "tafoni/scene/sculpt/copy.h"
#include "tafoni/scene/session.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class OwnJournal : public ::testing::Test {
 protected:
  fs::path make(const std::string& name = "a.toml") const {
    fs::create_directories((root / name).parent_path());
    std::ofstream(root / name) << "[terrain]\ngenerator = \"coast\"\nwidth = 24\nheight = 20\n";
    return root / name;
  }
  static void stroke(const fs::path& scene, int number, std::string_view layer = {}) {
    Session session = Session::open(scene);
    stroke(session, number, layer);
  }
  static void stroke(Session& session, int number, std::string_view layer = {}) {
    session.stroke(session.sculpt_layer(layer),
                   parse_stroke("sphere at=" + std::to_string(number) + ",0,0", "stroke"));
  }
  static std::vector<int> strokes(const fs::path& scene, std::string_view layer = {}) {
    Session session = Session::open(scene);
    std::vector<int> out;
    for (const auto& entry : session.strokes(session.sculpt_layer(layer)))
      out.push_back(static_cast<int>(entry.stroke->points[0].x));
    return out;
  }
  static void undo(const fs::path& scene) {
    Session session = Session::open(scene);
    session.undo(session.sculpt_layer());
  }
  std::vector<std::string> files() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(root))
      if (entry.is_regular_file()) out.push_back(entry.path().lexically_relative(root).string());
    return out;
  }
  const TestFolder folder;
  const fs::path root = folder.path;
};

TEST_F(OwnJournal, ACopiedSceneGoesItsOwnWayFromItsFirstChange) {
  const fs::path a = make();
  stroke(a, 1);
  stroke(a, 2);
  fs::copy(a, root / "b.toml");
  EXPECT_THAT(strokes(root / "b.toml"), ElementsAre(1, 2));
  Session session = Session::open(root / "b.toml");
  ASSERT_TRUE(session.borrowed_from(0));
  EXPECT_TRUE(fs::equivalent(*session.borrowed_from(0), a));
  stroke(session, 3);
  EXPECT_FALSE(session.borrowed_from(0));
  EXPECT_THAT(strokes(root / "b.toml"), ElementsAre(1, 2, 3));
  EXPECT_THAT(strokes(a), ElementsAre(1, 2));
  undo(root / "b.toml");
  undo(a);
  EXPECT_THAT(strokes(root / "b.toml"), ElementsAre(1, 2));
  EXPECT_THAT(strokes(a), ElementsAre(1));
  EXPECT_FALSE(Session::open(a).borrowed_from(0));
  EXPECT_THAT(files(), UnorderedElementsAre("a.toml", "a.sculpt.journal", "b.toml", "b.sculpt.journal"));
}

TEST_F(OwnJournal, EveryChangeOfACopyLeavesTheOriginalAlone) {
  const fs::path a = make();
  for (int i = 1; i <= 3; ++i) stroke(a, i);
  undo(a);
  const std::string before = io::read_text(root / "a.sculpt.journal");
  const std::vector<std::function<void(Session&)>> changes = {
      [](Session& s) { s.undo(0); }, [](Session& s) { s.redo(0); }, [](Session& s) { s.go_to(0, 1); },
      [](Session& s) { s.mute_stroke(0, 1, true); }};
  for (const auto& change : changes) {
    fs::copy(a, root / "b.toml", fs::copy_options::overwrite_existing);
    Session session = Session::open(root / "b.toml");
    change(session);
    EXPECT_EQ(io::read_text(root / "a.sculpt.journal"), before);
  }
}

TEST_F(OwnJournal, ACopyOfAnEarlierProgramsSceneIsKnownByTheJournalsName) {
  const fs::path a = make();
  stroke(a, 1);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open((root / "a.sculpt.journal").c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "drop table scene", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(db);
  fs::copy(a, root / "b.toml");
  stroke(root / "b.toml", 2);
  EXPECT_THAT(strokes(a), ElementsAre(1));
  stroke(a, 3);
  EXPECT_THAT(strokes(a), ElementsAre(1, 3));
  EXPECT_THAT(strokes(root / "b.toml"), ElementsAre(1, 2));
}

TEST_F(OwnJournal, AScenesJournalMovesWithIt) {
  const fs::path a = make("one/a.toml");
  stroke(a, 1);
  // The folder; then the scene alone; then both, with the key changed; then another scene takes the old name.
  fs::rename(root / "one", root / "two");
  stroke(root / "two/a.toml", 2);
  fs::rename(root / "two/a.toml", root / "two/c.toml");
  stroke(root / "two/c.toml", 3);
  make("two/a.toml");
  stroke(root / "two/c.toml", 4);
  EXPECT_THAT(strokes(root / "two/c.toml"), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(files().size(), 3u);
  fs::rename(root / "two/c.toml", root / "two/d.toml");
  fs::rename(root / "two/a.sculpt.journal", root / "two/d.journal");
  std::string text = io::read_text(root / "two/d.toml");
  text.replace(text.find("a.sculpt.journal"), 16, "d.journal");
  std::ofstream(root / "two/d.toml") << text;
  stroke(root / "two/d.toml", 5);
  EXPECT_THAT(strokes(root / "two/d.toml"), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(files().size(), 3u);
}

TEST_F(OwnJournal, CopiedFoldersAreApart) {
  stroke(make("one/a.toml"), 1);
  fs::copy(root / "one", root / "two", fs::copy_options::recursive);
  stroke(root / "two/a.toml", 2);
  EXPECT_THAT(strokes(root / "one/a.toml"), ElementsAre(1));
  EXPECT_THAT(strokes(root / "two/a.toml"), ElementsAre(1, 2));
  EXPECT_EQ(files().size(), 4u);
}

TEST_F(OwnJournal, ALinkIsTheSceneItself) {
  const fs::path a = make("one/a.toml");
  fs::create_symlink("one/a.toml", root / "link.toml");
  stroke(root / "link.toml", 1);
  stroke(a, 2);
  EXPECT_THAT(strokes(root / "link.toml"), ElementsAre(1, 2));
  EXPECT_THAT(strokes(a), ElementsAre(1, 2));
  EXPECT_TRUE(fs::is_symlink(root / "link.toml"));
  EXPECT_THAT(files(), UnorderedElementsAre("one/a.toml", "one/a.sculpt.journal", "link.toml"));
}

TEST_F(OwnJournal, ACopiedLayerGetsItsOwnToo) {
  const fs::path a = make();
  stroke(a, 1, "low");
  std::ofstream(a, std::ios::app) << "\n[[layer]]\ntype = \"sculpt\"\nname = \"high\"\njournal = "
                                     "\"a.low.journal\"\n";
  stroke(a, 2, "high");
  stroke(a, 3, "low");
  EXPECT_THAT(strokes(a, "low"), ElementsAre(1, 3));
  EXPECT_THAT(strokes(a, "high"), ElementsAre(1, 2));
}

TEST_F(OwnJournal, ASavedCopyTakesItsStrokesAlong) {
  const fs::path a = make();
  for (int i = 1; i <= 3; ++i) stroke(a, i);
  undo(a);
  fs::create_directory(root / "b");
  const fs::path copy = root / "b/a.toml";
  for (int times = 0; times < 2; ++times) save_copy(load_scene(a), copy);
  EXPECT_EQ(files().size(), 4u) << "the same again makes no more";
  EXPECT_THAT(io::read_text(copy), HasSubstr("journal = \"a.sculpt"));
  undo(copy);
  EXPECT_THAT(strokes(copy), ElementsAre(1));
  EXPECT_THAT(strokes(a), ElementsAre(1, 2));
  Session session = Session::open(copy);
  EXPECT_EQ(session.redo(0, 9), 2u) << "undone strokes came along";
  // Strokes of the copy's own are not overwritten by saving over it.
  stroke(copy, 4);
  HeardWarnings heard;
  save_copy(load_scene(a), copy, heard);
  EXPECT_THAT(heard.said, ElementsAre(HasSubstr("its strokes stay in ")));
  EXPECT_THAT(strokes(copy), ElementsAre(1, 2));
  EXPECT_EQ(files().size(), 5u);
  // Onto itself it stays as it is.
  save_copy(load_scene(a), root / "b/../a.toml");
  EXPECT_EQ(files().size(), 5u);
  EXPECT_THAT(strokes(a), ElementsAre(1, 2));
}

TEST_F(OwnJournal, ACopyThatFailsLeavesTheFormerOneWhole) {
  const fs::path a = make();
  stroke(a, 1);
  const fs::path copy = root / "copy.toml";
  save_copy(load_scene(a), copy);
  stroke(a, 2);
  Document unsaved = load_scene(a);
  unsaved.layers.push_back(unsaved.layers.back());
  unsaved.layers.back().settings.name = "second";
  unsaved.layers.back().values["journal"] = std::string("nowhere.journal");
  EXPECT_ANY_THROW(save_copy(unsaved, copy));
  EXPECT_THAT(strokes(copy), ElementsAre(1));
}

TEST_F(OwnJournal, SavingOntoItselfKeepsWhatOthersWrote) {
  const fs::path a = make();
  Document document = load_scene(a);
  set(document, "scene.seed=5");
  stroke(a, 1);
  EXPECT_THAT(error_of([&] { save_copy(document, a); }), HasSubstr("was changed by another program"));
  EXPECT_THAT(strokes(a), ElementsAre(1));
}

TEST_F(OwnJournal, AMissingJournalIsBegunAnew) {
  const fs::path a = make();
  stroke(a, 1);
  fs::remove(root / "a.sculpt.journal");
  Session session = Session::open(a);
  EXPECT_EQ(session.missing_journal(0), root / "a.sculpt.journal");
  stroke(a, 2);
  EXPECT_THAT(strokes(a), ElementsAre(2));
}

TEST_F(OwnJournal, TheFirstOfTwoLayersGetsItsOwnToo) {
  const fs::path a = make();
  stroke(a, 1, "low");
  std::ofstream(a, std::ios::app) << "\n[[layer]]\ntype = \"sculpt\"\nname = \"high\"\njournal = "
                                     "\"a.low.journal\"\n";
  stroke(a, 2, "low");
  EXPECT_THAT(strokes(a, "low"), ElementsAre(1, 2));
  EXPECT_THAT(strokes(a, "high"), ElementsAre(1));
}

TEST_F(OwnJournal, ManyFirstStrokesAtOnceAreAllKept) {
  const fs::path a = make();
  std::vector<pid_t> children;
  std::vector<int> all;
  for (int i = 0; i < 12; ++i) {
    all.push_back(i);
    children.push_back(::fork());
    if (children.back() != 0) continue;
    try {
      stroke(a, i);
    } catch (...) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_THAT(strokes(a), ::testing::UnorderedElementsAreArray(all));
  EXPECT_THAT(files(), UnorderedElementsAre("a.toml", "a.sculpt.journal"));
}

TEST_F(OwnJournal, SessionsOpenedBeforeTheFirstStrokeMeet) {
  const fs::path a = make();
  Session first = Session::open(a), second = Session::open(a), named = Session::open(a),
          changed = Session::open(a);
  stroke(first, 1);
  stroke(second, 2);
  EXPECT_THAT(strokes(a), ElementsAre(1, 2));
  stroke(named, 3, "other");
  EXPECT_THAT(strokes(a, "other"), ElementsAre(3));
  changed.set("scene.seed=9");
  EXPECT_THAT(error_of([&] { stroke(changed, 4); }), HasSubstr("was changed by another program"));
  EXPECT_THAT(error_of([&] { changed.save(); }), HasSubstr("was changed by another program"));
  EXPECT_EQ(load_scene(a).scene.seed, 0);
}

TEST_F(OwnJournal, WhatAFirstStrokeLeftIsTakenUp) {
  const fs::path a = make();
  // Killed by an earlier program: a file of no bytes, and SQLite's own beside it.
  std::ofstream(root / "a.sculpt.journal").flush();
  std::ofstream(root / "a.sculpt.journal-journal") << std::string(512, '\0');
  stroke(a, 1);
  EXPECT_THAT(strokes(a), ElementsAre(1));
  EXPECT_THAT(files(), UnorderedElementsAre("a.toml", "a.sculpt.journal"));
  // Killed between journal and scene.
  const fs::path b = make("b.toml");
  ASSERT_TRUE(Journal::make(root / "b.sculpt.journal", "b.toml"));
  stroke(b, 2);
  EXPECT_THAT(strokes(b), ElementsAre(2));
  EXPECT_EQ(files().size(), 4u);
  // What is in the way and no such thing stays.
  const fs::path c = make("c.toml");
  std::ofstream(root / "c.sculpt.journal") << "a user's own";
  stroke(c, 3);
  EXPECT_THAT(strokes(c), ElementsAre(3));
  EXPECT_EQ(io::read_text(root / "c.sculpt.journal"), "a user's own");
}

TEST_F(OwnJournal, LongAndOddNamesFindRoom) {
  const fs::path a = make(std::string(250, 'n') + ".toml");
  stroke(a, 1);
  stroke(a, 2, "a/b\n\xc3\xa9");
  EXPECT_THAT(strokes(a), ElementsAre(2));
  EXPECT_EQ(files().size(), 3u);
}

}  // namespace
}  // namespace tafoni::scene
