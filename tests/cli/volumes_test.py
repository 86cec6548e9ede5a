"""Volumes in and out of tafoni build, info, query and as layers."""

import json
import math
import shutil
import subprocess

from case import Case, run


class Volumes(Case):
    def setUp(self):
        super().setUp()
        self.hill(west=452000, south=5528000)
        (self.dir / "p.csv").write_text("kind,x,y,z,energy,radius\npoint,452040,5528040,42,-12,9\n")
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 1\n[terrain]\nsource = 'hill.asc'\n"
                                         "[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")

    def test_a_scene_becomes_a_volume_and_comes_back(self):
        self.passes("build", "s.toml", "-o", "a.glb", "-o", "a.tvol", "-o", "a.ply")
        direct = json.loads(self.passes("metrics", "a.glb", "--json"))
        self.passes("build", "s.toml", "-o", "h.tvol", "--half", "--band", "2.5")
        for volume in ("a.tvol", "h.tvol"):
            report = json.loads(self.passes("build", volume, "-o", "b.glb", "--json"))
            self.assertEqual(report["voxel_m"], 1)
            self.passes("validate", "b.glb", "--closed")
            again = json.loads(self.passes("metrics", "b.glb", "--json"))
            for key in ("triangles", "genus", "components"):
                self.assertEqual(again[key], direct[key])
            self.assertAlmostEqual(again["volume"] / direct["volume"], 1, delta=1e-5)
            for corner in ("low", "high"):
                for a, b in zip(again[corner], direct[corner]):
                    self.assertAlmostEqual(a, b, delta=0.01)

    def test_dry_run_predicts_what_is_asked_for(self):
        said = self.passes("build", "s.toml", "--dry-run", "-o", "a.tvol")
        self.assertNotIn("GLB", said)
        predicted = json.loads(self.passes("build", "s.toml", "--dry-run", "-o", "a.tvol", "--json"))
        self.passes("build", "s.toml", "-o", "a.tvol")
        info = json.loads(self.passes("info", "a.tvol", "--json"))
        self.assertEqual(predicted["samples"], info["samples"])
        self.assertLess(abs(math.log(predicted["volume_bytes"] / (self.dir / "a.tvol").stat().st_size)), math.log(4))
        self.assertIn("GLB", self.passes("build", "s.toml", "--dry-run"))

    def test_the_seven_measures_of_a_volume(self):
        self.passes("build", "s.toml", "-o", "a.glb", "-o", "a.tvol")
        mesh, volume = (json.loads(self.passes("metrics", "--sgm", name, "--cube", "2", "--json"))
                        for name in ("a.glb", "a.tvol"))
        self.assertEqual(mesh["triangles"], volume["triangles"])
        self.assertAlmostEqual(mesh["surface_area"] / volume["surface_area"], 1, delta=1e-4)
        self.fails(2, "only --sgm measures a scene", "metrics", "s.toml")

    def test_open_vdb_where_the_build_has_it(self):
        done = run("build", "s.toml", "-o", "a.vdb", "-o", "a.glb", cwd=self.dir)
        if done.returncode != 0:
            self.assertEqual(done.returncode, 4)
            self.assertIn("no OpenVDB", done.stderr)
            self.skipTest("built without OpenVDB")
        # Distances, as other programs expect; the scene's own values where asked for.
        self.passes("build", "a.vdb", "-o", "b.glb")
        self.passes("build", "s.toml", "-o", "f.vdb", "--values", "field")
        self.passes("build", "f.vdb", "-o", "f.glb")
        a, b, f = (json.loads(self.passes("metrics", name, "--json")) for name in ("a.glb", "b.glb", "f.glb"))
        self.assertEqual(a["triangles"], b["triangles"])
        self.assertEqual(a["triangles"], f["triangles"])
        self.assertAlmostEqual(a["volume"] / b["volume"], 1, delta=2e-3)
        self.assertAlmostEqual(a["volume"] / f["volume"], 1, delta=1e-5)
        for corner in ("low", "high"):
            for u, v in zip(a[corner], b[corner]):
                self.assertAlmostEqual(u, v, delta=0.1)
        # The same bytes again, and a band that cannot be measured is refused before anything is written.
        (self.dir / "sub").mkdir()
        self.passes("build", "s.toml", "-o", "sub/a.vdb")
        self.assertEqual(*((self.dir / name).read_bytes() for name in ("a.vdb", "sub/a.vdb")))
        self.fails(2, "at most 14 cells", "build", "s.toml", "-o", "c.vdb", "--band", "20")
        self.fails(2, "at most 14 cells", "build", "s.toml", "-o", "c.vdb", "--band", "0")
        self.passes("build", "s.toml", "-o", "c.vdb", "--band", "20", "--values", "field")
        if shutil.which("vdb_print"):
            said = subprocess.run(["vdb_print", "-m", self.dir / "a.vdb"], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0)
            self.assertIn("level set", said.stdout)
            self.assertIn("world_origin", said.stdout)

    def test_info_query_and_layers(self):
        self.passes("build", "s.toml", "-o", "a.tvol")
        info = json.loads(self.passes("info", "a.tvol", "--json"))
        self.assertEqual(info["spacing_m"], 1)
        self.assertEqual(info["greatest_m"], 4)
        self.assertLess(info["low"][0], 452000)
        self.assertIn("positive in rock", self.passes("info", "a.tvol"))
        self.assertTrue(json.loads(self.passes("metrics", "a.tvol", "--json"))["closed"])
        points = "x,y,z\n452040,5528040,42\n452011,5528013,40\n452011,5528013,70\n"
        rows = self.passes("query", "a.tvol", "--points", "-", stdin=points).splitlines()[1:]
        self.assertEqual([float(row.split(",")[3]) > 0 for row in rows], [False, True, False])
        (self.dir / "t.toml").write_text("[scene]\nvoxel = 1\n[terrain]\ngenerator = 'plane'\nelevation = 40\n"
                                         "[[layer]]\ntype = 'volume'\nfile = 'a.tvol'\nmode = 'union'\n"
                                         "at = [0, 0, 60]\n")
        self.passes("build", "t.toml", "-o", "t.glb")
        self.passes("validate", "t.glb", "--closed")

    def test_wrong_inputs_are_one_sentence(self):
        self.passes("build", "s.toml", "-o", "a.tvol")
        data = (self.dir / "a.tvol").read_bytes()
        (self.dir / "cut.tvol").write_bytes(data[:len(data) // 2])
        (self.dir / "bad.tvol").write_bytes(data[:60] + bytes([data[60] ^ 4]) + data[61:])
        (self.dir / "text.tvol").write_text("solid\n")
        self.fails(3, "cut.tvol: the file is damaged", "build", "cut.tvol", "-o", "b.glb")
        self.fails(3, "checksum", "info", "bad.tvol")
        self.fails(3, "another format", "render", "text.tvol", "-o", "b.png")
        self.fails(3, "none.tvol: does not exist", "build", "none.tvol", "-o", "b.glb")
        self.fails(2, "known extensions", "build", "s.toml", "-o", "a.vox")
        self.fails(2, "leave out --tiles", "build", "s.toml", "-o", "b.tvol", "--tiles", "2")
        self.fails(2, "are for volumes", "build", "s.toml", "-o", "b.glb", "--half")
        self.fails(2, "is an input", "build", "a.tvol", "-o", "a.tvol")
        self.fails(2, "asked for twice", "build", "s.toml", "-o", "b.tvol", "-o", "b.tvol")
        self.assertNotIn("b.glb", self.files())
