"""Mesh files in and out: map coordinates, axes, headers, tiles that are left out."""

import csv
import io
import json
import struct

from case import Case, run

EAST, NORTH = 447123.25, 5909876.75  # in UTM, where floats have steps of half a metre
UTM = ('PROJCS["WGS 84 / UTM zone 31N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
       'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
       'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",3],PARAMETER["scale_factor",0.9996],'
       'PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","32631"]]')
# A block of 0.3 x 0.2 x 0.1 m.
CORNERS = [(0.3 * (i & 1), 0.2 * (i >> 1 & 1), 0.1 * (i >> 2)) for i in range(8)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


class Meshes(Case):
    def block(self, name, x, y, z):
        lines = [f"v {x + a:.4f} {y + b:.4f} {z + c:.4f}" for a, b, c in CORNERS]
        lines += ["f " + " ".join(str(v + 1) for v in face) for face in FACES]
        (self.dir / name).write_text("\n".join(lines) + "\n")

    def test_a_block_in_map_coordinates(self):
        self.block("block.obj", EAST, NORTH, 57.2)
        found = json.loads(self.passes("metrics", "block.obj", "--json"))
        self.assertAlmostEqual(found["volume"], 0.006, 6)
        self.assertAlmostEqual(found["area"], 0.22, 6)
        self.assertAlmostEqual(found["low"][1], NORTH, 6)
        self.passes("validate", "block.obj", "--closed")
        asked = f"x;y;z;dx;dy;dz;distance\n{EAST + 0.1:.4f};{NORTH + 0.1:.4f};80;0;0;-1;100\n".replace(".", ",")
        rows = list(csv.DictReader(io.StringIO(self.passes("query", "block.obj", "--rays", "-", stdin=asked))))
        self.assertAlmostEqual(float(rows[0]["hit"]), 80 - 57.3, 5)

    def hill_in_utm(self):
        self.hill(west=EAST, south=NORTH)
        (self.dir / "hill.prj").write_text(UTM)

    def test_ply_for_gis(self):
        self.hill_in_utm()
        self.passes("build", "hill.asc", "--voxel", "2", "-o", "a.ply", "--world-coordinates")
        header, data = (self.dir / "a.ply").read_bytes().split(b"end_header\n", 1)
        header.decode("ascii")
        self.assertIn(b"\ncomment crs: EPSG:32631\n", header)
        self.assertIn(b"\nproperty double x\n", header)
        x, y, _ = struct.unpack("<ddd", data[:24])
        self.assertTrue(EAST <= x <= EAST + 80 and NORTH <= y <= NORTH + 80, (x, y))
        self.passes("build", "hill.asc", "--voxel", "2", "-o", "a.glb")
        world, local = (json.loads(self.passes("metrics", name, "--json")) for name in ("a.ply", "a.glb"))
        self.assertAlmostEqual(world["volume"] / local["volume"], 1, 6)

    def test_axes(self):
        self.hill()
        for up, files in ((None, ["a.obj"]), ("z", ["b.obj", "b.glb"]), ("y", ["c.ply", "c.stl"])):
            self.passes("build", "hill.asc", "--voxel", "2", *(["--up", up] if up else []),
                        *(word for file in files for word in ("-o", file)))
        self.assertTrue((self.dir / "a.obj").read_text().startswith("# tafoni: metres, y up\n"))
        highs = [json.loads(self.passes("metrics", name, "--json"))["high"]
                 for name in ("a.obj", "b.obj", "b.glb", "c.ply", "c.stl")]
        for high in highs[1:]:
            for a, b in zip(high, highs[0]):
                self.assertAlmostEqual(a, b, 4)
        self.fails(2, "--up z: no mesh to write can have it", "build", "hill.asc", "--up", "z", "-o", "d.glb")
        self.fails(2, "--world-coordinates is for meshes that hold doubles", "build", "hill.asc", "-o", "d.stl",
                   "--world-coordinates")
        self.fails(2, "--float-colors is for GLB", "build", "hill.asc", "-o", "d.ply", "--float-colors")

    def test_tiles_left_out_are_named(self):
        self.hill()
        for tiles, written in ((2, 4), (5, None)):
            said = run("build", "hill.asc", "--voxel", "1", "--tiles", tiles, "-o", f"t{tiles}.ply", cwd=self.dir).stderr
            found = len(list(self.dir.glob(f"t{tiles}_*.ply")))
            if written:
                self.assertEqual(found, written)
                self.assertNotIn("not written", said)
            else:
                self.assertIn(f"{tiles * tiles - found} of 5 x 5 tiles hold no surface and are not written: ", said)
