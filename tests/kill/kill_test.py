"""Kills commands before each of their system calls, and looks at what is left: nothing that was said to be done is lost,
the next command is not in its way, and leaves no file but its own.

`kill_test.py` kills before the calls that change files or take locks, between which a kill leaves the same; with --all
before every one. It wants the programs in TAFONI_CLI, TAFONI_KILL_AT and TAFONI_RECORD."""

import json
import os
import subprocess
import sys
import unittest
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
from case import TAFONI, Case  # noqa: E402

KILL_AT, RECORD = os.environ["TAFONI_KILL_AT"], os.environ["TAFONI_RECORD"]
ALL = "--all" in sys.argv
# LeakSanitizer stops a program that is traced, as those that are killed at a call are.
TRACED = {**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"}


class Kill(Case):
    def kills(self, path, *command):
        """Runs the command once for each place to be killed at, each time in the folder as it is now. Yields what it
        printed; the folder is then as the kill left it."""
        before = {p.name: p.read_bytes() for p in self.dir.iterdir()}
        # With one thread, so that the calls come in one order.
        how = [KILL_AT] if ALL else [KILL_AT, "--changes"]
        self.kept = Counter()
        at = 0
        while True:
            at += 1
            for p in self.dir.iterdir():
                self.assertTrue(p.is_file(), p)
                p.unlink()
            for name, data in before.items():
                (self.dir / name).write_bytes(data)
            done = subprocess.run([*how, str(at), path, *command], cwd=self.dir, env=TRACED, capture_output=True, text=True,
                                  timeout=300)
            *_, last = done.stderr.splitlines()
            self.assertIn(last.split()[0], ("killed", "ended"), done.stderr)
            self.at = f"call {at}: {last}"
            if last.startswith("ended"):
                self.assertTrue(last.startswith("ended 0"), done.stderr)
                print(f"{self.id().split('.')[-1]}: {at - 1} kills, {sum(self.kept.values())} left a file until the next "
                      f"command: {dict(self.kept)}", file=sys.stderr)
                self.assertGreater(at, 10)
                return
            yield done.stdout

    def expect_files(self, *names):
        self.assertEqual(self.files(), sorted(names), self.at)

    def note_left(self, *names):
        """Counts the kills that leave a file which is neither an input nor an output, and what kind."""
        self.kept.update("temporary" if name.startswith(".") else name for name in self.files() if name not in names)

    def scene(self):
        self.hill(n=12)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 6\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n")

    def strokes(self, *args, scene="s.toml"):
        return [s["stroke"].split("at=")[1].split(",")[0]
                for s in json.loads(self.passes("sculpt", scene, "--list", "--json", *args))]

    def sculpt(self, before):
        places = ("hill.asc", "s.toml", "s.sculpt.journal")
        for printed in self.kills("s.toml", TAFONI, "sculpt", "s.toml", "--stroke", "sphere at=7,7,48", "--threads", "1"):
            self.note_left(*places)
            made = "stored" in printed
            found = self.strokes("--stroke", "sphere at=9,9,48")
            self.assertIn(found, [before + ["7", "9"]] + [before + ["9"]] * (not made), self.at)
            self.expect_files(*places)

    def test_first_stroke(self):
        self.scene()
        self.sculpt([])

    def test_append(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=1,1,48")
        self.sculpt(["1"])

    def test_first_stroke_of_a_copied_scene(self):
        self.scene()
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=1,1,48")
        (self.dir / "c.toml").write_bytes((self.dir / "s.toml").read_bytes())
        places = ("c.sculpt.journal", "c.toml", "hill.asc", "s.sculpt.journal", "s.toml")
        for _ in self.kills("c.toml", TAFONI, "sculpt", "c.toml", "--stroke", "sphere at=7,7,48", "--threads", "1"):
            self.note_left(*places)
            self.passes("sculpt", "c.toml", "--stroke", "sphere at=9,9,48")
            self.assertEqual(self.strokes(), ["1"], self.at)
            self.expect_files(*places)

    def test_a_copy_saved_again(self):
        self.scene()
        save = ("build", "s.toml", "--save-scene", "c.toml", "--threads", "1")
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=1,1,48")
        self.passes(*save)
        self.passes("sculpt", "s.toml", "--stroke", "sphere at=2,2,48")
        places = ["c.toml", "hill.asc", "s.sculpt.journal", "s.toml"]
        for _ in self.kills("c.toml", TAFONI, *save):
            self.note_left(*places, "c.sculpt.journal", "c.sculpt-2.journal")
            self.assertIn(self.strokes(scene="c.toml"), (["1"], ["1", "2"]), self.at)
            self.passes(*save)
            self.assertEqual(self.strokes(scene="c.toml"), ["1", "2"], self.at)
            journals = [name for name in self.files() if name.startswith("c.sculpt")]
            self.assertEqual(len(journals), 1, self.at)
            self.expect_files(*places, *journals)

    def build(self):
        outputs = ("a.glb", "b.ply", "r.json")
        command = ("build", "s.toml", "-o", "a.glb", "-o", "b.ply", "--report", "r.json", "--threads", "1")
        places = (*outputs, "hill.asc", "s.toml")
        before = {name: (self.dir / name).read_bytes() for name in outputs if (self.dir / name).exists()}
        whole = None
        for _ in self.kills("s.toml", TAFONI, *command):
            self.note_left(*places)
            found = {name: (self.dir / name).read_bytes() for name in outputs if (self.dir / name).exists()}
            self.passes(*command)
            self.expect_files(*places)
            whole = whole or {name: (self.dir / name).read_bytes() for name in outputs[:2]}
            for name in outputs[:2]:
                self.assertIn(found.get(name), (before.get(name), whole[name]), self.at)
            if found.get("r.json") != before.get("r.json"):
                json.loads(found["r.json"])

    def test_build(self):
        self.scene()
        self.build()

    def test_build_over_earlier_files(self):
        self.scene()
        for name in ("a.glb", "b.ply", "r.json"):
            (self.dir / name).write_text("earlier")
        self.build()

    def test_build_of_tiles(self):
        self.scene()
        command = ("build", "s.toml", "-o", "a.glb", "--tiles", "2", "--threads", "1")
        places = ("a_0_0.glb", "a_0_1.glb", "a_1_0.glb", "a_1_1.glb", "hill.asc", "s.toml")
        for _ in self.kills("s.toml", TAFONI, *command):
            self.note_left(*places)
            self.passes(*command)
            self.expect_files(*places)

    def record(self, before):
        for printed in self.kills("g.edits", RECORD, "g.edits", "3"):
            self.note_left("g.edits")
            made = before + printed.count("made")
            if made or (self.dir / "g.edits").exists():
                found = json.loads(self.passes("journal", "g.edits", "--json"))
                self.assertIn(len(found["edits"]) - made, (0, 1), self.at)
                self.assertEqual(found["damage"], "")
            subprocess.run([RECORD, "g.edits", "1"], cwd=self.dir, check=True, capture_output=True)
            found = json.loads(self.passes("journal", "g.edits", "--json"))
            self.assertIn(len(found["edits"]) - made, (1, 2), self.at)
            self.expect_files("g.edits")

    def test_record(self):
        self.record(0)

    def test_record_on(self):
        subprocess.run([RECORD, "g.edits", "2"], cwd=self.dir, check=True, capture_output=True)
        self.record(2)


if __name__ == "__main__":
    unittest.main(argv=[a for a in sys.argv if a != "--all"])
