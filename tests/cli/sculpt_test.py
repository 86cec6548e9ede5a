"""tafoni sculpt: strokes are kept, undone and brought back."""

import json
import subprocess

from case import TAFONI, Case


class Sculpt(Case):
    def scene(self):
        self.hill()
        (self.dir / "s.toml").write_text("# mine\n[scene]\nvoxel = 4  # coarse\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n")

    def strokes(self, *args):
        return json.loads(self.passes("sculpt", "s.toml", "--list", "--json", *args))

    def test_strokes_are_kept_undone_and_brought_back(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=30,30,48 radius=6",
                    "--stroke", "arch at=40,40,50/60,40,50 mode=add height=8")
        text = (self.dir / "s.toml").read_text()
        self.assertIn("# mine", text)
        self.assertIn("voxel = 4  # coarse", text)
        self.assertEqual(len(self.strokes()), 2)
        self.assertEqual(len(self.strokes("--undo", "1")), 1)
        self.assertEqual(len(self.strokes("--undo", "9")), 0)
        self.assertEqual(len(self.strokes("--redo", "2")), 2)
        self.assertTrue(self.strokes("--mute", "2")[1]["muted"])
        self.passes("sculpt", "s.toml", "--undo", "1", "--stroke", "sphere at=10,10,48")
        self.assertEqual([s["id"] for s in self.strokes()], [1, 3])
        self.assertEqual(len(json.loads(self.passes("sculpt", "s.toml", "--all", "--json"))), 3)
        self.assertEqual([s["id"] for s in self.strokes("--go-to", "2")], [1, 2])
        (self.dir / "hill.asc").rename(self.dir / "away.asc")
        self.assertEqual(len(self.strokes()), 2, "to list them no ground is read")
        (self.dir / "away.asc").rename(self.dir / "hill.asc")
        for args, said in ((("--mute", "2"), "muted  stroke 2, as it was before"), (("--unmute", "2"), "unmuted  stroke 2\n"),
                           (("--go-to", "3"), "applied  2 strokes"), (("--go-to", "2"), "applied  2 strokes"),
                           (("--write", "w.txt"), "wrote  2 strokes to w.txt")):
            self.assertIn(said, self.passes("sculpt", "s.toml", *args))
        self.assertEqual(json.loads(self.passes("sculpt", "s.toml", "--mute", "2", "--json")), {"muted": 1})
        self.assertEqual(json.loads(self.passes("sculpt", "s.toml", "--mute", "2", "--json")), {"muted": 0})
        self.passes("build", "s.toml", "-o", "a.glb")
        self.passes("validate", "a.glb", "--closed")
        self.assertFalse([name for name in self.files() if name.endswith("-journal")])

    def test_a_text_file_builds_what_the_journal_does(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--strokes", "-", stdin="sphere at=30,30,48 radius=6\n# no stroke\ncave at=20,50,49/60,50,50 radius=4\n")
        self.passes("build", "s.toml", "-o", "a.ply")
        journal = (self.dir / "a.ply").read_bytes()
        self.passes("sculpt", "s.toml", "--write", "w.strokes")
        text = (self.dir / "s.toml").read_text()
        (self.dir / "t.toml").write_text(text.replace('journal = "s.sculpt.journal"', 'strokes = "w.strokes"'))
        self.passes("build", "t.toml", "-o", "a.ply")
        self.assertEqual((self.dir / "a.ply").read_bytes(), journal)

    def test_wrong_strokes_are_one_sentence_and_change_nothing(self):
        self.scene()
        before = (self.dir / "s.toml").read_text()
        self.fails(2, "did you mean \"sphere\"?", "sculpt", "s.toml", "--stroke", "spere at=1,2,3")
        self.fails(2, "must be X,Y,Z", "sculpt", "s.toml", "--stroke", "sphere at=1,2")
        self.fails(2, "nothing to do", "sculpt", "s.toml")
        self.fails(2, "kept with a scene file", "sculpt", "hill.asc", "--list")
        self.assertEqual((self.dir / "s.toml").read_text(), before)
        self.assertEqual(self.files(), ["hill.asc", "s.toml"])
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=30,30,48")
        (self.dir / "s.sculpt.journal").write_bytes(b"no journal at all" * 100)
        self.fails(3, "is no sculpt journal", "build", "s.toml", "-o", "a.glb")

    def test_killed_while_it_sculpts_it_loses_nothing_that_was_stored(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=0,0,48")
        for i in range(1, 6):
            child = subprocess.Popen([TAFONI, "sculpt", "s.toml", "--stroke", f"sphere at={i},0,48"], cwd=self.dir,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            # Its transaction is open while SQLite's own journal of it is there.
            while child.poll() is None and not (self.dir / "s.sculpt.journal-journal").exists():
                pass
            child.kill()
            child.wait()
            found = [float(s["stroke"].split("at=")[1].split(",")[0]) for s in self.strokes()]
            self.assertEqual(found[0], 0)
            self.assertEqual(found, sorted(found))
            self.assertLessEqual(len(found), i + 1)
