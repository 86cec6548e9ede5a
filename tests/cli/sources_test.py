"""Elevation models with odd names and of odd kinds, through scene files and back."""

import json
import math
import os
import struct
import subprocess
import zipfile

from case import TAFONI, Case


class Sources(Case):
    def folders(self, *names):
        for name in names:
            (self.dir / name).mkdir()

    def same(self, a, b):
        self.assertTrue((self.dir / a).read_bytes() == (self.dir / b).read_bytes(), f"{a} and {b} differ")

    def test_a_name_that_is_not_utf8(self):
        self.hill()
        name = b"d\xe9nivel\xe9.asc"  # Latin-1, as older archives hold
        os.rename(self.dir / "hill.asc", os.path.join(os.fsencode(self.dir), name))
        self.folders("one", "two")
        for args in (["build", name, "-o", "one/a.glb", "--save-scene", "s.toml"],
                     ["build", "s.toml", "-o", "two/a.glb"],
                     ["build", "s.toml", "--seed", "2", "--save-scene", "t.toml"]):
            done = subprocess.run([TAFONI, *args], cwd=self.dir, capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.same("one/a.glb", "two/a.glb")
        self.assertIn("d\\\\xE9nivel\\\\xE9.asc", (self.dir / "t.toml").read_text("utf-8"))
        (self.dir / "latin.toml").write_bytes(b"[terrain]\nsource = 'd\xe9nivel\xe9.asc'\n")
        self.fails(3, "latin.toml:2: is not UTF-8", "build", "latin.toml", "-o", "c.glb")

    def test_a_model_in_an_archive_beside_the_scene(self):
        self.hill()
        self.folders("sub", "one", "two", "three")
        with zipfile.ZipFile(self.dir / "sub" / "tile.zip", "w") as archive:
            archive.write(self.dir / "hill.asc", "data/dtm.asc")
        (self.dir / "sub" / "s.toml").write_text("[terrain]\nsource = '/vsizip/tile.zip/data/dtm.asc'\n")
        self.passes("build", "sub/s.toml", "-o", "one/a.glb", "--save-scene", "t.toml")
        self.passes("build", "t.toml", "-o", "two/a.glb")
        self.passes("build", "hill.asc", "-o", "three/a.glb")
        self.same("one/a.glb", "two/a.glb")
        self.same("one/a.glb", "three/a.glb")
        self.fails(2, "is an input of this command", "build", "sub/s.toml", "-o", "a.glb", "--report", "sub/tile.zip")

    def test_raw_heights_and_depths(self):
        n = 65
        heights = [[32768 + int(20000 * math.sin(i / 9) * math.cos(j / 7)) for i in range(n)] for j in range(n)]
        (self.dir / "h.raw").write_bytes(b"".join(struct.pack(f">{n}H", *row) for row in heights))
        info = json.loads(self.passes("info", "h.raw", "--json"))
        self.assertAlmostEqual(info["highest_m"], max(map(max, heights)) / 128)
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'h.raw'\nheight_scale = -0.001\nheight_offset = 5\n")
        info = json.loads(self.passes("info", "s.toml", "--json"))["source"]
        self.assertAlmostEqual(info["lowest_m"], 5 - max(map(max, heights)) / 1000)
        self.fails(2, "raw_size", "build", "h.raw", "--set", "terrain.raw_size=65", "-o", "a.glb")
        self.fails(3, "not 64 x 65 heights", "build", "h.raw", "--set", "terrain.raw_size=64,65", "-o", "a.glb")
