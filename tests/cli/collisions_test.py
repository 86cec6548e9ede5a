"""tafoni query: rays, spheres, sweeps and walks."""

import json

from case import Case


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
