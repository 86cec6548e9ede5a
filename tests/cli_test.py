"""Drives the command line end to end: exit codes, messages, files left behind, and the field against a
brute-force evaluation of DESIGN section 6 in double precision."""

import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

TAFONI = os.environ["TAFONI_CLI"]


def run(*args, cwd=None, stdin=None, env=None):
    return subprocess.run([TAFONI, *map(str, args)], cwd=cwd, input=stdin, capture_output=True, text=True,
                          env={**os.environ, **(env or {})}, timeout=300)


def write_asc(path, heights, pixel, west, south):
    """An ESRI grid; heights[0] is the north row."""
    lines = [f"ncols {len(heights[0])}", f"nrows {len(heights)}", f"xllcorner {west}", f"yllcorner {south}",
             f"cellsize {pixel}"]
    lines += [" ".join(repr(h) for h in row) for row in heights]
    Path(path).write_text("\n".join(lines) + "\n")


def float32(v):
    import struct
    return struct.unpack("f", struct.pack("f", v))[0]


class Brute:
    """f = min(f_T + sum of energy g, f_P), bilinear heights, vertical distance."""

    def __init__(self, heights, pixel, west, south, base, influence, amplitude, primitives):
        self.h, self.pixel, self.west, self.south, self.base = heights, pixel, west, south, base
        self.R, self.T, self.primitives = influence, amplitude, primitives
        self.rows, self.cols = len(heights), len(heights[0])
        self.north = south + pixel * self.rows
        self.east = west + pixel * self.cols

    def sigma(self, x):
        a = abs(x)
        R, T = self.R, self.T
        s = T if a >= R else a + (3 * T - 2 * R) / R**2 * a * a + (R - 2 * T) / R**3 * a**3
        return math.copysign(s, x)

    def height(self, x, y):
        u = min(max((x - self.west) / self.pixel - 0.5, 0), self.cols - 1)
        v = min(max((self.north - y) / self.pixel - 0.5, 0), self.rows - 1)
        i, j = min(int(u), self.cols - 2), min(int(v), self.rows - 2)
        a, b = u - i, v - j
        top = self.h[j][i] * (1 - a) + self.h[j][i + 1] * a
        bottom = self.h[j + 1][i] * (1 - a) + self.h[j + 1][i + 1] * a
        return top * (1 - b) + bottom * b

    def border(self, x, y, z):
        """Signed distance to the border of the prism, positive inside."""
        d = [min(x - self.west, self.east - x), min(y - self.south, self.north - y), z - self.base]
        return min(d) if min(d) >= 0 else -math.hypot(*(min(v, 0) for v in d))

    def g(self, u):
        return (1 - u * u) ** 3 if u < 1 else 0.0

    def value(self, x, y, z):
        f = self.sigma(self.height(x, y) - z)
        for kind, px, py, pz, radius, energy in self.primitives:
            d = math.dist((x, y, z), (px, py, pz))
            f += energy * (self.g(d / radius) if kind == "point" else self.g(max(d - radius, 0) / self.R))
        return min(f, self.sigma(self.border(x, y, z)))


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.dir = Path(folder.name)

    def files(self):
        return sorted(p.name for p in self.dir.rglob("*"))

    def fails(self, code, says, *args, **kwargs):
        done = run(*args, cwd=self.dir, **kwargs)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(says, done.stderr)
        lines = [line for line in done.stderr.splitlines() if "warning:" not in line]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("tafoni: "), done.stderr)

    def passes(self, *args, **kwargs):
        done = run(*args, cwd=self.dir, **kwargs)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def hill(self, name="hill.asc", n=40, pixel=2.0, west=0, south=0, seed=1):
        rng = random.Random(seed)
        waves = [(rng.uniform(0.05, 0.4), rng.uniform(0.05, 0.4), rng.uniform(0, 6), rng.uniform(1, 4)) for _ in range(4)]
        heights = [[float32(50 + sum(a * math.sin(p * i + q * j + r) for p, q, r, a in waves)) for i in range(n)]
                   for j in range(n)]
        write_asc(self.dir / name, heights, pixel, west, south)
        return heights


