"""What reaches the terminal: nothing that drives it, nothing without end, and JSON where that is asked for."""

import json
import resource
import subprocess

from case import TAFONI, Case, run


def controls(text):
    """Characters that a terminal would obey."""
    return [c for c in text if (ord(c) < 32 and c not in "\n\t") or 127 <= ord(c) < 160 or 0x202a <= ord(c) <= 0x202e
            or 0x2066 <= ord(c) <= 0x2069]


class Terminal(Case):
    evil = "\x1b]0;owned\x07\x1b[2Ja\x9bb\u202ec\x7f"

    def test_no_control_reaches_it(self):
        self.hill()
        (self.dir / f"{self.evil}.obj").write_text("v 0 0 0\n")
        (self.dir / "s.toml").write_text(f"[terrain]\nsource = 'hill.asc'\n[[layer]]\nname = '''x\\u001b'''\ntype = 'sculpt'\n", encoding="utf-8")
        (self.dir / "k.toml").write_bytes(b"[terrain]\n\"so\\u001b[31m\" = 1\n")
        (self.dir / "b.csv").write_bytes(b"x,y,z\n1,2,\x1b[2J\xff\x9b\n")
        (self.dir / "evil.strokes").write_bytes(b"sph\x1b[31mere at=1,2,3\n")
        for args in (["info", f"{self.evil}.obj"], ["validate", f"{self.evil}.obj"], ["build", self.evil],
                     ["build", f"{self.evil}.toml"], [self.evil], ["list", self.evil], ["generate", self.evil, "-o", "a.tif"],
                     ["build", "hill.asc", "--" + self.evil], ["build", "hill.asc", "-o", self.evil],
                     ["build", "hill.asc", "--set", self.evil], ["build", "k.toml", "--dry-run"],
                     ["query", "hill.asc", "--points", "b.csv"], ["sculpt", "s.toml", "--stroke", self.evil],
                     ["sculpt", "s.toml", "--strokes", "evil.strokes"], ["amplify", "hill.asc", "-l", self.evil]):
            for more in ([], ["--json"]):
                done = subprocess.run([TAFONI, *args, *more], cwd=self.dir, capture_output=True, timeout=60)
                self.assertNotIn(done.returncode, (0, 1), args)
                said = done.stderr.decode("utf-8")  # throws for what is no UTF-8
                self.assertEqual(controls(said), [], (args, said))
                self.assertNotIn("internal error", said)
                if more:
                    self.assertIn("error", json.loads(said.splitlines()[-1]))

    def test_results_are_safe_too(self):
        self.hill(name=f"{self.evil}.asc")
        done = run("build", f"{self.evil}.asc", "-o", f"{self.evil}.glb", cwd=self.dir)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(controls(done.stdout + done.stderr), [])
        told = json.loads(self.passes("info", f"{self.evil}.asc", "--json"))
        self.assertEqual(told["file"], f"{self.evil}.asc")  # JSON still says what the name is

    def test_messages_have_an_end(self):
        self.hill()
        for args in (["list", "x" * 5000], ["build", "hill.asc", "--set", "scene.voxel=" + "9" * 5000],
                     ["build", "hill.asc", "--" + "v" * 5000], ["build", "y" * 200 + "/" + "z" * 5000],
                     ["sculpt", "s.toml", "--stroke", "sphere " + "ä" * 5000]):
            done = run(*args, cwd=self.dir)
            self.assertNotIn(done.returncode, (0, 1))
            self.assertLess(len(done.stderr), 700, args[0])

    def test_closed_outputs_do_not_abort(self):
        self.hill()
        for closed in (">&- 2>&-", "2>&-", ">&-", "<&- >&- 2>&-", "2>/dev/full", ">/dev/full 2>/dev/full"):
            for args in ("build hill.asc -o a.glb", "build hill.asc -o a.glb --progress", "list", "build nothing.tif -o a.glb",
                         "info hill.asc --json", "--help"):
                (self.dir / "a.glb").unlink(missing_ok=True)
                code = subprocess.run(f"exec '{TAFONI}' {args} {closed}", shell=True, cwd=self.dir, timeout=60).returncode
                self.assertIn(code, (0, 3, 4), (args, closed))
                if "hill.asc -o" in args:
                    # Nothing that was meant for the terminal is in it.
                    self.assertEqual(run("validate", "a.glb", cwd=self.dir).returncode, 0, (args, closed))


