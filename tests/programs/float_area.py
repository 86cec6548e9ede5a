"""Says of each of our PLYs on the command line what its area is summed up as MeshLab 2020.09 does: in floats, one triangle
after the other. Of a million triangles of a few hundredths of a square metre that is a hundredth more than there is."""
import json
import re
import sys
from pathlib import Path

import numpy

TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1"}

for path in sys.argv[1:]:
    data = Path(path).read_bytes()
    start = data.index(b"end_header\n") + len("end_header\n")
    head = data[:start].decode()
    vertices, faces = (int(re.search(rf"element {name} (\d+)", head)[1]) for name in ("vertex", "face"))
    properties = re.findall(r"property (\w+) (\w+)\n", head.split("element face")[0])
    vertex = numpy.dtype([(name, TYPES[kind]) for kind, name in properties])
    at = numpy.frombuffer(data, vertex, vertices, start)
    places = numpy.stack([at[k].astype(numpy.float32) for k in "xyz"], axis=1)
    face = numpy.dtype([("count", "u1"), ("corners", "<u4", 3)])
    corners = numpy.frombuffer(data, face, faces, start + vertices * vertex.itemsize)["corners"]
    a, b, c = (places[corners[:, k]] for k in range(3))
    facets = numpy.cross(b - a, c - a).astype(numpy.float32)
    areas = numpy.sqrt((facets * facets).sum(axis=1, dtype=numpy.float32)) / numpy.float32(2)
    print("ANSWER " + json.dumps({"file": path, "area": float(numpy.cumsum(areas, dtype=numpy.float32)[-1])}), flush=True)
