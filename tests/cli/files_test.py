"""Files that commands read, write and leave: no input is overwritten, no output twice, and strokes are their scene's."""

import json
import os
import resource
import shutil
import subprocess
import sqlite3
import unittest

from case import TAFONI, Case


class Outputs(Case):
    def scene(self):
        self.hill(n=12)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 6\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n")

    def refused(self, says, *args):
        before = {p.name: p.read_bytes() for p in self.dir.rglob("*") if p.is_file()}
        self.fails(2, says, *args)
        self.assertEqual({p.name: p.read_bytes() for p in self.dir.rglob("*") if p.is_file()}, before, args)

    def test_no_output_is_written_twice_under_two_names(self):
        self.scene()
        (self.dir / "in").mkdir()
        (self.dir / "also").symlink_to("in")
        (self.dir / "to-come").symlink_to("o.glb")
        (self.dir / "a.glb").write_text("earlier")
        os.link(self.dir / "a.glb", self.dir / "hard.glb")
        for one, other in (("./o.glb", "o.glb"), ("in/o.glb", "also/o.glb"), ("in/../o.glb", "to-come"),
                           (str(self.dir / "o.glb"), "o.glb"), ("a.glb", "hard.glb")):
            for flags in (("-o", one, "--report", other), ("-o", one, "-o", other) if other.endswith(".glb") else
                          ("--report", other, "-o", one), ("-o", one, "--report", "r.json", "--report", other)[:2] +
                          ("--report", other)):
                self.refused("asked for twice", "build", "s.toml", *flags)
        self.refused("asked for twice", "build", "s.toml", "--save-scene", "t.toml", "--report", "./t.toml")
        self.refused("asked for twice", "build", "s.toml", "-o", "a.glb", "--tiles", "2", "--report", "in/../a_1_0.glb")
        self.refused("asked for twice", "sculpt", "s.toml", "--list", "--write", "w.txt", "--report", "./w.txt")

    def test_no_input_is_overwritten_under_another_name(self):
        self.scene()
        os.link(self.dir / "hill.asc", self.dir / "hard.json")
        (self.dir / "link.json").symlink_to("hill.asc")
        shutil.copy(self.dir / "hill.asc", self.dir / "a_0_1.glb")
        (self.dir / "t.toml").write_text((self.dir / "s.toml").read_text().replace("hill.asc", "a_0_1.glb"))
        (self.dir / "p.csv").write_text("x,y,z\n1,2,3\n")
        (self.dir / "w.strokes").write_text("sphere at=1,2,48\n")
        stroke = ("--stroke", "sphere at=7,7,48")
        for args in (("build", "s.toml", "--report", "./hard.json"), ("build", "s.toml", "--report", "link.json"),
                     ("build", "s.toml", "--report", "./s.toml"), ("amplify", "hill.asc", "--report", "hard.json"),
                     ("build", "t.toml", "-o", "a.glb", "--tiles", "2"), ("render", "s.toml", "-o", "link.png"),
                     ("query", "s.toml", "--points", "p.csv", "-o", "./p.csv"),
                     ("sculpt", "s.toml", "--write", "./s.toml", *stroke),
                     ("sculpt", "s.toml", "--write", "hard.json", *stroke),
                     ("sculpt", "s.toml", "--strokes", "w.strokes", "--write", "./w.strokes"),
                     ("sculpt", "s.toml", "--report", "./s.toml", *stroke)):
            if args[-1] == "link.png":
                (self.dir / "link.png").symlink_to("hill.asc")
            self.refused("is an input of this command", *args)
        self.assertFalse((self.dir / "s.sculpt.journal").exists())

    def test_a_scene_may_be_saved_to_itself(self):
        self.scene()
        self.passes("build", "s.toml", "--set", "scene.seed=3", "--save-scene", "./s.toml")
        self.assertIn("seed = 3", (self.dir / "s.toml").read_text())

    def test_the_longest_names_work(self):
        self.scene()
        name = "n" * 250
        self.passes("build", "s.toml", "-o", name + ".glb", "--report", name + ".json", "--preview", name + ".png")
        self.passes("build", "s.toml", "--save-scene", name + ".toml")
        self.passes("sculpt", name + ".toml", "--stroke", "sphere at=7,7,48", "--write", name + ".txt")
        self.fails(4, "File name too long", "build", "s.toml", "-o", name + ".glb", "--tiles", "2")
        self.assertEqual(len(self.files()), 8)


