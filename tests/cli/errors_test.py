"""Wrong arguments, inputs and outputs: exit codes, one sentence, no files left behind."""

import os
import subprocess

from case import TAFONI, Case, run


class Errors(Case):
    def test_wrong_arguments(self):
        self.hill()
        self.fails(2, 'unknown command "amplfy"; did you mean amplify?', "amplfy")
        self.fails(2, "unknown option --voxl; did you mean --voxel?", "build", "hill.asc", "--voxl", "1")
        self.fails(2, "SCENE is required", "build")
        self.fails(2, "--voxel must be a number, 0.0001 to 100000 m", "build", "hill.asc", "--voxel", "x", "-o", "a.glb")
        self.fails(2, "--voxel = -3 is outside 0.0001 to 100000 m", "build", "hill.asc", "--voxel", "-3", "-o", "a.glb")
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
        self.fails(2, "must be 6 numbers, each -1000000000 to 1000000000, written as in 1,2,3,4,5,6, not", "render", "hill.asc", "--camera", "-1,2,3", "-o", "a.png")
        self.fails(2, "options stand after the command: tafoni build --quiet", "--quiet", "build", "hill.asc")
        self.fails(2, "-q needs a command before it", "-q")
        self.fails(2, "--voxel is given more than once", "build", "hill.asc", "-o", "a.glb", "--voxel", "1", "--voxel", "2")
        self.fails(2, "unknown option --versoin; did you mean --version?", "--versoin")
        self.fails(2, "--layer needs a value; see tafoni amplify --help", "amplify", "hill.asc", "-o", "a.glb", "-l")
        self.fails(2, "are for layers; give -l LANDFORM", "amplify", "hill.asc", "--points", "no.csv", "-o", "a.glb")
        self.fails(2, "has no pixels; it is column, row, width, height", "build", "hill.asc", "--window", "0,0,0,0", "-o", "a.glb")
        self.fails(2, "leave out --azimuth", "render", "hill.asc", "--camera", "1,2,3,4,5,6", "--azimuth", "3", "-o", "a.png")
        self.assertEqual(self.files(), ["hill.asc"])

    def test_a_mesh_takes_no_options_of_scenes(self):
        (self.dir / "a.off").write_text("OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n")
        for command in (["metrics"], ["query", "--points", "-"], ["query", "--walk", "1"], ["render", "-o", "a.png"]):
            self.fails(2, "a mesh is as it is; --voxel is for scenes", command[0], "a.off", *command[1:], "--voxel", "1")

    def test_a_layer_that_makes_nothing_says_so(self):
        self.hill()
        scene = "[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'sculpt'\nstrokes = 's.strokes'\n[[layer]]\n"
        (self.dir / "s.strokes").write_text("paint at=40,40,50 radius=9 mask=region\n")
        for more, says in (("type = 'hoodoos'\nmask = 'paint:regoin'\n", 'no stroke that acts paints its mask "regoin"'),
                           ("type = 'hoodoos'\nmask = 'paint:regoin'\n", "did you mean paint:region?"),
                           ("type = 'sea-cliff'\nsea_level = 5000\n", "layer sea-cliff: it finds nothing to act on"),
                           ("type = 'karst'\naltitude = [1000, 2000]\n", "it finds nothing to act on where it may act")):
            (self.dir / "s.toml").write_text(scene + more)
            done = run("build", "s.toml", "--dry-run", cwd=self.dir)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(says, done.stderr)
        (self.dir / "s.toml").write_text(scene + "type = 'karst'\nmask = 'paint:'\n")
        self.fails(3, "s.toml:6: mask = \"paint:\" names no mask", "build", "s.toml", "--dry-run")
        (self.dir / "s.toml").write_text(scene + "type = 'heightfield'\naltitude = [1000, 2000]\ngenerator = 'foo'\n")
        self.fails(3, "foo", "build", "s.toml", "--dry-run")

    def test_scenes_that_ask_for_too_much(self):
        scene = "[terrain]\ngenerator = 'plane'\n[[layer]]\ntype = 'tunnels'\n"
        (self.dir / "row.toml").write_text(scene + "[[layer.tunnel]]\nfrom = [1, 1, 0]\nto = '9 9 0'\nwander = 7\n")
        self.fails(3, 'row.toml:8: layer "tunnels": tunnel, row 1: wander = 7 is outside 0 to 0.5',
                   "build", "row.toml", "-o", "a.glb")
        (self.dir / "end.toml").write_text(scene + "[[layer.tunnel]]\nfrom = [1, 1, 0]\n")
        self.fails(3, "end.toml:3: layer tunnels: tunnel, row 1: it needs to", "build", "end.toml", "-o", "a.glb")
        self.assertEqual(self.files(), ["end.toml", "row.toml"])

    def test_terrain_smaller_than_a_fragment(self):
        self.hill(n=8, pixel=0.1)
        self.fails(3, "give a smaller scene.min_fragment", "build", "hill.asc", "-o", "a.glb")
        self.passes("build", "hill.asc", "--set", "scene.min_fragment=0", "-o", "a.glb")

    def test_unusable_inputs(self):
        self.fails(3, "missing.tif", "amplify", "missing.tif", "-o", "a.glb")
        self.fails(3, "missing.toml: does not exist", "build", "missing.toml", "-o", "a.glb")
        self.fails(3, "missing.glb", "validate", "missing.glb")
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'hill.asc'\ninfluence = 99\n")
        self.fails(3, "s.toml:3: influence = 99 m is more than three times", "build", "s.toml", "-o", "a.glb")
        for line, key in ((2, "source = 'missing.asc'"), (3, "crs = 'EPSG:999999'"), (3, "domain = 'missing.geojson'")):
            source = "" if line == 2 else "source = 'hill.asc'\n"
            (self.dir / "s.toml").write_text(f"[terrain]\n{source}{key}\n")
            self.hill()
            self.fails(3, f"s.toml:{line}: ", "build", "s.toml", "-o", "a.glb")
        self.hill()
        self.fails(3, "missing.csv: does not exist", "query", "hill.asc", "--points", "missing.csv")
        self.fails(3, "x is \"a\", which is not a number", "query", "hill.asc", "--points", "-", stdin="x,y,z\na,1,2\n")
        (self.dir / "p.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\npoint,1,2,3,4,5\ncube,1,2,3,4,5\n")
        self.fails(3, "p.csv:3: kind is \"cube\"; known are", "build", "p.toml", "-o", "a.glb")
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\npoint,1e8,2,3,4,5\n")
        self.fails(3, "p.csv:2: ", "build", "p.toml", "-o", "a.glb")
        self.assertNotIn("a.glb", self.files())

    def test_what_is_no_regular_file_is_refused_at_once(self):
        self.hill()
        os.mkfifo(self.dir / "pipe")
        for name in ("pipe.toml", "pipe.tif", "pipe.csv", "pipe.geojson", "pipe.glb", "pipe.vdb"):
            (self.dir / name).symlink_to("pipe")
        says = "is a pipe or a device"
        self.fails(3, says, "build", "pipe.toml", "-o", "a.glb")
        self.fails(3, says, "info", "pipe.tif")
        self.fails(3, says, "info", "/dev/zero")
        self.fails(3, says, "info", "pipe.vdb")
        self.fails(3, says, "validate", "pipe.glb")
        self.fails(3, says, "query", "hill.asc", "--points", "pipe.csv")
        for key, name in (("region", "pipe.geojson"), ("mask", "pipe.tif"), ("points", "pipe.csv")):
            (self.dir / "s.toml").write_text(f"[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'karst'\n{key} = '{name}'\n")
            self.fails(3, says, "build", "s.toml", "-o", "a.glb")

    def test_a_scene_has_the_size_of_a_scene(self):
        (self.dir / "s.toml").write_text("[terrain]\ngenerator = 'plane'\n" + "# words\n" * (5 << 20))
        self.fails(3, "s.toml: holds more than 16 MB", "build", "s.toml", "-o", "a.glb")

    def test_nothing_is_fetched_unasked(self):
        url = "http://127.0.0.1:9/a.tif"
        self.fails(3, "give --allow-network", "info", url)
        self.fails(3, "cannot be read", "info", url, "--allow-network")

    def test_mosaics_of_files_elsewhere_need_leave(self):
        self.hill()
        (self.dir / "mine").mkdir()
        (self.dir / "mine" / "a.vrt").write_text(
            '<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="Float32" band="1"><SimpleSource>'
            f'<SourceFilename>{self.dir / "hill.asc"}</SourceFilename><SourceBand>1</SourceBand></SimpleSource>'
            '</VRTRasterBand></VRTDataset>')
        self.fails(3, "give --allow-outside", "info", "mine/a.vrt")
        self.assertIn("Virtual Raster", self.passes("info", "mine/a.vrt", "--allow-outside"))

    def test_outputs_are_checked_before_the_work(self):
        self.hill()
        self.fails(4, "there is no folder no/such/folder; make it", "build", "hill.asc", "-o", "no/such/folder/a.glb")
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
