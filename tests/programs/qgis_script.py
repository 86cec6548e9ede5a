"""Says of each file on the command line what QGIS makes of it as a mesh layer."""
import json
import sys

from qgis.core import QgsApplication, QgsMeshLayer

application = QgsApplication([], False)
application.initQgis()
for path in sys.argv[1:]:
    layer = QgsMeshLayer(path, "mesh", "mdal")
    extent = layer.extent()
    print("ANSWER " + json.dumps({
        "file": path,
        "valid": layer.isValid(),
        "crs": layer.crs().authid(),
        "triangles": layer.dataProvider().faceCount(),
        "west": extent.xMinimum(),
        "north": extent.yMaximum(),
    }), flush=True)
    del layer
application.exitQgis()