class Query(Case):
    def check(self, west, south):
        pixel, n, R, T, voxel = 2.0, 40, 12.0, 6.0, 1.0
        heights = self.hill(n=n, pixel=pixel, west=west, south=south)
        rng = random.Random(5)
        size = pixel * n

        def near_surface():
            x, y = rng.uniform(0, size), rng.uniform(0, size)
            return west + x, south + y, 50 + rng.uniform(-15, 15)

        primitives = [(rng.choice(["point", "sphere"]), *near_surface(), rng.uniform(1, 8), rng.uniform(-8, 4))
                      for _ in range(40)]
        (self.dir / "p.csv").write_text("# made by the test\nkind,x,y,z,radius,energy\n" +
                                        "".join(",".join(map(str, p)) + "\n" for p in primitives))
        (self.dir / "s.toml").write_text(
            f"[scene]\nvoxel = {voxel}\n[terrain]\nsource = 'hill.asc'\ninfluence = {R}\namplitude = {T}\n"
            "interpolation = 'bilinear'\ndistance = 'vertical'\n[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")
        report = json.loads(self.passes("build", "s.toml", "--report", "r.json", "--json"))
        base = report["terrain"]["domain"]["low"][2]
        self.assertLessEqual(base, min(map(min, heights)) - R)
        brute = Brute(heights, pixel, west, south, base, R, T, primitives)

        points = [near_surface() for _ in range(1500)]
        points += [(west + rng.uniform(-20, size + 20), south + rng.uniform(-20, size + 20), base + rng.uniform(-20, 60))
                   for _ in range(1500)]
        points += [p[1:4] for p in primitives]
        (self.dir / "q.csv").write_text("x,y,z\n" + "".join(f"{x!r},{y!r},{z!r}\n" for x, y, z in points))
        rows = self.passes("query", "s.toml", "--points", "q.csv").splitlines()
        self.assertEqual(rows[0], "x,y,z,f,gx,gy,gz")
        self.assertEqual(len(rows), len(points) + 1)
        worst = 0
        smooth = 0
        for point, row in zip(points, rows[1:]):
            x, y, z, f, gx, gy, gz = map(float, row.split(","))
            self.assertEqual((x, y, z), tuple(map(float, point)))
            worst = max(worst, abs(f - brute.value(x, y, z)))
            step = 1e-3
            numeric = [(brute.value(*[v + (k == axis) * step for k, v in enumerate(point)]) -
                        brute.value(*[v - (k == axis) * step for k, v in enumerate(point)])) / (2 * step)
                       for axis in range(3)]
            smooth += max(abs(a - b) for a, b in zip((gx, gy, gz), numeric)) < 2e-2
        self.assertLess(worst, 1e-4 * T)
        # Differences straddle a crease of min() or of the bilinear patches at a few points.
        self.assertGreater(smooth, 0.98 * len(points))

    def test_equals_brute_force(self):
        self.check(0, 0)

    def test_equals_brute_force_far_from_the_origin(self):
        self.check(1000000, 5500000)

    def test_reads_standard_input_and_writes_files(self):
        self.hill()
        rows = self.passes("query", "hill.asc", "--points", "-", stdin="10,10,1000\n11,11,30\n").splitlines()
        self.assertEqual(rows[1].split(",")[3], "-7.5")
        self.passes("query", "hill.asc", "--points", "-", "-o", "out.csv", stdin="10,10,1000\n")
        self.assertEqual((self.dir / "out.csv").read_text().splitlines()[1], rows[1])
        values = json.loads(self.passes("query", "hill.asc", "--points", "-", "--json", stdin="10,10,1000\n"))
        self.assertEqual(values[0]["f"], -7.5)


