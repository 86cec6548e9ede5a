"""tafoni query: the field against a brute-force evaluation in double precision, and interrupts."""

import json
import math
import random
import signal
import struct
import subprocess

from case import TAFONI, Case


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


def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def to_segment(p, a, b):
    along, off = minus(b, a), minus(p, a)
    full = dot(along, along)
    t = min(max(dot(off, along) / full, 0), 1) if full > 0 else 0
    return math.dist(p, [a[k] + t * along[k] for k in range(3)])


def to_triangle(p, t):
    """Metres from a point to a triangle: to its plane where it lies over it, else to its edges."""
    n = cross(minus(t[1], t[0]), minus(t[2], t[0]))
    size = math.sqrt(dot(n, n))
    over = size > 0 and all(dot(cross(minus(t[(i + 1) % 3], t[i]), minus(p, t[i])), n) >= 0 for i in range(3))
    if over:
        return abs(dot(minus(p, t[0]), n)) / size
    return min(to_segment(p, t[i], t[(i + 1) % 3]) for i in range(3))


def crosses(p, t, way=(0.313, 0.271, 0.91)):
    """Whether a ray from the point meets the triangle [Moller and Trumbore]."""
    u, v, off = minus(t[1], t[0]), minus(t[2], t[0]), minus(p, t[0])
    h = cross(way, v)
    det = dot(u, h)
    if det == 0:
        return False
    a, q = dot(off, h) / det, cross(off, u)
    b = dot(way, q) / det
    return a >= 0 and b >= 0 and a + b <= 1 and dot(v, q) / det > 0


def world_triangles(file):
    """The triangles of a GLB, z up, in world positions."""
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    head, body = json.loads(data[20:20 + length]), data[28 + length:]
    part = head["meshes"][0]["primitives"][0]

    def read(accessor, code, width):
        a = head["accessors"][accessor]
        view = head["bufferViews"][a["bufferView"]]
        at = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        return list(struct.iter_unpack("<" + code * width, body[at:at + a["count"] * 4 * width]))

    ox, oy, oz = head["nodes"][0]["extras"]["world_origin"]
    corners = [(x + ox, -z + oy, y + oz) for x, y, z in read(part["attributes"]["POSITION"], "f", 3)]
    indices = [i for i, in read(part["indices"], "I", 1)]
    return [[corners[i] for i in indices[t:t + 3]] for t in range(0, len(indices), 3)]


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
        self.assertEqual(rows[0], "x,y,z,f,gx,gy,gz,distance")
        self.assertEqual(len(rows), len(points) + 1)
        worst = 0
        smooth = 0
        for point, row in zip(points, rows[1:]):
            x, y, z, f, gx, gy, gz, _ = map(float, row.split(","))
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

    def test_distances_are_those_of_the_mesh(self):
        """Near caves, where the field is no distance: every triangle is looked at, and sides come from crossings."""
        self.hill(n=24, pixel=2.0)
        rng = random.Random(8)
        caves = [("point", rng.uniform(8, 40), rng.uniform(8, 40), rng.uniform(38, 52), rng.uniform(4, 9), -110)
                 for _ in range(12)]
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\n" + "".join(",".join(map(str, p)) + "\n" for p in caves))
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 2\nmin_fragment = 0\n[terrain]\nsource = 'hill.asc'\n"
                                         "[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")
        self.passes("build", "s.toml", "-o", "s.glb")
        triangles = world_triangles(self.dir / "s.glb")
        points = [(rng.uniform(-5, 53), rng.uniform(-5, 53), rng.uniform(20, 70)) for _ in range(30)]
        points += [tuple(v + rng.uniform(-3, 3) for v in p[1:4]) for p in caves]
        text = "".join(",".join(map(repr, p)) + "\n" for p in points)
        rows = self.passes("query", "s.toml", "--points", "-", stdin=text).splitlines()[1:]
        misled = 0
        for point, row in zip(points, rows):
            field, distance = float(row.split(",")[3]), float(row.split(",")[7])
            nearest = min(to_triangle(point, t) for t in triangles)
            inside = sum(crosses(point, t) for t in triangles) % 2 == 1
            self.assertAlmostEqual(distance, nearest if inside else -nearest, delta=2e-4)
            misled += abs(field - distance) > 20
        self.assertGreater(misled, 5)
        values = json.loads(self.passes("query", "s.toml", "--points", "-", "--json", stdin=text))
        self.assertEqual([v["distance"] for v in values], [float(r.split(",")[7]) for r in rows])

    def test_reads_standard_input_and_writes_files(self):
        self.hill()
        rows = self.passes("query", "hill.asc", "--points", "-", stdin="10,10,1000\n11,11,30\n").splitlines()
        self.assertEqual(rows[1].split(",")[3], "-7.5")
        self.passes("query", "hill.asc", "--points", "-", "-o", "out.csv", stdin="10,10,1000\n")
        self.assertEqual((self.dir / "out.csv").read_text().splitlines()[1], rows[1])
        values = json.loads(self.passes("query", "hill.asc", "--points", "-", "--json", stdin="10,10,1000\n"))
        self.assertEqual(values[0]["f"], -7.5)

    def test_an_interrupt_ends_it(self):
        self.hill()
        (self.dir / "p.csv").write_text("kind,x,y,z,radius,energy\n" + "point,40,40,50,60,0.001\n" * 3000)
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 4\n[terrain]\nsource = 'hill.asc'\n"
                                         "[[layer]]\ntype = 'primitives'\nfile = 'p.csv'\n")
        for flag, rest in (("--points", ""), ("--closest", ",60")):
            (self.dir / "q.csv").write_text("".join(f"40,40,{50 + 1e-4 * i}{rest}\n" for i in range(200000)))
            before = self.files()
            work = subprocess.Popen([TAFONI, "query", "s.toml", flag, "q.csv", "-o", "a.csv", "--progress"],
                                    cwd=self.dir, stderr=subprocess.PIPE, text=True)
            while flag[2:] not in work.stderr.readline() and work.poll() is None:
                pass
            work.send_signal(signal.SIGINT)
            _, said = work.communicate(timeout=60)
            self.assertEqual(work.returncode, 130, said)
            self.assertEqual(self.files(), before)