class Json(Case):
    def test_errors_and_warnings(self):
        self.hill()
        done = run("build", "missing.tif", "-o", "a.glb", "--json", cwd=self.dir)
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        said = json.loads(done.stderr)
        self.assertEqual((said["kind"], said["code"]), ("input", 3))
        self.assertIn("missing.tif", said["error"])
        for args, code in ((["build", "--json"], 2), (["bild", "--json"], 2), (["build", "hill.asc", "--json", "--voxl"], 2),
                           (["build", "hill.asc", "-o", "no/a.glb", "--json"], 4)):
            done = run(*args, cwd=self.dir)
            self.assertEqual(done.returncode, code)
            self.assertEqual(json.loads(done.stderr)["code"], code)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 4\n[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'sculpt'\nstrokes = 'a.strokes'\n")
        (self.dir / "a.strokes").write_text("sphere at=9e6,0,0\n")
        done = run("build", "s.toml", "-o", "a.glb", "--json", cwd=self.dir)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(any("lie outside" in json.loads(line)["warning"] for line in done.stderr.splitlines()))
        self.assertTrue(any("lie outside" in w for w in json.loads(done.stdout)["warnings"]))

    def test_generate_render_and_sculpt(self):
        made = json.loads(self.passes("generate", "coast", "-o", "c.tif", "--set", "width=40", "--set", "height=30", "--json"))
        self.assertEqual((made["file"], made["width"], made["height"]), ("c.tif", 40, 30))
        shown = json.loads(self.passes("render", "c.tif", "-o", "c.png", "--size", "64,48", "--samples", "1", "--json"))
        self.assertEqual((shown["file"], shown["width"], shown["height"]), ("c.png", 64, 48))
        again = json.loads(self.passes("render", "c.tif", "-o", "d.png", "--size", "64,48", "--samples", "1", "--json", "--camera",
                                       ",".join(str(v) for v in shown["camera"]["eye"] + shown["camera"]["target"])))
        self.assertEqual(again["camera"], shown["camera"])
        self.assertGreaterEqual(shown["seconds"]["picture"], 0)
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'c.tif'\n")
        self.assertEqual(json.loads(self.passes("sculpt", "s.toml", "--stroke", "sphere at=20,20,0 radius=5", "--json")), {"stored": 1})
        self.assertEqual(json.loads(self.passes("build", "s.toml", "--save-scene", "t.toml", "--json")), {"files": ["t.toml"]})

    def test_the_report_tells_of_all_stages_and_explains_itself(self):
        self.hill()
        told = json.loads(self.passes("amplify", "hill.asc", "-l", "karst", "--voxel", "4", "-o", "a.glb", "-o", "a.tvol", "--preview", "a.png", "--json"))
        for stage in ("read terrain", "polygonize", "colour", "picture", "write", "sample volume", "write volume"):
            self.assertGreaterEqual(told["seconds"][stage], 0, stage)
        layer = told["layers"][0]
        for name in ("entrances", "networks", "connected_networks", "greatest_depth_m"):
            self.assertIn(name, layer)
            self.assertTrue(layer["explained"][name])
        self.assertIn("mesh.components", told["explained"])


class Names(Case):
    def test_help_and_names_alone(self):
        self.assertEqual(self.passes("help"), self.passes("--help"))
        self.assertEqual(self.passes("help", "build"), self.passes("build", "--help"))
        self.fails(2, "did you mean build?", "help", "biuld")
        self.assertIn("passage", self.passes("list", "karst"))
        self.assertEqual(json.loads(self.passes("list", "karst", "--json"))["topic"], "landforms")
        self.assertIn("strokes", self.passes("list", "sculpt"))
        kinds = {e["topic"] for e in json.loads(self.passes("list", "sphere", "--json"))}
        self.assertTrue({"brushes", "primitives"} <= kinds)
        self.fails(2, 'did you mean "karst"?', "list", "karts")

    def test_a_layer_that_is_not_there(self):
        self.hill()
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'sculpt'\nname = 'caves'\n")
        self.fails(2, 'did you mean "caves"? Or give --new-layer cavse', "sculpt", "s.toml", "--layer", "cavse", "--stroke", "sphere at=40,40,50")
        self.fails(2, "has a layer of this name", "sculpt", "s.toml", "--new-layer", "caves", "--stroke", "sphere at=40,40,50")
        self.assertEqual(self.files(), ["hill.asc", "s.toml"])
        self.passes("sculpt", "s.toml", "--new-layer", "more", "--stroke", "sphere at=40,40,50")
        self.passes("sculpt", "s.toml", "--layer", "more", "--stroke", "sphere at=40,40,50")
        self.assertEqual(self.passes("sculpt", "s.toml", "--layer", "caves", "--list"), "")
        self.assertEqual(len(self.passes("sculpt", "s.toml", "--layer", "more", "--list").splitlines()), 2)

    def test_a_list_is_shown_as_it_is_written(self):
        self.hill()
        self.fails(2, "written as in 1,2,3,4", "build", "hill.asc", "--set", "terrain.window=1 2 3 4", "-o", "a.glb")
        self.assertIn("NAME=1,2,3", self.passes("build", "--help").replace("\n", " ").replace("  ", ""))


class Cost(Case):
    def test_no_voxel_of_nothing(self):
        self.hill()
        self.fails(2, "--voxel = 0 is outside", "build", "hill.asc", "--voxel", "0", "-o", "a.glb")
        self.fails(2, "--resolution = 0 is outside", "build", "hill.asc", "--resolution", "0", "-o", "a.glb")
        self.fails(2, "voxel = 1e-300 m is less than", "build", "hill.asc", "--set", "scene.voxel=1e-300", "-o", "a.glb")

    def test_what_cannot_fit_is_not_begun(self):
        self.hill(n=300, pixel=5.0)
        for args in (["build", "hill.asc", "--voxel", "0.01", "-o", "a.glb"], ["render", "hill.asc", "--voxel", "0.01", "-o", "a.png"],
                     ["render", "hill.asc", "--geology", "--voxel", "0.01", "-o", "a.png"],
                     ["build", "hill.asc", "--voxel", "0.01", "-o", "a.tvol"]):
            self.fails(2, "are free; use a larger --voxel", *args)
        predicted = json.loads(self.passes("build", "hill.asc", "--voxel", "0.01", "--dry-run", "--json"))
        self.assertGreater(predicted["memory_bytes"], 1e12)
        tower = ["build", "hill.asc", "--voxel", "0.1", "--set", "terrain.depth=100000"]
        self.fails(2, "are free; use a larger --voxel", *tower, "-o", "a.glb")
        self.assertIn("judged from its size alone", self.passes(*tower, "--dry-run"))
        self.assertEqual(self.files(), ["hill.asc"])

    def test_a_volume_that_cannot_fit_is_not_measured(self):
        self.hill(n=300, pixel=5.0)
        self.passes("build", "hill.asc", "--voxel", "10", "-o", "a.tvol")
        self.fails(2, "are free; use a larger --voxel", "metrics", "a.tvol", "--voxel", "0.01")

    def test_limits_of_the_process_count(self):
        self.hill(n=300, pixel=5.0)
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1_000_000_000, 1_000_000_000))
        if subprocess.run([TAFONI, "--version"], preexec_fn=limit, capture_output=True).returncode != 0:
            self.skipTest("the program does not start within 1 GB of addresses")
        done = subprocess.run([TAFONI, "build", "hill.asc", "--voxel", "0.25", "--threads", "1", "-o", "a.glb"], cwd=self.dir,
                              capture_output=True, text=True, preexec_fn=limit, timeout=120)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("of memory, and", done.stderr)
        done = subprocess.run([TAFONI, "render", "hill.asc", "--size", "8192,8192", "--threads", "1", "-o", "a.png"], cwd=self.dir,
                              capture_output=True, text=True, preexec_fn=limit, timeout=120)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("use a smaller --size", done.stderr)