class Collisions(Case):
    """Queries of the surface, on ground that is level at 30 m."""

    def level(self):
        (self.dir / "level.asc").write_text("ncols 40\nnrows 40\nxllcorner 1000\nyllcorner 2000\ncellsize 1\n" +
                                            "\n".join(" ".join(["30"] * 40) for _ in range(40)) + "\n")

    def rows(self, *args, stdin):
        head, *lines = self.passes(*args, stdin=stdin).splitlines()
        return [dict(zip(head.split(","), line.split(","))) for line in lines]

    def test_the_surface_is_met_where_it_is(self):
        self.level()
        query = lambda flag, text, *more: self.rows("query", "level.asc", flag, "-", "--voxel", "0.5", *more, stdin=text)
        ray, up = query("--rays", "1020,2020,50,0,0,-2,100\n1020,2020,50,0,0,1,100\n")
        self.assertAlmostEqual(float(ray["hit"]), 20, delta=0.01)
        self.assertAlmostEqual(float(ray["pz"]), 30, delta=0.01)
        self.assertAlmostEqual(float(ray["px"]), 1020, delta=1e-6)
        self.assertAlmostEqual(float(ray["nz"]), 1, delta=0.01)
        self.assertEqual((up["hit"], up["from_rock"]), ("", ""))
        near, = query("--closest", "1020,2020,28,10\n")
        self.assertAlmostEqual(float(near["signed_distance"]), -2, delta=0.01)
        sphere, free = query("--spheres", "x,y,z,radius\n1020,2020,30.5,1\n1020,2020,40,1\n")
        self.assertAlmostEqual(float(sphere["depth"]), 0.5, delta=0.01)
        self.assertEqual(float(free["depth"]), 0)
        sweep, = query("--sweeps", "1020,2020,40,0.4,1.8,0,0,-1000\n")
        self.assertAlmostEqual(float(sweep["time"]), 0.01, delta=1e-4)
        self.assertEqual(float(sweep["depth"]), 0)

    def test_a_mesh_gives_what_its_scene_gives(self):
        self.level()
        self.passes("build", "level.asc", "--voxel", "0.5", "-o", "level.glb")
        text = "".join(f"{1004 + i},{2005 + 0.7 * i},33,0.3,-0.1,-1,50\n" for i in range(20))
        scene = self.rows("query", "level.asc", "--rays", "-", "--voxel", "0.5", stdin=text)
        mesh = self.rows("query", "level.glb", "--rays", "-", stdin=text)
        for a, b in zip(scene, mesh):
            self.assertAlmostEqual(float(a["hit"]), float(b["hit"]), delta=1e-3)
        values = json.loads(self.passes("query", "level.glb", "--rays", "-", "--json", stdin=text))
        self.assertEqual(len(values), 20)

    def test_walks(self):
        self.level()
        told = json.loads(self.passes("query", "level.asc", "--voxel", "1", "--walk", "20", "--anywhere", "--json"))
        self.assertEqual((told["routes"], told["arrived"], told["overlap"]), (20, 20, 0))
        self.fails(3, "no place under rock", "query", "level.asc", "--voxel", "1", "--walk", "5")

    def test_wrong_questions(self):
        self.level()
        self.fails(2, "no more than one", "query", "level.asc", "--walk", "5", "--points", "p.csv")
        self.fails(3, "expected the columns x,y,z,radius", "query", "level.asc", "--spheres", "-", stdin="")
        self.fails(3, "expected x,y,z,radius", "query", "level.asc", "--spheres", "-", stdin="1,2\n")
        self.fails(3, "standard input:2: a radius of -1 m cannot collide", "query", "level.asc", "--spheres", "-",
                   stdin="x,y,z,radius\n1,2,3,-1\n")
        self.fails(3, "less than two radii", "query", "level.asc", "--sweeps", "-", stdin="1,2,3,1,1,0,0,1\n")
        self.fails(3, "standard input:1: the ray has no direction", "query", "level.asc", "--rays", "-",
                   stdin="1,2,3,0,0,0,1\n")
        self.fails(2, "go with --walk", "query", "level.asc", "--anywhere", "--rays", "-", stdin="1,2,3,0,0,1,1\n")
        self.fails(2, "a walker of radius -0.3 m", "query", "level.asc", "--walk", "5", "--walker=-0.3,1.8,0.4,40")
        self.passes("build", "level.asc", "--voxel", "2", "-o", "level.glb")
        self.fails(2, "a mesh has no field", "query", "level.glb", "--points", "-", stdin="1,2,3\n")


