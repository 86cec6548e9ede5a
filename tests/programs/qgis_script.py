"""Says of each file on the command line what QGIS makes of it as a mesh layer; of FILE=WKT also what it calls that CRS."""
import json
import sys

from qgis.core import QgsApplication, QgsCoordinateReferenceSystem, QgsMeshDatasetIndex, QgsMeshLayer

application = QgsApplication([], False)
application.initQgis()
for word in sys.argv[1:]:
    path, _, wkt = word.partition("=")
    layer = QgsMeshLayer(path, "mesh", "mdal")
    extent = layer.extent()
    heights = layer.datasetGroupMetadata(QgsMeshDatasetIndex(0, 0))
    print("ANSWER " + json.dumps({
        "file": path,
        "valid": layer.isValid(),
        "crs": layer.crs().authid(),
        "wanted_crs": QgsCoordinateReferenceSystem(wkt).authid() if wkt else "",
        "triangles": layer.dataProvider().faceCount(),
        "heights": heights.name(),
        "low": [extent.xMinimum(), extent.yMinimum(), heights.minimum()],
        "high": [extent.xMaximum(), extent.yMaximum(), heights.maximum()],
    }), flush=True)
    del layer
application.exitQgis()
