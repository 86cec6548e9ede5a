"""Grammar caves in metrics, and texture coordinates of what is built."""

import csv
import io
import json

from case import Case

SOLID = """[scene]
voxel = 0.5
min_fragment = 0
[terrain]
generator = "plane"
elevation = -60
[[layer]]
type = "grammar-cave"
mode = "solid"
alone = true
at = [64, 64, 0]
size = 2.0
classic = 3
morphic = 1
"""


class Grammar(Case):
    def setUp(self):
        super().setUp()
        (self.dir / "s.toml").write_text(SOLID)

    def test_a_row_for_each_detail(self):
        rows = list(csv.DictReader(io.StringIO(
            self.passes("metrics", "--sgm", "s.toml", "--details", "3..5", "--csv"))))
        self.assertEqual([row["detail"] for row in rows], ["3", "4", "5"])
        self.assertEqual({row["productions"] for row in rows}, {"4"})
        one = json.loads(self.passes("metrics", "--sgm", "s.toml", "--details", "4", "--json"))
        self.assertAlmostEqual(one["surface_area"], float(rows[1]["surface_area"]), places=6)
        self.fails(2, "from 1 to 32", "metrics", "--sgm", "s.toml", "--details", "33")
        self.fails(2, "greater than the last", "metrics", "--sgm", "s.toml", "--details", "5..3")
        self.fails(2, "no grammar-cave layer", "metrics", "--sgm", "s.toml", "--layer", "hall")

    def test_texture_coordinates_in_obj_and_glb(self):
        self.passes("build", "s.toml", "-o", "a.obj", "-o", "a.glb", "--texture", "4")
        for name in ("a.obj", "a.glb"):
            self.passes("validate", name, "--closed")
        obj = (self.dir / "a.obj").read_text().split("\n")
        pairs = sum(line.startswith("vt ") for line in obj)
        for line in obj:
            if line.startswith("f "):
                for corner in line.split()[1:]:
                    self.assertLessEqual(int(corner.split("/")[1]), pairs)
        glb = (self.dir / "a.glb").read_bytes()
        described = json.loads(glb[20:20 + int.from_bytes(glb[12:16], "little")])
        attributes = described["meshes"][0]["primitives"][0]["attributes"]
        self.assertEqual(described["accessors"][attributes["TEXCOORD_0"]]["count"], pairs)
        self.assertEqual(described["accessors"][attributes["POSITION"]]["count"], pairs)
        self.fails(2, "--texture is for meshes", "build", "s.toml", "-o", "a.stl", "--texture", "4")
