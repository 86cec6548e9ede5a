"""What the tests of the command line share: running it in a folder of their own."""

import math
import os
import random
import struct
import subprocess
import tempfile
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
    return struct.unpack("f", struct.pack("f", v))[0]


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