class Errors(Case):
    def test_wrong_arguments(self):
        self.hill()
        self.fails(2, 'unknown command "amplfy"; did you mean amplify?', "amplfy")
        self.fails(2, "unknown option --voxl; did you mean --voxel?", "build", "hill.asc", "--voxl", "1")
        self.fails(2, "SCENE is required", "build")
        self.fails(2, "--voxel must be a number, 0 to 100000 m", "build", "hill.asc", "--voxel", "x", "-o", "a.glb")
        self.fails(2, "--voxel = -3 is outside 0 to 100000 m", "build", "hill.asc", "--voxel", "-3", "-o", "a.glb")
        self.fails(2, "--boundary", "build", "hill.asc", "--boundary", "opn", "-o", "a.glb")
        self.fails(2, 'did you mean "karst"?', "amplify", "hill.asc", "-l", "karts", "-o", "a.glb")
        self.fails(2, "did you mean", "amplify", "hill.asc", "--geology", "stata", "-o", "a.glb")
        self.fails(2, 'has no layer or geology "karst"', "amplify", "hill.asc", "--set", "karst.x=1", "-o", "a.glb")
        self.fails(2, "nothing to write", "amplify", "hill.asc")
        self.fails(2, "query needs one of --points", "query", "hill.asc")
        self.fails(2, "did you mean", "list", "landform")
        self.fails(2, "did you mean", "list", "landforms", "karsts")
        self.fails(2, "did you mean", "generate", "cost", "-o", "a.tif")
        self.fails(2, "unknown parameter", "generate", "coast", "-o", "a.tif", "--set", "widht=3")
        self.fails(2, "must have 6", "render", "hill.asc", "--camera", "-1,2,3", "-o", "a.png")
        self.assertEqual(self.files(), ["hill.asc"])

    def test_unusable_inputs(self):
        self.fails(3, "missing.tif", "amplify", "missing.tif", "-o", "a.glb")
        self.fails(3, "missing.toml: does not exist", "build", "missing.toml", "-o", "a.glb")
        self.fails(3, "missing.glb", "validate", "missing.glb")
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'hill.asc'\ninfluence = 99\n")
        self.fails(3, "s.toml: influence = 99 m is more than three times", "build", "s.toml", "-o", "a.glb")
        self.hill()
        self.fails(3, "missing.csv: does not exist", "query", "hill.asc", "--points", "missing.csv")
        self.fails(3, "x is \"a\", which is not a number", "query", "hill.asc", "--points", "-", stdin="x,y,z\na,1,2\n")
        (self.dir / "p.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\npoint,1,2,3,4,5\ncube,1,2,3,4,5\n")
        self.fails(3, "p.csv:3: kind is \"cube\"; known are", "build", "p.toml", "-o", "a.glb")
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\npoint,1e8,2,3,4,5\n")
        self.fails(3, "p.csv:2: ", "build", "p.toml", "-o", "a.glb")
        self.assertNotIn("a.glb", self.files())

    def test_outputs_are_checked_before_the_work(self):
        self.hill()
        self.fails(4, "no/such/folder", "build", "hill.asc", "-o", "no/such/folder/a.glb")
        self.fails(2, "a.xyz", "build", "hill.asc", "-o", "a.xyz")
        self.fails(2, "is an input of this command and would be overwritten", "amplify", "hill.asc", "--report", "hill.asc")
        self.fails(2, "asked for twice", "build", "hill.asc", "-o", "a.glb", "--report", "a.glb")
        self.fails(2, "must end in .toml", "build", "hill.asc", "--save-scene", "a.txt")
        if os.geteuid() != 0:
            locked = self.dir / "locked"
            locked.mkdir(mode=0o500)
            self.fails(4, "locked", "build", "hill.asc", "-o", "locked/a.glb")

    def test_a_full_disk_is_one_sentence(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("this machine has no /dev/full")
        with open("/dev/full", "w") as full:
            done = subprocess.run([TAFONI, "list"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 4)
        self.assertEqual(done.stderr, "tafoni: standard output could not be written; is the disk full?\n")


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
            work = subprocess.Popen([TAFONI, "build", "hill.asc", "--voxel", "0.2", "-o", "a.ply", "--report", "r.json", *tiles],
                                    cwd=self.dir, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(1.0)
            work.send_signal(signal.SIGINT)
            _, said = work.communicate(timeout=60)
            self.assertEqual(work.returncode, 130, said)
            self.assertIn("tafoni: interrupted; nothing half-written is left", said)
            self.assertEqual(self.files(), before)


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
            time.sleep(0.004 * i)
            child.kill()
            child.wait()
            found = [float(s["stroke"].split("at=")[1].split(",")[0]) for s in self.strokes()]
            self.assertEqual(found[0], 0)
            self.assertEqual(found, sorted(found))
            self.assertLessEqual(len(found), i + 1)


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

    def test_open_vdb_where_the_build_has_it(self):
        done = run("build", "s.toml", "-o", "a.vdb", "-o", "a.glb", cwd=self.dir)
        if done.returncode != 0:
            self.assertEqual(done.returncode, 4)
            self.assertIn("no OpenVDB", done.stderr)
            self.skipTest("built without OpenVDB")
        self.passes("build", "a.vdb", "-o", "b.glb")
        a, b = (json.loads(self.passes("metrics", name, "--json")) for name in ("a.glb", "b.glb"))
        self.assertEqual(a["triangles"], b["triangles"])
        self.assertAlmostEqual(a["volume"] / b["volume"], 1, delta=1e-5)
        if shutil.which("vdb_print"):
            said = subprocess.run(["vdb_print", "-l", self.dir / "a.vdb"], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0)
            self.assertIn("level set", said.stdout)

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
        self.fails(3, "none.tvol: cannot be opened", "build", "none.tvol", "-o", "b.glb")
        self.fails(2, "known extensions", "build", "s.toml", "-o", "a.vox")
        self.fails(2, "leave out --tiles", "build", "s.toml", "-o", "b.tvol", "--tiles", "2")
        self.fails(2, "are for volumes", "build", "s.toml", "-o", "b.glb", "--half")
        self.fails(2, "is an input", "build", "a.tvol", "-o", "a.tvol")
        self.fails(2, "asked for twice", "build", "s.toml", "-o", "b.tvol", "-o", "b.tvol")
        self.assertNotIn("b.glb", self.files())


class Reference(Case):
    def test_help_and_list_cover_everything(self):
        help_text = self.passes("--help")
        listed = json.loads(self.passes("list", "--json"))
        page = self.passes("list", "--markdown")
        for command in listed["commands"]:
            self.assertIn(command["name"], help_text)
            self.assertIn(command["doc"][:40], self.passes(command["name"], "--help"))
        for topic, entries in listed.items():
            for entry in entries:
                self.assertIn(f"### {entry['name']}\n", page)
                self.assertTrue(entry["doc"], f"{topic} {entry['name']}")
                for param in entry.get("params", []):
                    self.assertTrue(param["doc"], f"{entry['name']}.{param['name']}")
                    self.assertIn(f"`{param['name']}`", page)

    def test_info_reads_terrain_and_scene(self):
        self.hill()
        self.assertEqual(json.loads(self.passes("info", "hill.asc", "--json"))["width"], 40)
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'karst'\nenabled = false\n")
        self.assertIn("karst (off)", self.passes("info", "s.toml"))
        self.assertEqual(json.loads(self.passes("info", "s.toml", "--json"))["source"]["width"], 40)

    def test_every_example_scene_builds(self):
        for example in sorted((Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml")):
            own = float(re.search(r"^voxel = ([0-9.]+)", example.read_text(), re.M).group(1))
            self.passes("build", example, "--voxel", max(4, 4 * own), "--boundary", "solid", "-o", "a.glb")
            self.passes("validate", "a.glb", "--closed")

    def test_every_example_says_how_its_picture_is_made(self):
        for example in (Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml"):
            heading = re.match(r"(#.*\n)+", example.read_text()).group(0)
            self.assertRegex(heading, rf"#   tafoni render examples/{example.name} .*-o docs/images/\w[\w-]*\.jpg\n")

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

    def test_render_cuts_the_rock_open(self):
        self.hill()
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 4\n[terrain]\nsource = 'hill.asc'\n[[geology]]\n"
                                         "type = 'fold'\n[[geology.of]]\ntype = 'strata'\n")
        small = ("--size", "64,48", "--samples", "1")
        self.passes("render", "s.toml", "--geology", "-o", "a.png", *small)
        self.passes("render", "s.toml", "--geology", "--set", "strata.dip=30", "-o", "b.png", *small)
        self.assertNotEqual((self.dir / "a.png").read_bytes(), (self.dir / "b.png").read_bytes())
        self.fails(2, "needs --geology", "render", "s.toml", "--cut", "0,0,1,1", "-o", "c.png")
        self.fails(2, "Nothing of the terrain", "render", "s.toml", "--geology", "--cut", "0,1e6,1,1e6", "-o", "c.png")
        self.fails(2, "exclude", "render", "s.toml", "--geology", "--inside", "-o", "c.png")
        (self.dir / "t.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[geology]]\ntype = 'fold'\n")
        self.fails(3, "t.toml:4: fold: takes 1 child, but has none", "build", "t.toml", "-o", "c.glb")

    def test_generate_is_reproducible(self):
        for name in ("a.tif", "b.tif"):
            self.passes("generate", "coast", "-o", name, "--seed", "3", "--set", "width=64", "--set", "coast.height=48")
        self.assertEqual((self.dir / "a.tif").read_bytes(), (self.dir / "b.tif").read_bytes())


if __name__ == "__main__":
    sys.exit(unittest.main())
