"""tafoni build: the same bytes again, tiles, predictions, interrupts."""

import json
import os
import signal
import subprocess

from case import TAFONI, Case, run


class Build(Case):
    def test_a_saved_scene_builds_the_same_bytes(self):
        self.hill()
        out = self.dir / "deep" / "er"
        out.mkdir(parents=True)
        self.passes("amplify", "hill.asc", "--voxel", "1.5", "--seed", "4", "-o", "a.ply", "--save-scene", "deep/er/s.toml")
        self.assertIn("../../hill.asc", (out / "s.toml").read_text())
        (self.dir / "again").mkdir()
        self.passes("build", "deep/er/s.toml", "-o", "again/a.ply", "--threads", "1")
        self.assertEqual((self.dir / "a.ply").read_bytes(), (self.dir / "again/a.ply").read_bytes())

    def test_meshes_are_valid_closed_or_open(self):
        self.hill()
        self.passes("build", "hill.asc", "--voxel", "1", "-o", "solid.glb")
        self.passes("validate", "solid.glb", "--closed")
        self.passes("build", "hill.asc", "--voxel", "1", "-o", "open.glb", "--boundary", "open")
        self.passes("validate", "open.glb")
        self.fails(5, "not closed", "validate", "open.glb", "--closed")
        metrics = json.loads(self.passes("metrics", "solid.glb", "--json"))
        self.assertTrue(metrics["closed"])
        self.assertEqual(metrics["genus"], 0)

    def test_tiles_hold_the_same_triangles(self):
        self.hill(n=120)
        whole = json.loads(self.passes("build", "hill.asc", "--voxel", "1", "-o", "w.ply", "--json"))
        self.passes("build", "hill.asc", "--voxel", "1", "-o", "t.ply", "--tiles", "3")
        tiles = sorted(self.dir.glob("t_*.ply"))
        self.assertGreater(len(tiles), 4)
        count = sum(json.loads(self.passes("metrics", t.name, "--json"))["triangles"] for t in tiles)
        self.assertEqual(count, whole["mesh"]["triangles"])
        self.assertEqual([f for f in self.files() if f.startswith(".")], [])

    def test_dry_run_predicts_and_writes_nothing(self):
        self.hill(n=150)
        said = json.loads(self.passes("build", "hill.asc", "--voxel", "0.5", "-o", "a.glb", "--dry-run", "--json"))
        self.assertEqual(self.files(), ["hill.asc"])
        done = json.loads(self.passes("build", "hill.asc", "--voxel", "0.5", "-o", "a.glb", "--json"))
        self.assertLess(abs(said["triangles"] / done["mesh"]["triangles"] - 1), 0.15)
        self.assertLess(abs(said["glb_bytes"] / (self.dir / "a.glb").stat().st_size - 1), 0.2)

    def test_quiet_and_streams(self):
        self.hill()
        done = run("build", "hill.asc", "-o", "a.glb", "--quiet", cwd=self.dir)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        done = run("build", "hill.asc", "-o", "a.glb", "--progress", cwd=self.dir)
        self.assertIn("%", done.stderr)
        self.assertNotIn("\x1b", done.stderr + done.stdout)

    def test_an_interrupted_build_leaves_nothing(self):
        self.hill(n=400)
        before = self.files()
        for tiles in ([], ["--tiles", "4"]):
            work = subprocess.Popen([TAFONI, "build", "hill.asc", "--voxel", "0.2", "-o", "a.ply", "--report", "r.json",
                                     "--progress", *tiles], cwd=self.dir, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            begun = b""
            while b"%" not in begun:  # it says how far it has come: it is at work
                more = os.read(work.stderr.fileno(), 1)
                self.assertTrue(more, begun)
                begun += more
            work.send_signal(signal.SIGINT)
            said = work.communicate(timeout=60)[1].decode()
            self.assertEqual(work.returncode, 130, said)
            self.assertIn("tafoni: interrupted; nothing half-written is left", said)
            self.assertEqual(self.files(), before)

    def test_a_scene_on_another_elevation_model(self):
        self.hill()
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 1\n[terrain]\ngenerator = 'coast'\nwidth = 50\nheight = 50\n"
                                         "influence = 9\n[[layer]]\ntype = 'hoodoos'\n")
        self.passes("build", "s.toml", "--dem", "hill.asc", "-o", "a.glb", "--save-scene", "t.toml")
        saved = (self.dir / "t.toml").read_text()
        self.assertIn("hill.asc", saved)
        self.assertIn("influence = 9", saved)
        self.assertNotIn("coast", saved)
        first = (self.dir / "a.glb").read_bytes()
        self.passes("build", "t.toml", "-o", "a.glb")
        self.assertEqual((self.dir / "a.glb").read_bytes(), first)
        self.fails(3, "missing.tif", "build", "s.toml", "--dem", "missing.tif", "-o", "c.glb")