class Copies(Case):
    def scene(self):
        self.hill(n=12)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 6\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n")

    def strokes(self, scene):
        return len(json.loads(self.passes("sculpt", scene, "--list", "--json")))

    def test_a_copied_scene_and_its_original_go_apart(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=7,7,48")
        self.passes("build", "s.toml", "-o", "a.ply")
        before = (self.dir / "a.ply").read_bytes()
        shutil.copy(self.dir / "s.toml", self.dir / "v.toml")
        report = json.loads(self.passes("build", "v.toml", "-o", "a.ply", "--json"))
        self.assertIn("its strokes are those of", report["warnings"][-1])
        self.assertEqual((self.dir / "a.ply").read_bytes(), before)
        said = self.passes("sculpt", "v.toml", "--stroke", "sphere at=15,9,48 radius=9").splitlines()
        self.assertEqual(len(said), 2)
        self.assertIn("copied", said[1])
        self.assertEqual(len(self.passes("sculpt", "v.toml", "--stroke", "sphere at=15,9,48").splitlines()), 1)
        self.passes("build", "s.toml", "-o", "a.ply")
        self.assertEqual((self.dir / "a.ply").read_bytes(), before)
        self.assertEqual([self.strokes("s.toml"), self.strokes("v.toml")], [1, 3])

    def test_a_saved_copy_and_its_original_go_apart(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=7,7,48")
        (self.dir / "elsewhere").mkdir()
        self.passes("build", "s.toml", "--save-scene", "elsewhere/s.toml")
        self.passes("sculpt", "elsewhere/s.toml", "--undo", "1")
        self.assertEqual([self.strokes("s.toml"), self.strokes("elsewhere/s.toml")], [1, 0])
        self.passes("sculpt", "s.toml", "--undo", "1", "--save-scene", "t.toml")
        self.passes("sculpt", "t.toml", "--redo", "1")
        self.assertEqual([self.strokes("s.toml"), self.strokes("t.toml")], [0, 1])

    def test_a_first_stroke_on_a_full_disk_is_in_nobodys_way(self):
        self.scene()
        files = self.files()

        def full():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        command = (TAFONI, "sculpt", "s.toml", "--stroke", "sphere at=7,7,48")
        # Python ignores the signal that would end the process; so does the program then.
        done = subprocess.run(command, cwd=self.dir, capture_output=True, text=True, preexec_fn=full, restore_signals=False)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertEqual(self.files(), files)
        self.passes(*command[1:])
        self.assertEqual(self.strokes("s.toml"), 1)

    def test_many_first_strokes_at_once_are_all_kept(self):
        self.scene()
        children = [subprocess.Popen([TAFONI, "sculpt", "s.toml", "--stroke", f"sphere at={i},7,48"], cwd=self.dir,
                                     stdout=subprocess.DEVNULL) for i in range(6)]
        self.assertEqual([child.wait() for child in children], [0] * 6)
        self.assertEqual(self.strokes("s.toml"), 6)
        self.assertEqual(self.files(), ["hill.asc", "s.sculpt.journal", "s.toml"])


class Journals(Case):
    def sculpted(self):
        self.hill(n=12)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 6\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n")
        for i in range(5):
            self.passes("sculpt", "s.toml", "--stroke", f"sphere at={i},7,48")
        self.passes("sculpt", "s.toml", "--undo", "1", "--mute", "2")

    def damage(self, sql):
        with sqlite3.connect(self.dir / "s.sculpt.journal") as db:
            db.execute(sql)
        db.close()

    def test_a_journal_of_strokes_is_printed(self):
        self.sculpted()
        text = self.passes("journal", "s.sculpt.journal")
        self.assertIn("strokes of s.toml: 4 applied, 1 undone", text)
        found = json.loads(self.passes("journal", "s.sculpt.journal", "--json"))
        self.assertEqual(found["damage"], "")
        self.assertEqual([(s["id"], s["after"], s["applied"], s["muted"]) for s in found["strokes"]],
                         [(1, 0, True, False), (2, 1, True, True), (3, 2, True, False), (4, 3, True, False),
                          (5, 4, False, False)])

    def test_what_stands_before_a_damage_is_saved(self):
        self.sculpted()
        self.damage("update stroke set before = 5 where id = 4")
        whole = (self.dir / "s.sculpt.journal").read_bytes()
        for args in (("--undo", "1"), ("--redo", "100"), ("--go-to", "5"), ("--list",)):
            self.fails(3, "is damaged", "sculpt", "s.toml", *args)
        self.fails(3, "3 stand before the damage", "journal", "s.sculpt.journal")
        self.passes("journal", "s.sculpt.journal", "--salvage", "saved.journal")
        self.fails(2, "exists already", "journal", "s.sculpt.journal", "--salvage", "saved.journal")
        self.fails(2, "is an input", "journal", "s.sculpt.journal", "--salvage", "./s.sculpt.journal")
        self.assertEqual((self.dir / "s.sculpt.journal").read_bytes(), whole)
        (self.dir / "saved.journal").replace(self.dir / "s.sculpt.journal")
        self.assertEqual(len(json.loads(self.passes("sculpt", "s.toml", "--list", "--json", "--redo", "9"))), 3)

    @unittest.skipUnless("TAFONI_RECORD" in os.environ, "wants the program that records")
    def test_a_journal_of_edits_is_printed_and_saved(self):
        subprocess.run([os.environ["TAFONI_RECORD"], "g.edits", "9"], cwd=self.dir, check=True, capture_output=True)
        self.assertIn("edits of the terrain", self.passes("journal", "g.edits"))
        found = json.loads(self.passes("journal", "g.edits", "--json"))
        self.assertEqual([e["edit"] for e in found["edits"]], list(range(1, 10)))
        self.assertEqual(found["edits"][8], {"edit": 9, "does": "explode", "at": [0.0, 0.0, 0.8], "radius": 2.0, "energy": 5.0})
        whole = (self.dir / "g.edits").read_bytes()
        each = (len(whole) - 32) // 9
        (self.dir / "torn.edits").write_bytes(whole[:-5])
        self.assertIn("left unfinished", self.passes("journal", "torn.edits"))
        bad = bytearray(whole)
        bad[32 + 4 * each + 20] ^= 1
        (self.dir / "g.edits").write_bytes(bad)
        self.fails(3, "edit 5 is damaged", "journal", "g.edits")
        self.passes("journal", "g.edits", "--salvage", "saved.edits")
        self.assertEqual((self.dir / "saved.edits").read_bytes(), whole[:32 + 4 * each])
        subprocess.run([os.environ["TAFONI_RECORD"], "saved.edits", "1"], cwd=self.dir, check=True, capture_output=True)
        self.assertEqual(len(json.loads(self.passes("journal", "saved.edits", "--json"))["edits"]), 5)

    def test_other_files_are_refused(self):
        self.hill(n=12)
        self.fails(3, "is no sculpt journal", "journal", "hill.asc")
        self.fails(3, "does not exist", "journal", "none")
        os.mkfifo(self.dir / "pipe")
        self.fails(3, "is no sculpt journal", "journal", "pipe")
        (self.dir / "empty").touch()
        self.assertIn("0 applied", self.passes("journal", "empty"))
