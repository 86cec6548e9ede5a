"""Says of each level set on the command line what OpenVDB's own mesher makes of it."""
import json
import sys

import numpy
import pyopenvdb

for path in sys.argv[1:]:
    grid = pyopenvdb.read(path, "surface")
    points, triangles, quads = grid.convertToPolygons(isovalue=0, adaptivity=0)
    points = points.astype(numpy.float64)
    corners = [(faces[:, k], faces[:, (k + 1) % faces.shape[1]]) for faces in (triangles, quads) for k in range(faces.shape[1])]
    ends = numpy.sort(numpy.concatenate([numpy.stack(pair, axis=1) for pair in corners]).astype(numpy.int64), axis=1)
    _, uses = numpy.unique(ends[:, 0] * len(points) + ends[:, 1], return_counts=True)
    # OpenVDB's polygons look inward.
    fans = [quads[:, [0, 2, 1]], quads[:, [0, 3, 2]], triangles[:, ::-1]]
    a, b, c = (points[numpy.concatenate(fans)[:, k]] for k in range(3))
    print("ANSWER " + json.dumps({
        "file": path,
        "polygons": len(triangles) + len(quads),
        "open_edges": int(numpy.sum(uses == 1)),
        "volume": float(numpy.sum(a * numpy.cross(b, c)) / 6),
    }), flush=True)
